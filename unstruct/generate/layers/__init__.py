"""Layers of thin cells along walls, and any method of a size for the rest (12.3.3)."""
