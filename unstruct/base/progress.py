"""Bars for long work, where they are wanted."""

from __future__ import annotations

from typing import Any

__all__ = ["progress_bar"]


class _Silent:
    """What takes the place of a bar that nobody wants."""

    def update(self, count: int = 1) -> None:
        """Nothing is shown."""

    def close(self) -> None:
        """Nothing was open."""

    def __enter__(self) -> _Silent:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def progress_bar(wanted: bool, unit: str, **options: Any) -> Any:
    """A bar of tqdm, or a silent stand-in; tqdm is imported only where a bar is wanted.

    Parameters
    ----------
    wanted : bool
    unit : str
        What is counted; a bar shows it right behind the number.
    **options
        As of tqdm: ``total``, ``initial``, ``desc``.

    Returns
    -------
    tqdm, or an object with its ``update`` and ``close``
        Also a context manager, which closes it.
    """
    if not wanted:
        return _Silent()
    from tqdm.auto import tqdm

    return tqdm(unit=unit, **options)
