"""The planar complex with its outside: cavities, segments, fillings, floods, stars."""
