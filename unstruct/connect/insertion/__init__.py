"""The Delaunay triangulation that grows point by point: in the plane, in space, and in any dimension."""
