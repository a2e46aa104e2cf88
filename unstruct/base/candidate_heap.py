"""A heap of candidates in two arrays; of equal keys the smaller value comes first."""

from __future__ import annotations

from .jit import inline

__all__ = ["put", "take"]


@inline
def put(keys, values, count, key, value):
    """Put a candidate into the heap; return the new number. Of equal keys the smaller value comes first."""
    k = count
    while k > 0:
        above = (k - 1) // 2
        if keys[above] < key or (keys[above] == key and values[above] <= value):
            break
        keys[k], values[k] = keys[above], values[above]
        k = above
    keys[k], values[k] = key, value
    return count + 1


@inline
def take(keys, values, count):
    """Remove the first candidate, which the caller has read; return the new number."""
    count -= 1
    key, value, k = keys[count], values[count], 0
    while 2 * k + 1 < count:
        child = 2 * k + 1
        if child + 1 < count and (
            keys[child + 1] < keys[child]
            or (keys[child + 1] == keys[child] and values[child + 1] < values[child])
        ):
            child += 1
        if key < keys[child] or (key == keys[child] and value <= values[child]):
            break
        keys[k], values[k] = keys[child], values[child]
        k = child
    keys[k], values[k] = key, value
    return count
