"""Voronoi-segment insertion (12.2.6): nearly equilateral triangles of a wanted size."""
