"""Point by point: the growing Delaunay triangulation, in the plane, in space, in any dimension."""
