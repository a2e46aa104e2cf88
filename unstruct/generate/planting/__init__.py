"""Trees for users: from a box or a domain and rules to a tree, and from a tree to meshes."""
