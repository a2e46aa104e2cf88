"""A package that is not installed is named, with the command that installs it."""

from __future__ import annotations

import sys

import pytest

from unstruct import UnstructError
from unstruct.base.optional import EXTRAS, optional


@pytest.mark.parametrize("module", sorted(EXTRAS))
def test_missing_packages_are_named(monkeypatch: pytest.MonkeyPatch, module: str) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    package, extra = EXTRAS[module]
    if module == "contourpy":  # it comes with matplotlib
        assert (package, extra) == ("matplotlib", "plot")
    ways = rf"pip install 'unstruct\[{extra}\]', or " if extra else ""
    told = rf"^tea needs {package}, and {module} is not installed: {ways}pip install {package}$"
    with pytest.raises(UnstructError, match=told) as caught:
        optional(module, "tea")
    assert isinstance(caught.value, ImportError)


def test_installed_packages_are_returned() -> None:
    import meshio

    assert optional("meshio", "files") is meshio
