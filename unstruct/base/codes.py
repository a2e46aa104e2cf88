"""What kernels of several methods return, under one name and number each; a method's own are 8 and above."""

from __future__ import annotations

# how a call ended: nothing is left to do; all steps that it was to do are done; arrays must grow first; an
# edge of the boundary is to be split first
DONE, MORE, ROOM, SPLIT = 0, 1, 2, 3
# what becomes of a point: it is a vertex now; it lies outside of what is meshed; an edge or a facet stands
# between it and its cavity; it, or its circle, is rounded away
INSERTED, OUTSIDE, HIDDEN, ROUNDED = 4, 5, 6, 7
