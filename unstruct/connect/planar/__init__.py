"""The planar complex, which covers the outside of the domain too: cavities, segments, regions, stars."""
