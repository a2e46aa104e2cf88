"""Unstructured mesh generation, exact and fast: the library under the book."""
