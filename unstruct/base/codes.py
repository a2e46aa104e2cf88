"""Codes that kernels of several methods return. A method's own codes are 8 and above."""

from __future__ import annotations

# How a call ended.
DONE = 0  # nothing is left to do
MORE = 1  # all steps that it was asked to do are done
ROOM = 2  # the arrays must grow first
SPLIT = 3  # an edge of the boundary must be split first

# What becomes of a point.
INSERTED = 4  # it is a vertex now
OUTSIDE = 5  # it lies outside of the region that is meshed
HIDDEN = 6  # an edge or a facet lies between it and its cavity
ROUNDED = 7  # it, or its circle, is lost to rounding
