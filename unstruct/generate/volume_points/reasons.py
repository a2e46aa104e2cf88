"""Why nothing is put where a point is wanted: codes, and bits in which subsegments and faces keep them."""

from __future__ import annotations

from ...base.codes import ROUNDED
from ...base.jit import inline
from .records import WHY_NO_MORE

__all__ = [
    "AT_INPUT_ANGLE",
    "BEYOND_THE_BOX",
    "FLAT_TETRAHEDRON",
    "IN_NARROW_GAP",
    "MUST_STAY",
    "NEAR_VERTEX",
    "OFTEN_DIVIDED",
    "WAITS",
    "given_up",
    "why_not_more",
]

WAITS = 8  # what is in the way is divided first
NEAR_VERTEX = 9  # a vertex is too near
MUST_STAY = 10  # what is in the way must stay as it is
AT_INPUT_ANGLE = 11  # the shape comes from a small angle of the input
FLAT_TETRAHEDRON = 12  # the center is nearer to the vertices than these are to each other
OFTEN_DIVIDED = 13  # what is in the way was divided as often as it may be for the shape's sake
IN_NARROW_GAP = 14  # the shape comes from a narrow gap between parts of the surface
BEYOND_THE_BOX = 15  # the center is beyond the box around all points, or there is none; only for cells
LOST_TO_ROUNDING = 7  # below `WAITS`: in the bits of what is given up, in place of codes below


@inline
def why_not_more(bits):
    """The code by which a subsegment or face was given up, from its bits."""
    kind = bits >> WHY_NO_MORE
    return ROUNDED if kind == LOST_TO_ROUNDING else (MUST_STAY if kind == 0 else WAITS + kind)


@inline
def given_up(bits, cause, shift, code):
    """The bits of a subsegment or face that is given up for a cause."""
    kind = code - WAITS if code > WAITS else LOST_TO_ROUNDING
    return (bits & 15) | cause << shift | kind << WHY_NO_MORE
