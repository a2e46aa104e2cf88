"""Insertion of points into any triangulation, in which some cells may be fixed."""
