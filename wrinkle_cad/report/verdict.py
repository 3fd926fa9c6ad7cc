"""The verdict on a job in words a cutter understands, from the numbers in its JSON.

Without limits a strip is folded, creased, stretched or developable; with limits it passes or fails.
The wrinkles are what was asked for, so the job's verdict is theirs; bands, walls that the program
made, are judged apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

from wrinkle_cad import settings
from wrinkle_cad.wrinkle.strip_report import State, StripReport

from .judging import figure, largest_crease, missed_limits
from .limits import Limits

_WORST_FIRST: Final[tuple[State, ...]] = ("folded", "creased", "stretched", "developable")
_MEANING: Final[dict[State, str]] = {
    "folded": "No sheet can take this shape: it would lie on itself or pass through itself.",
    "creased": "A flat sheet takes this shape only with a sharp fold where the crease is marked.",
    "stretched": (
        "A flat sheet must give by so much to take this shape: its middle shrinks, or its seams"
        " stretch."
    ),
    "developable": "A flat sheet can be bent into this shape without creasing, and hardly gives.",
}


@dataclass(frozen=True, slots=True)
class StripVerdict:
    """What is said about one strip, and the figures that only the verdict needs."""

    name: str
    """The strip's name."""
    role: str
    """``strip``, or ``band``."""
    state: State
    """Folded, creased, stretched or developable."""
    sentence: str
    """The state with its figures."""
    passed: bool | None
    """Whether it keeps all limits; None without limits."""
    invalid_percent: float
    """Share of both rails that invalid bridges cover, inflection rulings left out."""
    price_of_developability: float | None
    """Bending energy over that of the least-bending strip; None where that one does not bend."""
    seam_difference_p_mm: float
    """Seam P in the pattern less seam P in space."""
    seam_difference_q_mm: float
    """Likewise of Q."""
    missed: tuple[str, ...]
    """One sentence for each limit that the strip misses."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is said about a job: of its wrinkles, not of the bands."""

    state: State
    """The worst of its strips."""
    headline: str
    """The verdict in one line."""
    meaning: str
    """What it means at the cutting table."""
    piece_differs: bool
    """Whether the piece that is cut of a strip is another surface than the one that is judged."""
    limits: tuple[str, ...]
    """The limits that were given; empty when there were none."""
    passed: bool | None
    """Whether all limits are kept; None without limits."""
    reasons: tuple[str, ...]
    """One sentence for each limit that a strip misses."""
    bands: str
    """What is said of the bands, in one line; empty without any."""
    strips: tuple[StripVerdict, ...]
    """One for each strip and band, in their order."""

    def as_json(self) -> dict[str, Any]:
        """The verdict as plain values, as it stands in NAME.json."""
        return asdict(self)


def entries_of(reports: Sequence[StripReport], limits: Limits) -> list[dict[str, Any]]:
    """Returns the entries of ``strips``, judged, before anything was tried.

    Args:
        reports: one per strip.
        limits: what the strips are judged by.
    """
    entries: list[dict[str, Any]] = [{**report.as_json(), "trials": []} for report in reports]
    for entry, said in zip(entries, judge(entries, limits).strips, strict=True):
        entry["passed"] = said.passed
    return entries


def judge(entries: Sequence[Mapping[str, Any]], limits: Limits) -> Verdict:
    """Judges a job by the ``strips`` of its JSON.

    Args:
        entries: the entries of ``strips``.
        limits: what may not be exceeded; ``Limits()`` for none.
    """
    said = tuple(_judge_strip(entry, limits) for entry in entries)
    leading = [strip for strip in said if strip.role != "band"] or list(said)
    bands = [strip for strip in said if strip.role == "band"]
    names = {strip.name for strip in leading}
    shown = [entry for entry in entries if entry["name"] in names]
    others = [entry["cut"] for entry in shown if entry["cut"]["differs"]]
    state = _worst(leading)
    reasons = tuple(line for strip in leading for line in strip.missed)
    found = [
        each.found
        for entry in shown
        for each in missed_limits(entry, limits, invalid_percent(entry))
    ]
    return Verdict(
        state=state,
        headline=_headline(leading, shown, limits, found),
        meaning=_MEANING[state] + _overlap_words(shown) + _other_piece_words(others),
        piece_differs=bool(others),
        limits=limits.stated,
        passed=None if not limits.stated else not reasons,
        reasons=reasons,
        bands=f"Bands: {_counted(bands, 'band')}." if bands and leading[0].role != "band" else "",
        strips=said,
    )


def invalid_percent(entry: Mapping[str, Any]) -> float:
    """Share of both rails that invalid bridges cover, in per cent; inflections left out."""
    seams = entry["seam_lengths_mm"]
    whole = float(seams["p"]["space"]) + float(seams["q"]["space"])
    invalid = float(entry["invalid_length_p_mm"]) + float(entry["invalid_length_q_mm"])
    return 100.0 * invalid / whole if whole > 0.0 else 0.0


def _judge_strip(entry: Mapping[str, Any], limits: Limits) -> StripVerdict:
    seams, least = entry["seam_lengths_mm"], float(entry["least_bending"])
    missed = tuple(
        f"{each.found} {each.action}".strip()
        for each in missed_limits(entry, limits, invalid_percent(entry))
    )
    return StripVerdict(
        name=entry["name"],
        role=entry.get("role", "strip"),
        state=entry["state"],
        sentence=_sentence(entry),
        passed=None if not limits.stated else not missed,
        invalid_percent=invalid_percent(entry),
        price_of_developability=float(entry["bending"]) / least if least > 0.0 else None,
        seam_difference_p_mm=seams["p"]["pattern"] - seams["p"]["space"],
        seam_difference_q_mm=seams["q"]["pattern"] - seams["q"]["space"],
        missed=missed,
    )


