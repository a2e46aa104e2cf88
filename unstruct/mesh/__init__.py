"""Points and cells as arrays, and what follows from them: adjacency, measures, search, files."""
