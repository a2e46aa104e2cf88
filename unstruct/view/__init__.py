"""Pictures of meshes and of algorithms at work; needs the ``book`` extra (matplotlib, anywidget).

`setup` sets the style, `plot` and its relatives draw with matplotlib, `strip` and `player` show the
same frames on paper and step by step, `view3d` turns, and the widgets answer to sliders.
"""

from .centers import circumcenter_history as circumcenter_history
from .centers import circumcenter_state as circumcenter_state
from .centers import circumcenters as circumcenters
from .colors import ROLES as ROLES
from .colors import setup as setup
from .constraints import constrained_insertion as constrained_insertion
from .constraints import principal_component as principal_component
from .constraints import principal_component_state as principal_component_state
from .constraints import segment_history as segment_history
from .constraints import segment_state as segment_state
from .frames import check_frame as check_frame
from .histories import baker_frames as baker_frames
from .histories import flip_frames as flip_frames
from .histories import gift_wrap_frames as gift_wrap_frames
from .histories import insertion_frames as insertion_frames
from .player import Player as Player
from .player import player as player
from .plots import plot as plot
from .plots import plot_cavity as plot_cavity
from .plots import plot_circumcircles as plot_circumcircles
from .plots import plot_quality as plot_quality
from .plots import plot_voronoi as plot_voronoi
from .proofs import cavity_proof_state as cavity_proof_state
from .proofs import star_proof_state as star_proof_state
from .rebay import chain_frame as chain_frame
from .rebay import cobweb_state as cobweb_state
from .rebay import voronoi_segment_state as voronoi_segment_state
from .rebay_history import rebay_frames as rebay_frames
from .rebay_widgets import rebay_cobweb as rebay_cobweb
from .rebay_widgets import rebay_step as rebay_step
from .space import Space as Space
from .space import item3 as item3
from .space import mesh_items3 as mesh_items3
from .space import picture as picture
from .space import view3d as view3d
from .states import bowyer_watson_history as bowyer_watson_history
from .states import bowyer_watson_state as bowyer_watson_state
from .states import empty_circle_state as empty_circle_state
from .states import voronoi_dual_state as voronoi_dual_state
from .strips import draw as draw
from .strips import strip as strip
from .swap_widgets import diagonal_choice as diagonal_choice
from .swap_widgets import diagonal_swaps as diagonal_swaps
from .swaps import diagonal_choice_state as diagonal_choice_state
from .swaps import swap_history as swap_history
from .swaps import swap_state as swap_state
from .terrain import plot_terrain as plot_terrain
from .widgets import bowyer_watson as bowyer_watson
from .widgets import cavity_argument as cavity_argument
from .widgets import empty_circle as empty_circle
from .widgets import new_triangle_argument as new_triangle_argument
from .widgets import voronoi_dual as voronoi_dual
