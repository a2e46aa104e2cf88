"""What is inside: parts of the complex between marked faces, and how many facets lie around each."""

from __future__ import annotations

from ...base.jit import kernel
from ..insertion.engine import COUNT

__all__ = ["flood_parts"]


@kernel
def flood_parts(solid, stack, facet, parity):
    """Number the parts that marked faces separate; returns how many there are, and how many faces disagree.

    ``region`` becomes the part of each cell; part 0 touches the hull. ``parity[part]`` is 1 if an odd number
    of facets (``facet[number]`` of the face) lies between the part and the hull. A face disagrees if the
    parities on its two sides do not fit; then some facets are not there.
    """
    vertex, across, mark, region = solid.vertex, solid.across, solid.mark, solid.region
    slots, parts = solid.state[COUNT], 0
    first = 0
    for t in range(slots):
        region[t] = -1
        if (
            vertex[4 * t] >= 0
            and min(across[4 * t], across[4 * t + 1], across[4 * t + 2], across[4 * t + 3]) < 0
        ):
            first = t
    # stack: cells of the present part from below, faces that lead to other parts from above
    cells, doors = 1, stack.shape[0]
    stack[0], region[first], parity[0] = first, 0, 0
    while True:
        while cells > 0:
            cells -= 1
            t = stack[cells]
            for k in range(4):
                over = across[4 * t + k]
                if over < 0 or region[over >> 2] >= 0:
                    continue
                if mark[4 * t + k] >= 0:
                    doors -= 1
                    stack[doors] = 4 * t + k
                else:
                    region[over >> 2] = parts
                    stack[cells] = over >> 2
                    cells += 1
        while doors < stack.shape[0] and region[across[stack[doors]] >> 2] >= 0:
            doors += 1
        if doors == stack.shape[0]:
            break
        face = stack[doors]
        parts += 1
        parity[parts] = parity[region[face >> 2]] ^ facet[mark[face]]
        stack[0], region[across[face] >> 2] = across[face] >> 2, parts
        cells = 1
    wrong = 0
    for face in range(4 * slots):
        if vertex[face & ~3] >= 0 and mark[face] >= 0 and across[face] > face:
            differ = parity[region[face >> 2]] ^ parity[region[across[face] >> 2]]
            wrong += differ != facet[mark[face]]
    return parts + 1, wrong
