"""Isosurface stuffing: tetrahedra with bounded angles in what a function or a surface bounds."""
