"""Pictures of meshes and of the steps of algorithms; needs the extra ``plot`` (matplotlib, anywidget).

`setup` sets the style. `plot` and the other functions ``plot_...`` draw with matplotlib. `strip` and `player`
show the same frames, side by side or step by step. `view3d` shows objects in space that the reader can turn.
The widgets have sliders; `panel` makes such a widget from a function, for pages without a kernel, too.
"""

from .draw import extras as extras
from .draw import frames as frames
from .draw.colors import ROLES as ROLES
from .draw.colors import line_style as line_style
from .draw.colors import setup as setup
from .draw.domains import plot_domain as plot_domain
from .draw.frames import check_frame as check_frame
from .draw.plots import color_cells as color_cells
from .draw.plots import plot as plot
from .draw.plots import plot_cavity as plot_cavity
from .draw.plots import plot_circumcircles as plot_circumcircles
from .draw.plots import plot_quality as plot_quality
from .draw.plots import plot_voronoi as plot_voronoi
from .draw.space import Space as Space
from .draw.space import item3 as item3
from .draw.space import mesh_items3 as mesh_items3
from .draw.space import picture as picture
from .draw.space import view3d as view3d
from .draw.strips import draw as draw
from .draw.strips import draw_items as draw_items
from .draw.strips import strip as strip
from .draw.terrain import plot_terrain as plot_terrain
from .scenes import states as states
from .scenes.centers import CENTERS as CENTERS
from .scenes.centers import circumcenter_history as circumcenter_history
from .scenes.centers import circumcenter_state as circumcenter_state
from .scenes.constraints import principal_component_state as principal_component_state
from .scenes.constraints import segment_history as segment_history
from .scenes.constraints import segment_state as segment_state
from .scenes.fronts import candidate_frames as candidate_frames
from .scenes.fronts import empty_circle_frames as empty_circle_frames
from .scenes.fronts import front_frames as front_frames
from .scenes.fronts import front_length as front_length
from .scenes.fronts import fronts_of as fronts_of
from .scenes.gaps import gap_state as gap_state
from .scenes.histories import baker_frames as baker_frames
from .scenes.histories import flip_frames as flip_frames
from .scenes.histories import gift_wrap_frames as gift_wrap_frames
from .scenes.histories import insertion_frames as insertion_frames
from .scenes.proofs import cavity_proof_state as cavity_proof_state
from .scenes.proofs import star_proof_state as star_proof_state
from .scenes.rebay import COBWEBS as COBWEBS
from .scenes.rebay import FRONT_EXAMPLES as FRONT_EXAMPLES
from .scenes.rebay import chain_frame as chain_frame
from .scenes.rebay import cobweb_state as cobweb_state
from .scenes.rebay import voronoi_segment_state as voronoi_segment_state
from .scenes.rebay_history import rebay_frames as rebay_frames
from .scenes.states import bowyer_watson_history as bowyer_watson_history
from .scenes.states import bowyer_watson_state as bowyer_watson_state
from .scenes.states import empty_circle_state as empty_circle_state
from .scenes.states import voronoi_dual_state as voronoi_dual_state
from .scenes.swaps import QUADRILATERALS as QUADRILATERALS
from .scenes.swaps import diagonal_choice_state as diagonal_choice_state
from .scenes.swaps import swap_history as swap_history
from .scenes.swaps import swap_state as swap_state
from .widgets.center_widgets import circumcenters as circumcenters
from .widgets.constraint_widgets import constrained_insertion as constrained_insertion
from .widgets.constraint_widgets import principal_component as principal_component
from .widgets.panels import panel as panel
from .widgets.player import Player as Player
from .widgets.player import player as player
from .widgets.rebay_widgets import rebay_cobweb as rebay_cobweb
from .widgets.rebay_widgets import rebay_step as rebay_step
from .widgets.swap_widgets import diagonal_choice as diagonal_choice
from .widgets.swap_widgets import diagonal_swaps as diagonal_swaps
from .widgets.widgets import bowyer_watson as bowyer_watson
from .widgets.widgets import cavity_argument as cavity_argument
from .widgets.widgets import empty_circle as empty_circle
from .widgets.widgets import new_triangle_argument as new_triangle_argument
from .widgets.widgets import voronoi_dual as voronoi_dual
