"""How the waves of a profile look in their own plane: along the rail and away from the upper.

A fold of gathered leather is no sine: its flanks overhang. ``pleat`` and ``gather`` follow the
sine-generated curve, whose direction swings as a sine of its arc length; it is close to the shape
that bends least (W. B. Langbein, L. B. Leopold, USGS Professional Paper 422-H, 1966). A wave stays
in its own stretch of the rail, so that neighbors of any width do not touch; leaning shears all of
them alike, which keeps them apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.strip.portable import cos, sin
from wrinkle_cad.strip.rulings.vectors import units

from .opening_outline import Rail

Floats = NDArray[np.float64]

_SWING: Final = 1.9
"""rad; how far the direction swings to either side; loops of one wave touch from 2.18 on."""
_TABLE: Final = 4096
_POINTS_PER_FOLD: Final = 40
_UNEVEN_WIDTH: Final = 0.45
"""Of gathered folds: widths differ from their mean by up to this share of it ..."""
_UNEVEN_HEIGHT: Final = 0.3
"""... and heights are less than the largest by up to this share of it."""


@dataclass(frozen=True, slots=True, eq=False)
class DrawnWaves:
    """Waves at (k,) points along a rail, for a height of 1."""

    turns: Floats
    """(k,) increasing, 0 to 1: which share of the waves lies behind each point."""
    shares: Floats
    """(k,) where on the rail each point stands, as a share of its length."""
    heights: Floats
    """(k,) from -1 to 1."""


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """Points of a rail on the upper and the directions in which they may move."""

    points: Floats
    """(k, 3) mm."""
    normals: Floats
    """(k, 3) unit, out of the upper."""
    across: Floats
    """(k, 3) unit, along the upper and towards the other rail."""


def waves_along(
    rail: Rail,
    kind: settings.WaveKind,
    waves: float,
    phase: float,
    *,
    fade: float,
    side: settings.WaveSide,
    seed: int,
) -> DrawnWaves:
    """Returns the waves along a rail; towards its ends they die away.

    Args:
        rail: on the upper.
        kind: ``sine``; ``pleat``: rounded folds, all alike; ``gather``: of uneven width and height.
        waves: along the rail.
        phase: rad; where in its period the first wave starts.
        fade: share of the rail over which the waves grow and die away; a ring's do not.
        side: of the upper.
        seed: of what is uneven.
    """
    turns, shares = rail.shares, rail.shares
    if kind == "sine":
        angle = 2.0 * np.pi * waves * turns + phase
        heights = sin(angle) if side == "both" else 0.5 * (1.0 - cos(angle))
    else:
        count = max(len(turns), math.ceil(_POINTS_PER_FOLD * waves) + 1)
        turns = np.linspace(0.0, 1.0, count)
        shares, heights = folds(kind, waves, phase, seed=seed, is_ring=rail.is_ring, count=count)
        heights = 2.0 * heights - 1.0 if side == "both" else heights
    near = np.minimum(turns, 1.0 - turns)
    # A squared sine: at the ends it grows slower than the margin, so the band does not stand up.
    envelope = sin(0.5 * np.pi * np.clip(near / fade, 0.0, 1.0)) ** 2
    if rail.is_ring:
        envelope = np.ones(len(near))
    elif kind != "sine":
        # What is flat does not overhang.
        shares = turns + envelope * (shares - turns)
    return DrawnWaves(
        turns, shares, np.asarray((-1.0 if side == "in" else 1.0) * envelope * heights)
    )


def frame_at(rail: Rail, across: Floats, shares: Floats) -> Frame:
    """Returns the rail's points, and where they may move, at (k,) shares of its length.

    Args:
        rail: on the upper.
        across: (m, 3) unit, at the rail's own points.
        shares: those beyond the ends of an open rail stand at its ends.
    """
    if shares is rail.shares or np.array_equal(shares, rail.shares):
        return Frame(rail.points, rail.feet.normals, across)
    at = shares - np.floor(shares) if rail.is_ring else np.clip(shares, 0.0, 1.0)
    rows = np.hstack((rail.points, rail.feet.normals, across))
    slopes = np.gradient(rows, rail.shares, axis=0)
    i = np.clip(np.searchsorted(rail.shares, at, side="right") - 1, 0, len(rows) - 2)
    step = (rail.shares[i + 1] - rail.shares[i])[:, None]
    part = (at - rail.shares[i])[:, None] / step
    rest = 1.0 - part
    # Hermite's cubic; an upper's normals turn by little between two of its points.
    found = rest * rest * ((1.0 + 2.0 * part) * rows[i] + part * step * slopes[i])
    found += part * part * ((1.0 + 2.0 * rest) * rows[i + 1] - rest * step * slopes[i + 1])
    points, normals, sideways = found[:, :3], found[:, 3:6], found[:, 6:]
    return Frame(points, units(normals), units(sideways))


def folds(
    kind: settings.WaveKind, waves: float, phase: float, *, seed: int, is_ring: bool, count: int
) -> tuple[Floats, Floats]:
    """Returns where rounded folds stand, (k,) shares of the rail, and their heights, (k,) 0 to 1.

    Args:
        kind: ``pleat`` or ``gather``.
        waves: along the rail.
        phase: rad.
        seed: of what is uneven.
        is_ring: whether the waves run on across the rail's start.
        count: points, k.

    Example:
        >>> shares, heights = folds("pleat", 1.0, 0.0, seed=0, is_ring=False, count=9)
        >>> shares.round(3).tolist()
        [0.0, 0.317, 0.25, 0.183, 0.5, 0.817, 0.75, 0.683, 1.0]
        >>> heights.round(3).tolist()
        [0.0, 0.199, 0.5, 0.801, 1.0, 0.801, 0.5, 0.199, 0.0]
    """
    along, up = _fold()
    turns = np.linspace(0.0, waves, count) + phase / (2.0 * math.pi)
    number = np.floor(turns).astype(np.int64)
    part = turns - number
    number -= number[0]
    places = np.linspace(0.0, 1.0, len(along))
    starts, tall = _waves(kind, int(number[-1]) + 1, max(1, round(waves)) if is_ring else 0, seed)
    where = starts[number] + (starts[number + 1] - starts[number]) * np.interp(part, places, along)
    # However uneven, all waves lie between the first point and the last.
    shares = (where - where[0]) / (where[-1] - where[0])
    return shares, tall[number] * np.interp(part, places, up)


def _fold() -> tuple[Floats, Floats]:
    """Returns (t,) along and (t,) up at even parts of one fold, each from 0 to 1."""
    middle = (np.arange(_TABLE) + 0.5) / _TABLE
    direction = _SWING * sin(2.0 * math.pi * middle)
    along = np.concatenate(([0.0], np.cumsum(cos(direction))))
    up = np.concatenate(([0.0], np.cumsum(sin(direction))))
    return along / along[-1], up / up[_TABLE // 2]


def _waves(kind: settings.WaveKind, count: int, around: int, seed: int) -> tuple[Floats, Floats]:
    """Returns (count + 1,) where waves start, and (count,) how high they are, 1 at most.

    Args:
        kind: ``pleat`` or ``gather``.
        count: waves.
        around: waves after which they begin again, as on a ring; 0 for none.
        seed: of what is uneven.
    """
    if kind == "pleat":
        return np.arange(count + 1.0), np.ones(count)
    own = around or count
    random = np.random.default_rng(seed)
    width = 1.0 + _UNEVEN_WIDTH * random.uniform(-1.0, 1.0, own)
    tall = 1.0 - _UNEVEN_HEIGHT * random.uniform(0.0, 1.0, own)
    each = np.arange(count) % own
    return np.concatenate(([0.0], np.cumsum(width[each]))), tall[each]
