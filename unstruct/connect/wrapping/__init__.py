"""Gift wrapping: a triangulation of given points, cell by cell, also from a given front."""
