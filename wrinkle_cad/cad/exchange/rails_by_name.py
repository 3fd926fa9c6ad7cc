"""Which curves are P and Q of which strip, as far as names tell.

``P`` and ``Q`` for one strip, ``<strip>:P`` and ``<strip>:Q`` for several. Where several strips
call their rails P and Q alike, what holds one P and one Q (a product, a set, a layer) is the strip.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Final

from .shapes import RAILS, NamedShape, rail_role

Rails = dict[str, list[NamedShape]]
"""What could be P and what could be Q of one strip."""

_NUMBERED: Final = re.compile(r"([PQ])(\d{3})")
"""FreeCAD gives no name twice: the second P of a document is P001."""


def rails_by_strip(curves: Sequence[NamedShape]) -> dict[str, Rails]:
    """Returns the named rails of each strip; one that is not there, or in question, is no pair.

    Args:
        curves: all that a rail could be.

    Returns:
        By the strip's name, which is empty where the file gives none; for P and Q what is called
        so, after what is less certain was left out: what is hidden, what only lies in something
        of that name beside a curve that has it itself, and names in another case.
    """
    found = _by_role(curves)
    _join_cases(found)
    strips: dict[str, Rails] = {}
    for strip, rails in found.items():
        told = {rail: _surest(strip, rail, rails.get(rail, [])) for rail in RAILS}
        numbered = _numbered(curves) if not strip else {}
        every = {rail: [*told[rail], *(own[rail] for own in numbered.values())] for rail in RAILS}
        apart = _by_holder(every) if max(map(len, every.values())) > 1 else None
        if apart is not None:
            for name, own in apart:
                strips[_unused(name, strips)] = own
            continue
        strips[strip] = told
        strips.update(
            {name: {rail: [own[rail]] for rail in RAILS} for name, own in numbered.items()}
        )
    return strips


def _by_role(curves: Iterable[NamedShape]) -> dict[str, Rails]:
    found: dict[str, Rails] = {}
    for curve in curves:
        role = rail_role(curve.name)
        if role is not None:
            found.setdefault(role[0], {}).setdefault(role[1], []).append(curve)
    return found


def _join_cases(found: dict[str, Rails]) -> None:
    """Makes one strip of those that differ in case only, if P or Q of each lacks."""
    for name in [name for name, rails in found.items() if len(rails) < len(RAILS)]:
        alike = [
            other
            for other, rails in found.items()
            if other.casefold() == name.casefold() and len(rails) < len(RAILS)
        ]
        for other in alike[1:]:
            for rail, curves in found.pop(other).items():
                found[alike[0]].setdefault(rail, []).extend(curves)


def _surest(strip: str, rail: str, curves: list[NamedShape]) -> list[NamedShape]:
    """Leaves out what is less certain than another of the same name."""
    shown = [curve for curve in curves if not curve.is_hidden] or curves
    own = [
        curve
        for curve in shown
        if not any(_is_inside(other, _named_at(curve)) for other in shown if other is not curve)
    ]
    kept = own or shown
    wanted = f"{strip}:{rail}" if strip else rail
    return [curve for curve in kept if curve.name == wanted] or kept


def _named_at(curve: NamedShape) -> str:
    """Returns where the name of a curve stands; empty if that is unknown."""
    own = ((at.name, at.carrier) == (curve.name, curve.named_by) for at in curve.holders)
    return next((at.at for at, is_own in zip(curve.holders, own, strict=True) if is_own), "")


def _is_inside(curve: NamedShape, at: str) -> bool:
    """Whether something holds a curve, but did not give it its name."""
    return bool(at) and at != _named_at(curve) and any(holder.at == at for holder in curve.holders)


def _numbered(curves: Sequence[NamedShape]) -> dict[str, dict[str, NamedShape]]:
    """Returns P and Q by number, such as P001 and Q001, beside a P and a Q without one."""
    plain = {curve.name for curve in curves}
    if not plain.issuperset(RAILS):
        return {}
    found: dict[str, dict[str, NamedShape]] = {}
    for curve in curves:
        match = _NUMBERED.fullmatch(curve.name)
        if match is not None:
            found.setdefault(match[2], {})[match[1]] = curve
    return {number: rails for number, rails in found.items() if len(rails) == len(RAILS)}


def _by_holder(rails: Rails) -> list[tuple[str, Rails]] | None:
    """Returns the strips that hold one P and one Q each, by name; None if some rail is in none."""
    strips: list[tuple[str, Rails]] = []
    for p in rails["P"]:
        for holder in p.holders:
            ps, qs = ([one for one in rails[rail] if _holds(holder.at, one)] for rail in RAILS)
            if len(ps) == len(qs) == 1:
                strips.append((holder.name, {"P": ps, "Q": qs}))
                break
    paired = {id(own["Q"][0]) for _, own in strips}
    is_whole = len(strips) == len(rails["P"]) == len(rails["Q"]) == len(paired)
    return strips if is_whole else None


def _holds(at: str, curve: NamedShape) -> bool:
    return any(holder.at == at for holder in curve.holders)


def _unused(name: str, strips: dict[str, Rails]) -> str:
    """Returns the name, with a number behind it if another strip has it."""
    number = 2
    wanted = name
    while wanted in strips:
        wanted = f"{name} {number}"
        number += 1
    return wanted
