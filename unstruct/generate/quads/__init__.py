"""Quadrilaterals from triangles, and from points that are packed along a field of crosses: chapter 6c."""
