"""The verdict on a job in words a cutter understands, from the numbers in its JSON.

Without limits a strip is only called developable or not; with limits it passes or fails.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final, Literal

from .material import Limits

State = Literal["developable", "inflection", "not-developable"]

_WORST_FIRST: Final[tuple[State, ...]] = ("not-developable", "inflection", "developable")
_BUT_FOR: Final = {"developable": "", "inflection": " but for inflection rulings"}
_MEANING: Final[dict[State, str]] = {
    "developable": "Flat material can be bent into this shape without stretching.",
    "inflection": (
        "Flat material can be bent into this shape without stretching; at an inflection ruling it"
        " lies straight while the bend changes sides."
    ),
    "not-developable": (
        "At the marked bridges flat material must stretch, shrink or crease to take this shape."
    ),
}


@dataclass(frozen=True, slots=True)
class StripVerdict:
    """What is said about one strip, and the figures that only the verdict needs."""

    name: str
    """The strip's name."""
    state: State
    """Developable, developable but for inflection rulings, or not."""
    sentence: str
    """The state with its figures."""
    invalid_percent: float
    """Share of both rails that invalid bridges cover, inflection rulings left out."""
    price_of_developability: float | None
    """Bending energy over that of the least-bending strip; None where that one does not bend."""
    seam_difference_p_mm: float
    """Seam P in the pattern less seam P in space."""
    seam_difference_q_mm: float
    """Likewise of Q."""
    missed: tuple[str, ...]
    """One line for each limit that the strip misses."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is said about a job."""

    state: State
    """The worst of its strips."""
    headline: str
    """The verdict in one line."""
    meaning: str
    """What it means at the cutting table."""
    limits: tuple[str, ...]
    """The limits that were given; empty when there were none."""
    passed: bool | None
    """Whether all limits are kept; None without limits."""
    missed: tuple[str, ...]
    """One line for each limit missed: what - found - limit - what to do."""
    strips: tuple[StripVerdict, ...]
    """One for each strip, in their order."""

    def as_json(self) -> dict[str, Any]:
        """The verdict as plain values, as it stands in NAME.json."""
        return asdict(self)


def judge(entries: Sequence[Mapping[str, Any]], limits: Limits) -> Verdict:
    """Judges a job by the ``strips`` of its JSON.

    Args:
        entries: the entries of ``strips``.
        limits: what may not be exceeded; ``Limits()`` for none.
    """
    strips = tuple(_judge_strip(entry, limits) for entry in entries)
    states = {strip.state for strip in strips}
    state = next((state for state in _WORST_FIRST if state in states), _WORST_FIRST[-1])
    missed = tuple(line for strip in strips for line in strip.missed)
    headline = strips[0].sentence if len(strips) == 1 else _headline(state, entries, strips)
    return Verdict(
        state=state,
        headline=headline,
        meaning=_MEANING[state] + _overlap_words(entries),
        limits=limits.stated,
        passed=None if not limits.stated else not missed,
        missed=missed,
        strips=strips,
    )


def check_limits(entry: Mapping[str, Any], limits: Limits) -> tuple[str, ...]:
    """Compares one strip with the limits.

    Args:
        entry: an entry of ``strips`` in the JSON.
        limits: what may not be exceeded.

    Returns:
        One line for each limit missed: what - found - limit - what to do.
    """
    name = entry["name"]
    lines = []
    for value, limit, what, unit, action in (
        (entry["max_fold_deg"], limits.max_fold_deg, "largest fold", "degrees", _SOFTER),
        (entry["max_twist_deg"], limits.max_twist_deg, "largest twist", "degrees", _STRAIGHTER),
        (
            invalid_percent(entry),
            limits.max_invalid_percent,
            "rail covered by invalid bridges",
            "per cent",
            "change the rails where the gap list says",
        ),
    ):
        if limit is not None and value > limit:
            lines.append(f"{name} - {what} {_figure(value)} {unit} - at most {limit:g} - {action}")
    smallest = limits.smallest_bend_radius_mm
    if smallest is not None:
        radius = entry["smallest_bend_radius_mm"]
        if radius is not None and radius < smallest:
            lines.append(
                f"{name} - smallest bend radius {_figure(radius)} mm - at least {smallest:g} -"
                f" {_SOFTER}"
            )
    return tuple(lines)


