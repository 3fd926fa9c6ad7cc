"""Products and lengths of many vectors at once, the same to the last digit on every processor.

Components are added in a fixed order, and angles come from `math.atan2`: numpy's own reductions
and its arctangent depend on the width of the processor's vector unit.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.compiled import compiled

Floats = npt.NDArray[np.float64]


def lengths(vectors: Floats) -> Floats:
    """(k,) lengths of (k, 3) vectors."""
    return np.sqrt(dots(vectors, vectors))


def dots(a: Floats, b: Floats) -> Floats:
    """(k,) scalar products of (k, 3) vectors."""
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def crosses(a: Floats, b: Floats) -> Floats:
    """(k, 3) vector products of (k, 3) vectors."""
    x = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    y = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    z = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.stack((x, y, z), axis=-1)


def units(vectors: Floats) -> Floats:
    """(k, 3) unit vectors along (k, 3) vectors; zero stays zero."""
    length = lengths(vectors)
    return vectors / np.where(length > 0.0, length, 1.0)[:, None]


@compiled
def angles(sine: Floats, cosine: Floats) -> Floats:
    """(k,) rad, (-pi, pi]: the angles of directions, any length."""
    found = np.empty(sine.size)
    for k in range(sine.size):
        found[k] = math.atan2(sine[k], cosine[k])
    return found


@compiled
def cosines(angle: Floats) -> Floats:
    """(k,) cosines of (k,) angles in rad, from `math.cos`."""
    found = np.empty(angle.size)
    for k in range(angle.size):
        found[k] = math.cos(angle[k])
    return found
