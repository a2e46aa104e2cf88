"""From a domain and a size to a mesh."""
