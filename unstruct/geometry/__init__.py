"""Geometry that needs no mesh: simplices, curves, segments, boxes, and orders along a space-filling curve."""
