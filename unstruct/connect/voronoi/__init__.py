"""Voronoi diagrams, the duals of Delaunay triangulations; cells cut by a window; nearest sites."""
