"""Meshes of regions that are cut into parts, each of which is meshed by itself."""
