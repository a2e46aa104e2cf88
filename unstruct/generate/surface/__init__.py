"""From a given surface in space and a size to triangles on it (12.2.7)."""
