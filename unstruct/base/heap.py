"""A heap in two arrays, for kernels: keys, and what belongs to them. The least key comes first."""

from __future__ import annotations

from .jit import inline

__all__ = ["pop", "push"]


@inline
def push(heap, what, count, key, value):
    """Put a value into the heap of ``count`` entries; return the new number of entries."""
    k = count
    while k > 0 and heap[(k - 1) // 2] > key:
        heap[k], what[k] = heap[(k - 1) // 2], what[(k - 1) // 2]
        k = (k - 1) // 2
    heap[k], what[k] = key, value
    return count + 1


@inline
def pop(heap, what, count):
    """Remove the first entry, which the caller has read; return the number of remaining entries."""
    count -= 1
    key, value = heap[count], what[count]
    k = 0
    while 2 * k + 1 < count:
        child = 2 * k + 1
        if child + 1 < count and heap[child + 1] < heap[child]:
            child += 1
        if heap[child] >= key:
            break
        heap[k], what[k] = heap[child], what[child]
        k = child
    heap[k], what[k] = key, value
    return count
