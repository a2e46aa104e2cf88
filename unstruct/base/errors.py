"""Typed errors. Each message says what is wrong, where, and what to do about it."""

from typing import Any

from .doors import door

__all__ = [
    "DegenerateInputError",
    "DomainError",
    "HiddenVertexWarning",
    "IncompleteWarning",
    "InputError",
    "MeshError",
    "MissingPackageError",
    "UnstructError",
]

_plot = door("unstruct.view:plot_domain")


class UnstructError(ValueError):
    """Base of every error that bad input can cause."""


class InputError(UnstructError):
    """An array has the wrong shape, type or contents; the message names the first offending row."""


class DomainError(InputError):
    """The pieces of a region have faults: they cross, overlap, stay open, ...

    Attributes
    ----------
    outline : Outline
        What was given: ``points``, ``facets``, ``inner``, ``curves``, ``pieces``.
    faults : tuple of Fault
        Each has a ``kind``, a ``text``, a ``place``, and numbers of ``pieces`` and ``vertices``.
    """

    def __init__(self, message: str, outline: Any, faults: Any):
        super().__init__(message)
        self.outline, self.faults = outline, tuple(faults)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.outline, self.faults)

    def plot(
        self,
        ax: Any = None,
        *,
        numbers: bool | None = None,
        names: bool = True,
        vertices: bool | None = None,
        faults: Any = (),
        azimuth: float | None = None,
        elevation: float | None = None,
    ) -> Any:
        """Draw what was given, with the faults marked; see `unstruct.Domain.plot` for the options."""
        given = {"azimuth": azimuth, "elevation": elevation}
        return _plot(self, ax, numbers=numbers, names=names, vertices=vertices, faults=faults, **given)


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

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.dimension)


class MeshError(UnstructError):
    """A mesh, or a requested change of it, is not valid; the message names cells and vertices."""


class MissingPackageError(UnstructError, ImportError):
    """A function needs a package that is not installed; the message says how to install it."""


class IncompleteWarning(UserWarning):
    """A mesh is valid, but some of its cells are not as they were asked for: it is not ``complete``.

    ``mesh.unrefined`` lists these cells and ``mesh.reasons`` says why. Where this is expected, it can be
    turned off: ``warnings.simplefilter("ignore", unstruct.IncompleteWarning)``.
    """


class HiddenVertexWarning(UserWarning):
    """At some vertices of a wall there are no prismatic layers.

    No direction sees all triangles there, or there is no room at all; ``mesh.steps`` lists them with
    the "level" 0 and a "reason".
    """
