"""Triangles of a surface in space as half-edges, and what changes them: splits, flips, collapses."""
