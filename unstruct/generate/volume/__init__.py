"""Tetrahedra that fill a body: its facets are faces, with as few further points as are found."""
