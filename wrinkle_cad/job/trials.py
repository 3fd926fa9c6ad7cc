"""What would help a strip that is not developable or misses a limit: one change at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from wrinkle_cad import settings
from wrinkle_cad.errors import WrinkleError

from .job import Job

if TYPE_CHECKING:
    from wrinkle_cad.cad.exchange.choose import Chosen
    from wrinkle_cad.report.limits import Limits
    from wrinkle_cad.wrinkle.triangulated_strip import TriangulatedStrip

    from .wrinkled_upper import WrinkledUpper

FINER: Final = 0.25
"""The tolerance is tried at this share of itself, ..."""
LOWER: Final = 0.5
"""... heights at this, ..."""
WIDER: Final = 1.5
"""... margin and fade at this."""
LONGEST_FADE: Final = 0.5
_FIGURES: Final = (
    "max_strain_percent",
    "inner_bend_radius_mm",
    "bend_radius_along_grain_mm",
    "bend_radius_across_grain_mm",
    "max_twist_deg",
    "developable_share",
)


@dataclass(frozen=True, slots=True)
class Lever:
    """One change of a job's settings."""

    words: str
    """As flags."""
    changes: Mapping[str, Any]
    """The settings that differ."""


def levers_of(job: Job, *, on_upper: bool, piece_differs: bool = False) -> Iterator[Lever]:
    """Returns the changes that exist for a job: those of the waves first.

    Args:
        job: its settings.
        on_upper: whether its strips are stitched into an upper.
        piece_differs: whether the piece that is cut of a wrinkle is not the surface that is judged.

    Example:
        >>> from pathlib import Path
        >>> job = Job(input=Path("shoe.step"), waves=5, height=3, margin=4)
        >>> [lever.words for lever in levers_of(job, on_upper=True)]
        ['--height 1.5', '--margin 6', '--fade 0.45', '--tolerance 0.0125', '--price none']
    """
    if on_upper and job.height is not None:
        yield _lever("height", tuple(LOWER * height for height in job.height))
    margin = job.margin_asked
    if on_upper and margin:
        yield _lever("margin", WIDER * margin)
    if on_upper and job.height is not None:
        if job.fade < LONGEST_FADE:
            yield _lever("fade", min(LONGEST_FADE, round(WIDER * job.fade, 6)))
        if job.phase_deg[0] != job.phase_deg[1]:
            yield _lever("phase_deg", (job.phase_deg[0], job.phase_deg[0]))
    yield _lever("tolerance", FINER * job.tolerance)
    is_default = job.criteria == settings.CRITERIA and job.search == "global"
    if is_default and job.price is not None:
        yield _lever("price", None)
    if piece_differs and is_default:
        yield _lever("criteria", ("bending",))
    if piece_differs and job.surface == "cones":
        yield _lever("surface", "smooth")


def add_trials(
    job: Job,
    chosen: Chosen,
    upper: WrinkledUpper | None,
    entries: Sequence[dict[str, Any]],
    limits: Limits,
) -> None:
    """Adds to the entries of ``strips`` that want help what was tried on each of them.

    Args:
        job: the settings.
        chosen: the rails and the upper.
        upper: the upper as it was made; None without one.
        entries: of ``strips`` in the JSON, judged.
        limits: what the strips are judged by.
    """
    wanting = {entry["name"]: entry for entry in entries if _wants_help(entry)}
    if not wanting:
        return
    piece_differs = any(map(_piece_differs, entries))
    on_upper = chosen.upper is not None
    for lever in levers_of(job, on_upper=on_upper, piece_differs=piece_differs):
        # Smooth faces take longest to make: they are the last resort.
        if "surface" in lever.changes and all(map(_is_matched, entries)):
            continue
        try:
            strips = _strips_of(replace(job, **lever.changes), chosen, upper, set(wanting))
            found = _figures_of(strips, limits)
        except WrinkleError as error:
            found = {name: {"failed": str(error)} for name in wanting}
        for name, figures in found.items():
            if name in wanting:
                wanting[name]["trials"].append({"change": lever.words, **figures})


def _lever(name: str, value: Any) -> Lever:
    return Lever(f"--{name.replace('_', '-')} {_written(value)}", {name: value})


def _written(value: Any) -> str:
    if isinstance(value, str):
        return value
    if value is None:
        return "none"
    if isinstance(value, tuple):
        parts = [_written(part) for part in value]
        return parts[0] if len(set(parts)) == 1 else ",".join(parts)
    return f"{value:g}"


def _wants_help(entry: Mapping[str, Any]) -> bool:
    fails = entry["state"] != "developable" or entry["passed"] is False
    return fails or _piece_differs(entry)


def _is_matched(entry: Mapping[str, Any]) -> bool:
    """Whether the piece is the surface that is judged, or was with another change."""
    tried = (trial.get("cut_differs", True) for trial in entry["trials"])
    return not _piece_differs(entry) or not all(tried)


def _piece_differs(entry: Mapping[str, Any]) -> bool:
    return bool(entry["role"] == "strip" and entry["cut"]["differs"])


def _strips_of(
    job: Job, chosen: Chosen, upper: WrinkledUpper | None, names: set[str]
) -> Sequence[TriangulatedStrip]:
    if upper is not None:
        from .wrinkled_upper import tried_on_upper

        return tried_on_upper(job, chosen, upper, names)
    from .parts import rails_of, strip_name, strip_of

    return [
        strip_of(job, *rails_of(job, given), given.name)
        for given in chosen.strips
        if strip_name(job, given.name) in names
    ]


def _figures_of(strips: Sequence[TriangulatedStrip], limits: Limits) -> dict[str, dict[str, Any]]:
    from wrinkle_cad.report.judging import largest_crease
    from wrinkle_cad.report.verdict import judge

    entries = [strip.trial_report.as_json() for strip in strips]
    verdict = judge(entries, limits)
    return {
        entry["name"]: {
            "state": entry["state"],
            "passed": said.passed,
            "max_crease_deg": largest_crease(entry),
            **{key: entry[key] for key in _FIGURES},
            "cut_longer_percent": entry["cut"]["longer_percent"],
            "cut_differs": entry["cut"]["differs"],
        }
        for entry, said in zip(entries, verdict.strips, strict=True)
    }
