"""Bodies in space: polygons that bound them, cut into triangles and checked exactly; files; made bodies."""
