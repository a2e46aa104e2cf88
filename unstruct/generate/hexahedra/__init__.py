"""From octrees to hexahedra and cut cubes: see `choosing`, `pattern`, `dominant`, `inner`, `cutting`."""
