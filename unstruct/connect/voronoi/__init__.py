"""The dual: Voronoi diagrams, their centers, their cells within a window, nearest points."""
