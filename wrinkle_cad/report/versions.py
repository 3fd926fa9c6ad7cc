"""Which versions of what are at work."""

from __future__ import annotations

import platform
from importlib import metadata
from typing import Final

from wrinkle_cad import settings

_DISTRIBUTIONS: Final = (
    "build123d",
    "cadquery-ocp-novtk",
    "cadquery",
    "numpy",
    "numba",
    "ezdxf",
    "shapely",
)


def installed_versions() -> dict[str, str]:
    """Versions by distribution, Python's included, the absent ones left out."""
    versions = {"wrinkle-cad": settings.VERSION, "python": platform.python_version()}
    for name in _DISTRIBUTIONS:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return versions
