"""Tetrahedra of given points in which given segments and triangles are recovered, by refilling small cavities."""
