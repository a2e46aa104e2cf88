"""Meshes that keep the boundary (12.2.5): constrained, conforming, protected, recovered."""
