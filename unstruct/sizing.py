"""Size fields: how one says which edge length is wanted where. All that belongs to them, in one place.

Everywhere in the library a *size* is the wanted length of an edge. A triangle that is equilateral with
edges of length h has the circumradius h / sqrt(3): that is the chapter's f. See the book, chapter 2.3.
"""

from .size_field import SizeField as SizeField
from .size_field import as_size as as_size
from .size_field import clip as clip
from .size_field import control as control
from .size_field import maximum as maximum
from .size_field import minimum as minimum
from .size_field import product as product
from .size_table import SizeTable as SizeTable

__all__ = [
    "SizeField",
    "SizeTable",
    "as_size",
    "clip",
    "control",
    "maximum",
    "minimum",
    "product",
]
