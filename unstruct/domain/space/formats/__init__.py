"""Files of bodies in space: readers that name the file, the line and the remedy, and writers."""
