"""On a surface: Delaunay by angles, by balls centered on it, and by the chapter's spheres (12.2.7)."""
