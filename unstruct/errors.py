"""The errors of the library: all are `UnstructError`, a ValueError."""

from .base.errors import *  # noqa: F403
from .base.errors import __all__ as __all__
