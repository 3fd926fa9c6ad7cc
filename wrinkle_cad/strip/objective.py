"""What a search minimises: ordered parts of a cost, each a weighted sum of measures.

Fold-backs come before everything, the total length of the bridges behind everything. Between them
stand the criteria in their order, triangles of zero area just before the bending; with a price for
validity instead (fold-backs, triangles of zero area, `bending + cost * invalid`, later criteria).
Where all that is equal (a rectangle has two diagonals of one length) the fewest invalid bridges
win, bent or not: so counts do not depend on which rail is P and on where they start.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import Criterion

Part = tuple[float, float, float, float, float, float, float, float]
"""Weights of the measures in one part of a cost, and how far apart two sums may be, as a share of
both, to count as equal: 0 for counts."""
Weights = tuple[Part, ...]

FOLD_BACK, DEGENERATE, INVALID, BENDING, AREA, LENGTH, FLAT_INVALID, TIE = range(8)
"""Columns of a part. INVALID counts the invalid bridges at which the strip bends, FLAT_INVALID all
of them."""

UNUSED: Final = 8
"""Unused rail: no column, for it is charged at the two ends alone."""

REAL_TIE: Final = 1e-12
"""Sums of energies, areas or lengths that differ by a smaller share are equal but for round-off:
the same terms, added in another order or measured on congruent triangles."""

_MEASURES: Final = {
    "invalid": (INVALID,),
    "bending": (DEGENERATE, BENDING),
    "area": (AREA,),
    "length": (LENGTH,),
}
_COUNTS: Final = (FOLD_BACK, DEGENERATE, INVALID, FLAT_INVALID)
_PART_COUNTS: Final = (4, 7, 8)
"""Weights have so many parts, the last ones empty: each number is compiled once."""


def checked_criteria(criteria: Criterion | Sequence[Criterion]) -> tuple[Criterion, ...]:
    """Returns the criteria in order, or says why they are none.

    Raises:
        InputError: there is no criterion, an unknown one, or one twice.
    """
    # A word alone is a sequence too, of letters.
    names = (criteria,) if isinstance(criteria, str) else tuple(criteria)
    unknown = [name for name in names if name not in _MEASURES]
    if unknown or not names or len(set(names)) < len(names):
        found = ", ".join(map(str, names)) or "none"
        raise InputError(
            f"criteria cannot be {found}: give an ordered choice of {', '.join(_MEASURES)}, each"
            ' once, for instance ("invalid", "bending").'
        )
    return names


def is_priced(criteria: Sequence[Criterion]) -> bool:
    """Whether invalid bridges may have a price in bending: the criteria begin with both."""
    return tuple(criteria[:2]) == ("invalid", "bending")


def weights_of(
    criteria: Sequence[Criterion], *, bridge_count: int, invalid_cost: float | None = None
) -> Weights:
    """Returns the weights of each part of the cost, in order of comparison.

    Counts in a row share a part as long as a float64 holds them apart exactly.

    Args:
        criteria: ordered choice of "invalid", "bending", "area", "length", each at most once.
        bridge_count: no count is larger.
        invalid_cost: the bending energy that one invalid bridge is worth, for criteria that begin
            with "invalid", "bending"; None where validity comes before any energy.

    Returns:
        4 or 7 parts.

    Raises:
        InputError: there is no criterion, an unknown one, or one twice.

    Example:
        >>> for part in weights_of(["area"], bridge_count=6):
        ...     print(part[:6])
        (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        (0.0, 0.0, 0.0, 0.0, 1.0, 0.0)
        (0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """
    sums = _sums(checked_criteria(criteria), invalid_cost)
    parts = [_part(one) for one in _merged(sums, bridge_count)]
    return _filled(parts)


def free_weights_of(
    criteria: Sequence[Criterion],
    *,
    bridge_count: int,
    invalid_cost: float | None = None,
    unused_cost: float | None = None,
) -> tuple[Weights, tuple[float, ...]]:
    """Returns the weights where rail may be given up, and what 1 mm of it costs in each part.

    With a price it is charged in bending, and of equal costs the one with less unused rail wins.
    Without, it comes just behind the leading counts: no rail is given up for less bending.

    Args:
        criteria: see weights_of.
        bridge_count: see weights_of.
        invalid_cost: see weights_of.
        unused_cost: the bending energy that 1 mm of unused rail is worth, for criteria that begin
            with "bending" and for those with a price; None without.

    Returns:
        4, 7 or 8 parts, and as many charges.

    Example:
        >>> free_weights_of(["bending"], bridge_count=6, unused_cost=0.5)[1]
        (0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0)
    """
    names = checked_criteria(criteria)
    sums = _sums(names, invalid_cost)
    is_charged = unused_cost is not None and (invalid_cost is not None or names[0] == "bending")
    at = next(k for k, one in enumerate(sums) if not _is_count(one))
    if not is_charged:
        at = {"invalid": 2, "bending": 2}.get(names[0], 1)
    sums.insert(at + 1 if is_charged else at, {UNUSED: 1.0})
    merged = _merged(sums, bridge_count)
    charges = [1.0 if UNUSED in one else 0.0 for one in merged]
    if is_charged and unused_cost is not None:
        charges[charges.index(1.0) - 1] = unused_cost
    weights = _filled([_part(one) for one in merged])
    return weights, tuple(charges + [0.0] * (len(weights) - len(charges)))


def _sums(names: tuple[Criterion, ...], invalid_cost: float | None) -> list[dict[int, float]]:
    """What is summed up in each part of the cost, in order."""
    sums: list[dict[int, float]] = []
    if invalid_cost is not None:
        sums = [{DEGENERATE: 1.0}, {BENDING: 1.0, INVALID: invalid_cost}]
        names = names[2:]
    sums = [{FOLD_BACK: 1.0}, *sums]
    sums += [{measure: 1.0} for name in names for measure in _MEASURES[name]]
    if "length" not in names:
        sums.append({LENGTH: 1.0})
    sums.append({FLAT_INVALID: 1.0})
    return sums


def _filled(parts: list[Part]) -> Weights:
    room = next(count for count in _PART_COUNTS if count >= len(parts))
    return tuple(parts + [_part({})] * (room - len(parts)))


def _merged(sums: list[dict[int, float]], bridge_count: int) -> list[dict[int, float]]:
    """Counts that follow each other become the digits of one number."""
    base = 2.0 ** bridge_count.bit_length()
    merged: list[dict[int, float]] = []
    for one in sums:
        last = merged[-1] if merged else {}
        if _is_count(one) and last and _is_count(last) and base ** (len(last) + 1) <= 2.0**53:
            merged[-1] = {measure: base * weight for measure, weight in last.items()} | one
        else:
            merged.append(one)
    return merged


def _is_count(one: dict[int, float]) -> bool:
    return all(measure in _COUNTS for measure in one)


def _part(one: dict[int, float]) -> Part:
    row = [one.get(column, 0.0) for column in range(TIE)]
    tie = 0.0 if _is_count(one) else REAL_TIE
    return (row[0], row[1], row[2], row[3], row[4], row[5], row[6], tie)
