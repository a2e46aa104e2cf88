"""Triangles of a surface: half-edges and what changes them, and what is Delaunay there (12.2.7)."""
