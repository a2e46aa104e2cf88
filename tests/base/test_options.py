"""Options that are passed on are shown by name."""

from __future__ import annotations

import inspect
import re
from typing import Any, TypedDict, Unpack

import pytest

import unstruct
from unstruct import Domain, DomainError, DomainMesh, Mesh, Voronoi, view
from unstruct.base.options import named

SHOWN = {
    "inner": None,
    "curves": None,
    "markers": None,
    "regions": None,
    "resolve": False,
}
MAKERS = "polygon smooth rectangle disc naca letters from_geojson read".split()


def defaults(function) -> dict[str, object]:
    return {p.name: p.default for p in inspect.signature(function).parameters.values()}


@pytest.mark.parametrize("name", MAKERS)
def test_makers_of_domains_show_its_options(name: str) -> None:
    found = defaults(getattr(Domain, name))
    assert SHOWN.items() <= found.items()
    assert SHOWN.items() <= defaults(Domain).items(), "the same defaults as those of Domain itself"
    for option in SHOWN:
        assert re.search(rf"^.*\b{option}\b.* : ", inspect.getdoc(getattr(Domain, name)), flags=re.M)


def test_the_mesh_of_a_domain_shows_the_options_of_a_mesh() -> None:
    theirs = {name: value for name, value in defaults(Mesh).items() if name not in ("simplices", "_ready")}
    assert theirs.items() <= defaults(DomainMesh).items()


@pytest.mark.parametrize(
    ("method", "function"),
    [
        (Mesh.plot, view.plot),
        (Domain.plot, view.plot_domain),
        (DomainError.plot, view.plot_domain),
        (Voronoi.plot, view.plot_voronoi),
    ],
)
def test_methods_that_draw_have_the_options_of_what_draws(method, function) -> None:
    assert list(defaults(method).items())[1:] == list(defaults(function).items())[1:]


@pytest.mark.parametrize("function", [view.plot_cavity, view.plot_circumcircles])
def test_pictures_show_the_options_of_plot(function) -> None:
    shown = {name: defaults(view.plot)[name] for name in "role names vertices values label".split()}
    assert shown.items() <= defaults(function).items()


def members():
    """Functions and methods of the public face, with their names."""
    spaces = {name: getattr(unstruct, name) for name in unstruct.__all__}
    for name, value in [*spaces.items(), *((f"view.{k}", v) for k, v in vars(view).items())]:
        if inspect.isclass(value):
            methods = {k: getattr(value, k) for k in dir(value) if k[0] != "_" or k == "__init__"}
            yield from ((f"{name}.{k}", v) for k, v in methods.items() if inspect.isroutine(v))
        elif inspect.isfunction(value):
            yield name, value


def test_no_public_function_hides_its_options() -> None:
    hidden = []
    for name, value in members():
        if not (getattr(value, "__module__", None) or "").startswith("unstruct"):
            continue
        for parameter in inspect.signature(value).parameters.values():
            if parameter.kind is parameter.VAR_KEYWORD:
                hidden.append(name)
    assert not hidden


def test_an_option_that_does_not_exist_is_refused() -> None:
    with pytest.raises(TypeError, match="unexpected keyword argument 'hole'"):
        Domain.polygon([(0, 0), (1, 0), (0, 1)], hole=[])
    with pytest.raises(TypeError, match="unexpected keyword argument 'markers'"):
        unstruct.delaunay([(0, 0), (1, 0), (0, 1)]).plot(markers=True)


class Options(TypedDict, total=False):
    """Two options that are shown, and one that is not."""

    one: int | None
    two: float
    _three: int


def test_named() -> None:
    @named(Options, two=2)
    def function(x: Any, *, zero: int = 0, **options: Unpack[Options]) -> Any:
        return x, options

    shown = str(inspect.signature(function)).replace("'", "")
    assert shown == "(x: Any, *, zero: int = 0, one: int | None = None, two: float = 2) -> Any"
    assert function(1, one=5) == (1, {"one": 5})
