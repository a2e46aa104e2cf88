"""Prismatic layers: wedges along the walls of a body in space, not one of them inverted (12.5)."""
