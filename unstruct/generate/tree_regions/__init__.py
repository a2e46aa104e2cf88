"""Meshes of planar regions from quadtrees: fitted, warped, and of quadrilaterals."""
