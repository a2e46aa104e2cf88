"""Tetrahedra of given points: given segments and triangles are recovered by refilling small cavities."""
