"""Point insertion into any triangulation, beside cells that must not change."""
