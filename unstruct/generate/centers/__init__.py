"""Circumcenters of maximal triangles, in the plane and on a torus (12.2.6)."""
