"""Advancing fronts (12.3): triangle by triangle from the boundary inward."""
