"""Progress bars for long computations, shown only if the caller wants them."""

from __future__ import annotations

from typing import Any

from .arguments import as_flag

__all__ = ["progress_bar"]


class _Silent:
    """The silent replacement for a progress bar."""

    def update(self, count: int = 1) -> None:
        """Show nothing."""

    def close(self) -> None:
        """Do nothing, because no bar is open."""

    def __enter__(self) -> _Silent:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def progress_bar(wanted: bool, unit: str, **options: Any) -> Any:
    """A tqdm progress bar, or a silent replacement; tqdm is imported only if a bar is wanted.

    Parameters
    ----------
    wanted : bool
    unit : str
        What is counted; a bar shows it directly after the number.
    **options
        Options of tqdm: ``total``, ``initial``, ``desc``.

    Returns
    -------
    tqdm, or an object with its methods ``update`` and ``close``
        It is also a context manager, which closes the bar.
    """
    if not as_flag(wanted, "progress"):
        return _Silent()
    from tqdm.auto import tqdm

    return tqdm(unit=unit, **options)
