"""Which shapes of a file are P, Q and the upper, and why.

By name: ``upper``, and the rails as ``rails_by_name`` finds them. Names are compared exactly first
and regardless of case then. Without such names exactly two free
edges or wires are P and Q, and the only free face or shell is the upper. A choice by hand beats all
of it. Nothing is compared here: whether P and Q are the same curve shows when they are measured.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError

from .joined_curves import gap_hint, joined_curves
from .rails_by_name import rails_by_strip
from .shapes import RAILS, UPPER, CadFile, NamedShape, rail_role

_PLURALS: Final = {"vertex": "vertices"}


@dataclass(frozen=True, slots=True, eq=False)
class StripInput:
    """The two curves of one strip."""

    name: str
    """What stands before ``:P`` in the file, else a default."""
    p: NamedShape
    """Directrix P."""
    q: NamedShape
    """Directrix Q."""


@dataclass(frozen=True, slots=True, eq=False)
class Chosen:
    """What a job works on."""

    strips: tuple[StripInput, ...]
    """At least one, in the order of their P in the file."""
    upper: NamedShape | None
    """The surface to carve, if the file has one."""
    reasons: tuple[str, ...]
    """For each choice one sentence: what was taken and why."""


def choose_inputs(
    cad_file: CadFile,
    *,
    p: str | None = None,
    q: str | None = None,
    upper: str | None = None,
    join: float = 0.0,
) -> Chosen:
    """Chooses the curves of every strip, and the upper.

    Args:
        cad_file: what the file holds.
        p: name or index of directrix P, where the file's names do not say it; then there is one
            strip.
        q: likewise for Q.
        upper: name or index of the upper; a solid is taken only when it is named here.
        join: mm; candidates for one rail with gaps up to this between their ends are one curve.

    Raises:
        InputError: there is no curve, no or more than one possible choice, or a name or index that
            the file does not have; the message lists the candidates with their measures.

    Example:
        >>> from pathlib import Path
        >>> from wrinkle_cad import Part, read_cad, write_step
        >>> from build123d import Edge, Face
        >>> rails = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
        >>> shapes = zip([Face.make_rect(100, 60), *rails], ["upper", "P", "Q"], strict=True)
        >>> write_step(Path("shoe.step"), [Part(shape.wrapped, name) for shape, name in shapes])
        >>> chosen = choose_inputs(read_cad(Path("shoe.step")))
        >>> [strip.p.name for strip in chosen.strips], chosen.upper.name
        (['P'], 'upper')
    """
    if p is None and q is None:
        strips, reasons = _named_strips(cad_file, join)
        if not strips:
            strips, reasons = _only_two_curves(cad_file, join)
    else:
        strips, reasons = _strip_by_hand(cad_file, p, q, join)
    surface, why = _upper(cad_file, upper, is_named=_has_convention(cad_file))
    return Chosen(tuple(strips), surface, (*reasons, why))


def _has_convention(cad_file: CadFile) -> bool:
    return any(rail_role(curve.name) for curve in cad_file.curves()) or any(
        shape.name.casefold() == UPPER for shape in cad_file.shapes
    )


def _named_strips(cad_file: CadFile, join: float) -> tuple[list[StripInput], list[str]]:
    strips, reasons = [], []
    found = rails_by_strip(cad_file.curves())
    for name, rails in found.items():
        pair = [_one_rail(cad_file, name, rail, joined_curves(rails[rail], join)) for rail in RAILS]
        strips.append(StripInput(name or settings.STRIP_NAME, *pair))
        of = f" of {name}" if len(found) > 1 else ""
        reasons += [
            f"{rail}{of} is {shape}, {_by(shape)}" for rail, shape in zip(RAILS, pair, strict=True)
        ]
    return strips, reasons


def _by(shape: NamedShape) -> str:
    """Says whose name told the role."""
    words = {"set", "group", "layer", "representation", "instance"}
    if shape.named_by in words:
        return f"by the name of its {shape.named_by}"
    nearest = next((holder for holder in shape.holders if holder.carrier == "product"), None)
    is_far = shape.named_by == "product" and nearest is not None and nearest.name != shape.name
    return "by the name of what holds it" if is_far else "by its name"


def _one_rail(cad_file: CadFile, strip: str, rail: str, fits: list[NamedShape]) -> NamedShape:
    if len(fits) == 1:
        return fits[0]
    wanted = f"{strip}:{rail}" if strip else rail
    if not fits:
        raise _fail(
            cad_file,
            f"no curve is called '{wanted}', its counterpart is there; found"
            f" {_listed(cad_file.curves())}. Name it or choose with --p and --q.",
        )
    raise _fail(
        cad_file,
        f"{len(fits)} curves are called '{wanted}': {_listed(fits)}. Join them to one wire, or"
        f" choose with --p and --q.{gap_hint(fits, 1)}",
    )


def _only_two_curves(cad_file: CadFile, join: float) -> tuple[list[StripInput], list[str]]:
    curves: Sequence[NamedShape] = cad_file.curves()
    if len(curves) > 2:
        curves = joined_curves(curves, join)
    if len(curves) != 2:
        raise _wrong_count(cad_file, curves)
    # Whoever gave both a name meant these, not the order that a program writes them in.
    names = [_natural(curve.name) for curve in curves]
    is_named = all(curve.name for curve in curves) and names[0] != names[1]
    first, second = curves if not is_named or names[0] < names[1] else curves[::-1]
    order = " by name" if is_named else ""
    reasons = [
        f"P is {first}, the first{order} of the only two free curves",
        f"Q is {second}, the second{order} of the only two free curves",
    ]
    return [StripInput(settings.STRIP_NAME, first, second)], reasons


def _natural(name: str) -> list[tuple[int, str]]:
    """A name as people sort it: Curve 9 before Curve 10."""
    parts = re.split(r"(\d+)", name.casefold())
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts]


def _wrong_count(cad_file: CadFile, curves: Sequence[NamedShape]) -> InputError:
    if not curves:
        return _fail(
            cad_file,
            f"no curves: the file holds {_summary(cad_file)}, a strip needs two free edges or"
            " wires P and Q. Add them to the file.",
        )
    if len(curves) == 1:
        return _fail(
            cad_file,
            f"only one curve: {curves[0]}, a strip needs two free edges or wires P and Q"
            ". Add the other one to the file.",
        )
    return _fail(
        cad_file,
        f"{len(curves)} free curves and none is called P or Q: {_listed(curves)}."
        f" Choose two with --p and --q, or name them.{gap_hint(curves, 2)}",
    )


def _strip_by_hand(
    cad_file: CadFile, p: str | None, q: str | None, join: float
) -> tuple[list[StripInput], list[str]]:
    chosen_p = None if p is None else _picked(cad_file, p, "p", join)
    chosen_q = None if q is None else _picked(cad_file, q, "q", join)
    rail_p = chosen_p or _counterpart(cad_file, chosen_q, "P", join)
    rail_q = chosen_q or _counterpart(cad_file, chosen_p, "Q", join)
    for rail, option in ((rail_p, "p"), (rail_q, "q")):
        if not rail.is_curve:
            raise _fail(
                cad_file,
                f"--{option} chooses {rail}, a rail is an edge or a wire; found"
                f" {_listed(cad_file.curves()) or 'no curves'}. Choose one of these.",
            )
    if rail_p.index == rail_q.index:
        raise _fail(cad_file, f"--p and --q both choose {rail_p}. Choose two curves.")
    role = rail_role(rail_p.name)
    name = (role[0] if role else "") or settings.STRIP_NAME
    reasons = [
        f"P is {rail_p}, {'as chosen' if p is not None else 'the counterpart of the chosen Q'}",
        f"Q is {rail_q}, {'as chosen' if q is not None else 'the counterpart of the chosen P'}",
    ]
    return [StripInput(name, rail_p, rail_q)], reasons


def _counterpart(cad_file: CadFile, other: NamedShape | None, rail: str, join: float) -> NamedShape:
    """Finds the rail that was not chosen: by its name, else as the only other curve."""
    taken = () if other is None else (other.index, *other.parts)
    rest = [curve for curve in cad_file.curves() if curve.index not in taken]
    role = rail_role(other.name) if other is not None else None
    strip = role[0] if role else ""
    named = [
        curve
        for curve in rest
        if (found := rail_role(curve.name)) and found[0] == strip and found[1] == rail
    ]
    for fits in (named, rest):
        if len(one := joined_curves(fits, join)) == 1:
            return one[0]
    raise _fail(
        cad_file,
        f"only one rail is chosen; {rail} could be {_listed(rest) or 'none of the shapes'}"
        f". Choose it with --{rail.lower()}.",
    )


def _picked(cad_file: CadFile, text: str, option: str, join: float = 0.0) -> NamedShape:
    """Finds the one shape that a name or an index means."""
    shapes = cad_file.shapes
    wanted = text.strip()
    by_name = [shape for shape in shapes if wanted and shape.name == wanted]
    digits = wanted.removeprefix("[").removesuffix("]")
    by_index = [shape for shape in shapes if digits.isdecimal() and shape.index == int(digits)]
    by_case = [shape for shape in shapes if shape.name.casefold() == wanted.casefold()]
    for fits in (by_name, by_index, by_case if wanted else []):
        suited = [shape for shape in fits if shape.is_curve == (option != UPPER)] or fits
        if option != UPPER and all(shape.is_curve for shape in suited):
            suited = joined_curves(suited, join)
        if len(suited) == 1:
            return suited[0]
        if suited:
            raise _fail(
                cad_file,
                f"--{option} '{wanted}' means {len(suited)} shapes: {_listed(suited)}"
                ". Choose by index.",
            )
    raise _fail(
        cad_file,
        f"--{option} '{wanted}' is neither a name nor an index; found {_listed(shapes)}"
        ". Choose one of these.",
    )


def _upper(
    cad_file: CadFile, upper: str | None, *, is_named: bool
) -> tuple[NamedShape | None, str]:
    if upper is not None:
        chosen = _picked(cad_file, upper, UPPER)
        if chosen.is_curve or chosen.measure <= 0.0:
            raise _fail(cad_file, f"--upper chooses {chosen}, an upper has faces. Choose another.")
        return chosen, f"upper is {chosen}, as chosen"
    named = [
        shape
        for shape in cad_file.shapes
        if shape.name.casefold() == UPPER and not shape.is_curve and shape.measure > 0.0
    ]
    shown = [shape for shape in named if not shape.is_hidden] or named
    fits = [shape for shape in shown if shape.name == UPPER] or shown
    if len(fits) == 1:
        return fits[0], f"upper is {fits[0]}, by its name"
    surfaces = cad_file.surfaces()
    if not fits and (is_named or not surfaces):
        return None, "no upper: no shape is called 'upper'" if is_named else "no upper in the file"
    if not fits and len(surfaces) == 1:
        return surfaces[0], f"upper is {surfaces[0]}, the only free surface"
    several = fits or list(surfaces)
    raise _fail(
        cad_file,
        f"{len(several)} shapes could be the upper: {_listed(several)}. Choose with --upper.",
    )


def _listed(shapes: Sequence[NamedShape]) -> str:
    """Lists candidates with their measures, the first ones if there are many."""
    shown = ", ".join(str(shape) for shape in shapes[: settings.LISTED_SHAPES])
    more = len(shapes) - settings.LISTED_SHAPES
    return f"{shown} and {more} more" if more > 0 else shown


def _summary(cad_file: CadFile) -> str:
    counts: dict[str, int] = {}
    for shape in cad_file.shapes:
        if shape.is_free:
            counts[shape.kind] = counts.get(shape.kind, 0) + 1
    words = (
        f"{count} {_PLURALS.get(kind, f'{kind}s') if count > 1 else kind}"
        for kind, count in counts.items()
    )
    return "only " + " and ".join(words)


def _fail(cad_file: CadFile, found: str) -> InputError:
    note = " (the file is gzip-compressed and was unpacked)" if cad_file.is_compressed else ""
    return InputError(f"Cannot choose curves in {cad_file.path.name}{note}: {found}")