_SOFTER: Final = "make the rails' waves lower or longer"
_STRAIGHTER: Final = "let the rails run more alike"


def invalid_percent(entry: Mapping[str, Any]) -> float:
    """Share of both rails that invalid bridges cover, in per cent; inflections left out."""
    seams = entry["seam_lengths_mm"]
    whole = float(seams["p"]["space"]) + float(seams["q"]["space"])
    return 100.0 * _invalid_mm(entry) / whole if whole > 0.0 else 0.0


def _invalid_mm(entry: Mapping[str, Any]) -> float:
    return float(entry["invalid_length_p_mm"]) + float(entry["invalid_length_q_mm"])


def _judge_strip(entry: Mapping[str, Any], limits: Limits) -> StripVerdict:
    seams, least = entry["seam_lengths_mm"], float(entry["least_bending"])
    state = _state_of(entry)
    return StripVerdict(
        name=entry["name"],
        state=state,
        sentence=_sentence(entry, state),
        invalid_percent=invalid_percent(entry),
        price_of_developability=float(entry["bending"]) / least if least > 0.0 else None,
        seam_difference_p_mm=seams["p"]["pattern"] - seams["p"]["space"],
        seam_difference_q_mm=seams["q"]["pattern"] - seams["q"]["space"],
        missed=check_limits(entry, limits),
    )


def _state_of(entry: Mapping[str, Any]) -> State:
    if entry["invalid_bridges"] > entry["inflection_bridges"]:
        return "not-developable"
    return "inflection" if entry["inflection_bridges"] else "developable"


def _sentence(entry: Mapping[str, Any], state: State) -> str:
    inflections = int(entry["inflection_bridges"])
    figures = (
        f"largest fold {_figure(entry['max_fold_deg'])}°,"
        f" largest twist {_figure(entry['max_twist_deg'])}°"
    )
    if state == "developable":
        return f"Developable: all {entry['interior_bridges']:,} bridges; {figures}."
    if state == "inflection":
        # One ruling where the bend changes sides may show as a run of bridges.
        runs = sum(gap["kind"] == "inflection" for gap in entry["gaps"])
        rulings = f"{runs:,} inflection ruling{'s' if runs != 1 else ''}"
        return (
            f"Developable but for {rulings} ({inflections:,} of"
            f" {entry['interior_bridges']:,} bridges); {figures}."
        )
    invalid = int(entry["invalid_bridges"]) - inflections
    beside = f" (and {inflections:,} at inflection rulings)" if inflections else ""
    return (
        f"Not developable: {invalid:,} of {entry['interior_bridges']:,} bridges{beside},"
        f" covering {_figure(_invalid_mm(entry))} mm of rail; {figures}."
    )


def _headline(
    state: State, entries: Sequence[Mapping[str, Any]], strips: Sequence[StripVerdict]
) -> str:
    """One line on several strips: how many are bad, strips and bands apart."""
    states: dict[str, list[State]] = {}
    for entry, strip in zip(entries, strips, strict=True):
        states.setdefault(entry.get("role", "strip"), []).append(strip.state)
    if state != "not-developable":
        counts = " and ".join(_all_of(len(own), role) for role, own in states.items())
        return f"Developable{_BUT_FOR[state]}: {counts}."
    bad, good = [], []
    for role, own in states.items():
        count = own.count("not-developable")
        if count:
            some = f"{count} of {len(own)} {role}s"
            bad.append(_all_of(count, role) if count == len(own) else some)
        else:
            worst = "inflection" if "inflection" in own else "developable"
            every = _all_of(len(own), role)
            verb = "is" if len(own) == 1 else "are"
            good.append(f" {every.capitalize()} {verb} developable{_BUT_FOR[worst]}.")
    return f"Not developable: {' and '.join(bad)}.{''.join(good)}"


def _all_of(count: int, role: str) -> str:
    if count == 1:
        return f"the {role}"
    return f"both {role}s" if count == 2 else f"all {count} {role}s"


def _overlap_words(entries: Sequence[Mapping[str, Any]]) -> str:
    if any(entry["overlaps"] for entry in entries):
        return " Laid flat in one piece it would cover itself, so the pattern is cut in parts."
    return ""


def _figure(value: float) -> str:
    """Three significant digits, no more than four decimals; round-off reads 0."""
    if abs(value) < 5e-5:
        return "0"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{min(digits, 4)}f}"
