"""The advancing front in space: from the surface of a body inward, one tetrahedron after the other."""
