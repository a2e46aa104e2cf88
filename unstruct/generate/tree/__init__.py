"""Quadtrees and octrees, and meshes made of them. See the book, chapters 4a to 4c."""
