"""One strip against the limits: a sentence for each that it misses, and what was tried on it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from .limits import Limits

_MOST_TRIALS: Final = 2
"""So many changes that keep a limit are named."""


@dataclass(frozen=True, slots=True)
class Missed:
    """A limit that a strip misses."""

    found: str
    """What was found and what is allowed, a sentence."""
    action: str
    """What was tried, and what came of it: sentences."""


@dataclass(frozen=True, slots=True)
class _Miss:
    """A figure beyond its limit."""

    words: str
    key: str
    """Of the figure in an entry and in its trials; empty where trials do not have it."""
    limit: float
    unit: str
    is_least: bool = False

    def is_kept_by(self, value: float | None) -> bool:
        """Whether a value of the figure keeps the limit; no bend at all does."""
        if value is None:
            return True
        return value >= self.limit if self.is_least else value <= self.limit


def missed_limits(
    entry: Mapping[str, Any], limits: Limits, invalid_percent: float
) -> tuple[Missed, ...]:
    """Compares one strip with the limits.

    Args:
        entry: an entry of ``strips`` in the JSON.
        limits: what may not be exceeded.
        invalid_percent: share of the rails under invalid bridges.

    Returns:
        One for each limit that the strip misses.
    """
    misses = [
        *_shapes(entry, limits),
        *_too_much(entry, limits, invalid_percent),
        *_too_sharp(entry, limits),
    ]
    return tuple(
        Missed(f"{entry['name']} {miss.words}.", " ".join(_tried(entry, miss))) for miss in misses
    )


def largest_crease(entry: Mapping[str, Any]) -> float:
    """Returns the angle of a strip's sharpest crease in degrees, 0 without any.

    >>> largest_crease({"creases": [{"angle_deg": 12.0}, {"angle_deg": 45.0}]})
    45.0
    """
    return max((float(crease["angle_deg"]) for crease in entry["creases"]), default=0.0)


def _shapes(entry: Mapping[str, Any], limits: Limits) -> Iterator[_Miss]:
    """What no limit allows, or none but one of its own."""
    if not limits.stated:
        return
    if entry["state"] == "folded":
        words = "lies back on itself or passes through itself, which no limit allows"
        yield _Miss(words, "", 0.0, "")
    crease, allowed = largest_crease(entry), limits.allowed_crease_deg
    if crease > allowed or (limits.max_crease_deg is None and crease == allowed):
        words = f"has a crease of {figure(crease)}°, and "
        if limits.max_crease_deg is None:
            words += f"none of {allowed:g}° or more is allowed unless --max-crease says so"
        else:
            words += f"{allowed:g} is allowed"
        yield _Miss(words, "max_crease_deg", allowed, "°")


def _too_much(entry: Mapping[str, Any], limits: Limits, invalid_percent: float) -> Iterator[_Miss]:
    strain, twist, fold = (
        float(entry[key]) for key in ("max_strain_percent", "max_twist_deg", "max_fold_deg")
    )
    for value, limit, what, unit, key in (
        (strain, limits.max_strain_percent, "a strain of", "%", "max_strain_percent"),
        (twist, limits.max_twist_deg, "a twist of", "°", "max_twist_deg"),
        (fold, limits.max_fold_deg, "a fold of", "°", ""),
        (
            invalid_percent,
            limits.max_invalid_percent,
            "invalid bridges on",
            "% of its rails",
            "",
        ),
    ):
        if limit is not None and value > limit:
            words = f"has {what} {figure(value)}{unit}, and {limit:g} is allowed"
            yield _Miss(words, key, limit, unit)


def _too_sharp(entry: Mapping[str, Any], limits: Limits) -> Iterator[_Miss]:
    across = limits.min_radius_across_grain_mm
    along_key = "inner_bend_radius_mm" if across is None else "bend_radius_along_grain_mm"
    where = "" if across is None else " along the grain"
    for key, least, words in (
        (along_key, limits.min_radius_mm, where),
        ("bend_radius_across_grain_mm", across, " across the grain"),
    ):
        radius = None if least is None else entry[key]
        if least is not None and radius is not None and radius < least:
            words = f"has a bend radius of {figure(radius)} mm{words}, and {least:g} is the least"
            yield _Miss(words, key, least, " mm", is_least=True)


def _tried(entry: Mapping[str, Any], miss: _Miss) -> Iterator[str]:
    """What was tried on this strip, and whether it keeps the limit."""
    trials = [trial for trial in entry.get("trials", ()) if miss.key and miss.key in trial]
    kept = [trial for trial in trials if miss.is_kept_by(trial[miss.key])]
    if kept:
        said = "; ".join(_outcome(trial, miss) for trial in kept[:_MOST_TRIALS])
        yield f"Tried, and enough: {said}."
    elif trials:
        nearest = _outcome(_best(trials, miss), miss)
        yield f"Of what was tried nothing is enough; the nearest: {nearest}."
    turns = [gap["turn"] for gap in entry["gaps"] if gap["turn"] is not None]
    if miss.key in ("max_strain_percent", "max_twist_deg") and turns:
        yield "The gap list says which rail to turn, and which way."


def _outcome(trial: Mapping[str, Any], miss: _Miss) -> str:
    value = trial[miss.key]
    return f"{trial['change']} gives " + (
        "no bend" if value is None else f"{figure(value)}{miss.unit}"
    )


def _best(trials: list[Mapping[str, Any]], miss: _Miss) -> Mapping[str, Any]:
    sign = -1.0 if miss.is_least else 1.0
    return min(trials, key=lambda trial: sign * float(trial[miss.key]))


def figure(value: float) -> str:
    """Three significant digits, no more than four decimals; round-off reads 0.

    >>> figure(0.12476), figure(3.8108), figure(31234.5), figure(1e-9)
    ('0.125', '3.81', '31,234', '0')
    """
    if abs(value) < 5e-5:
        return "0"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{min(digits, 4)}f}"
