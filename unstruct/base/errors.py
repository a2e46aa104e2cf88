"""Typed errors. Each message says what is wrong, where, and what to do about it."""

__all__ = ["DegenerateInputError", "InputError", "MeshError", "UnstructError"]


class UnstructError(ValueError):
    """Base of every error that bad input can cause."""


class InputError(UnstructError):
    """An array has the wrong shape, type or contents; the message names the first offending row."""


class DegenerateInputError(UnstructError):
    """The points do not span the space, so no simplex of full dimension exists.

    Attributes
    ----------
    dimension : int
        The dimension of the affine hull of the points (0: all points are equal, 1: they are collinear, ...).
    """

    def __init__(self, message: str, dimension: int):
        super().__init__(message)
        self.dimension = dimension


class MeshError(UnstructError):
    """A mesh, or a requested change of it, is not valid; the message names cells and vertices."""
