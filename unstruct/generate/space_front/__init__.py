"""The advancing front in space (12.3): tetrahedra from the boundary inward."""