def _sentence(entry: Mapping[str, Any]) -> str:
    return f"{_state_words(entry)} {_other_figures(entry)}{_cut_words(entry)}"


def _cut_words(entry: Mapping[str, Any]) -> str:
    """That the piece is another surface than the figures are of, where it is."""
    cut = entry["cut"]
    if not cut["differs"]:
        return ""
    return f" But the piece that is cut is another surface: {_difference(cut)}."


def _difference(cut: Mapping[str, Any]) -> str:
    longer, larger = (float(cut[f"{key}_percent"]) for key in ("longer", "larger"))
    return (
        f"up to {figure(abs(longer))}% {'longer' if longer >= 0.0 else 'shorter'} along the"
        f" rulings, {figure(abs(larger))}% {'larger' if larger >= 0.0 else 'smaller'} in area"
    )


def _state_words(entry: Mapping[str, Any]) -> str:
    state: State = entry["state"]
    if state == "folded":
        return "Folded: the strip lies back on itself or passes through itself."
    if state == "creased":
        sharpest = max(entry["creases"], key=lambda crease: float(crease["angle_deg"]))
        more = len(entry["creases"]) - 1
        others = f" and at {more} more place{'s' if more > 1 else ''}" if more else ""
        return (
            f"Creased: by {figure(sharpest['angle_deg'])}° at {figure(sharpest['p_mm'])} mm of"
            f" P{others}."
        )
    strain = figure(entry["max_strain_percent"])
    if state == "stretched":
        return f"Stretched: by at most {strain}%, over {figure(entry['stretched_mm'])} mm."
    return f"Developable: strain {strain}%."


def _other_figures(entry: Mapping[str, Any]) -> str:
    radius = entry["inner_bend_radius_mm"]
    bent = "flat" if radius is None else f"smallest bend radius {figure(radius)} mm"
    share = 100.0 * float(entry["developable_share"])
    return (
        f"{figure(share)}% of the rails developable, {bent}, largest twist"
        f" {figure(entry['max_twist_deg'])}°."
    )


def _headline(
    strips: Sequence[StripVerdict],
    entries: Sequence[Mapping[str, Any]],
    limits: Limits,
    found: Sequence[str],
) -> str:
    """PASS or FAIL with limits, in words; the state without."""
    if limits.stated:
        named = f" for {limits.material}" if limits.material else ""
        if found:
            more = f" And {len(found) - 1} more." if len(found) > 1 else ""
            return f"FAIL{named}: {found[0]}{more}"
        return f"PASS{named}: {_kept_words(entries, limits)}."
    if len(strips) == 1:
        return strips[0].sentence
    worst = _worst(strips)
    if all(strip.state == worst for strip in strips):
        return (
            f"{worst.capitalize()}: {'both' if len(strips) == 2 else f'all {len(strips)}'} strips."
        )
    return f"{_counted(strips, 'strip').capitalize()}."


def _kept_words(entries: Sequence[Mapping[str, Any]], limits: Limits) -> str:
    parts = []
    strain = max(float(entry["max_strain_percent"]) for entry in entries)
    crease = max(largest_crease(entry) for entry in entries)
    if limits.max_strain_percent is not None:
        parts.append(f"gives {limits.max_strain_percent:g}%, needs {figure(strain)}%")
    elif strain > settings.STRETCH_PERCENT:
        parts.append(f"needs {figure(strain)}%, which no limit asks about")
    if crease >= settings.CREASE_DEG:
        parts.append(f"creased by {figure(crease)}°, and {limits.allowed_crease_deg:g}° is allowed")
    radii = [entry["inner_bend_radius_mm"] for entry in entries]
    bent = [float(radius) for radius in radii if radius is not None]
    if limits.min_radius_mm is not None and bent:
        parts.append(f"bends to {limits.min_radius_mm:g} mm, needs {figure(min(bent))} mm")
    kept = "; ".join(parts) or "every limit is kept"
    if any(entry["cut"]["differs"] for entry in entries):
        kept += ". But the piece that is cut is another surface"
    return kept


def _worst_cut(cuts: Sequence[Mapping[str, Any]]) -> str:
    """The difference of the piece that differs most along its rulings."""
    return _difference(max(cuts, key=lambda cut: abs(float(cut["longer_percent"]))))


def _counted(strips: Sequence[StripVerdict], role: str) -> str:
    """How many strips are in which state, the worst first: "1 of 3 bands stretched, ..."."""
    parts = []
    for state in _WORST_FIRST:
        count = sum(strip.state == state for strip in strips)
        if count:
            parts.append(f"{count} of {len(strips)} {role}s {state}")
    return ", ".join(parts)


def _worst(strips: Sequence[StripVerdict]) -> State:
    states = {strip.state for strip in strips}
    return next((state for state in _WORST_FIRST if state in states), "developable")


def _other_piece_words(cuts: Sequence[Mapping[str, Any]]) -> str:
    if not cuts:
        return ""
    return f" But the piece that is cut is another surface, {_worst_cut(cuts)}: cut a sample first."


def _overlap_words(entries: Sequence[Mapping[str, Any]]) -> str:
    if any(entry["overlaps"] for entry in entries):
        return " Laid flat in one piece it would cover itself, so the pattern is cut in parts."
    return ""
