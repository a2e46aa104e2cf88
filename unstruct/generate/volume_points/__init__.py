"""Points put into bodies, on their segments and on their facets, one after the other: refinement in space."""
