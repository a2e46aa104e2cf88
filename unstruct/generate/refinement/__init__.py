"""Delaunay refinement with bounds on angles, areas and sizes (12.2.6)."""
