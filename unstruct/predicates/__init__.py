"""On which side, in or out: exact signs for all finite doubles. Book: 2.0, 2.4a."""

from .batch import in_sphere as in_sphere
from .batch import orient as orient

__all__ = ["in_sphere", "orient"]
