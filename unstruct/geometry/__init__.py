"""Shapes without a mesh: simplices, curves, segments and boxes, orders along a curve."""
