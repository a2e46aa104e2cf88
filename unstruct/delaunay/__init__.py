"""Methods built on the Delaunay criterion (section 12.2 of the chapter; 2.x of the book)."""
