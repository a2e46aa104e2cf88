"""The regions, points and meshes of the book in one namespace, as starting points of chapters and tests."""

from .aircraft import duct as duct
from .aircraft import wing as wing
from .aircraft import wing_body as wing_body
from .bodies import LevelSet as LevelSet
from .bodies import cube as cube
from .bodies import merged_body as merged_body
from .bodies import noise as noise
from .bodies import noisy_ball as noisy_ball
from .bodies import notch as notch
from .bodies import notched_box as notched_box
from .bodies import sphere as sphere
from .bodies import torus as torus
from .point_sets import clipped_lattice as clipped_lattice
from .point_sets import letter_outlines as letter_outlines
from .point_sets import mapped_grid as mapped_grid
from .regions import coastline as coastline
from .regions import coastline_size as coastline_size
from .regions import plate as plate
from .regions import running_domain as running_domain
from .regions import wing_with_flap as wing_with_flap
from .regions import word as word
from .running import flip_at_random as flip_at_random
from .running import inside_polygon as inside_polygon
from .running import island_shore as island_shore
from .running import lake_shore as lake_shore
from .running import random_triangulation as random_triangulation
from .running import running_points as running_points
from .running import running_region as running_region
from .running import running_size as running_size
from .running import sweep_triangulation as sweep_triangulation
from .running import two_triangulations as two_triangulations
from .structured import graded_line as graded_line
from .structured import ring_grid as ring_grid
from .structured import tensor_grid as tensor_grid
from .stuck_fronts import stuck_body as stuck_body
from .surfaces import level_surface as level_surface
from .surfaces import meshed_sides as meshed_sides
from .surfaces import scanned_surface as scanned_surface
from .unshellable import rudin_tetrahedron as rudin_tetrahedron

__all__ = [
    "LevelSet",
    "clipped_lattice",
    "coastline",
    "coastline_size",
    "cube",
    "duct",
    "flip_at_random",
    "graded_line",
    "inside_polygon",
    "island_shore",
    "lake_shore",
    "letter_outlines",
    "level_surface",
    "mapped_grid",
    "merged_body",
    "meshed_sides",
    "noise",
    "noisy_ball",
    "notch",
    "notched_box",
    "plate",
    "random_triangulation",
    "ring_grid",
    "rudin_tetrahedron",
    "running_domain",
    "running_points",
    "running_region",
    "running_size",
    "scanned_surface",
    "sphere",
    "stuck_body",
    "sweep_triangulation",
    "tensor_grid",
    "torus",
    "two_triangulations",
    "wing",
    "wing_body",
    "wing_with_flap",
    "word",
]
