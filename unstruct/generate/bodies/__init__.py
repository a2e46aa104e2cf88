"""Bodies in space at a wanted size: facets cut into triangles of the size, then tetrahedra. Book: 2.8c."""
