"""From an unrolled strip to pattern pieces: the order in which everything is put on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
import shapely

from wrinkle_cad.errors import Finding, InputError
from wrinkle_cad.strip.curve import polyline

from .allowance import cut_outline
from .bends import all_bends, equal_bends
from .darts import closed_darts
from .flat import FlatStrip, flat_strip
from .neutral import neutral_layer
from .options import (
    END_SIDE,
    P_SIDE,
    Q_SIDE,
    SIDES,
    START_SIDE,
    Hand,
    PerSide,
    PieceSettings,
)  # fmt: skip
from .outline import sew_outline
from .piece import Bends, Floats, Outline, PatternPiece, frozen
from .placing import Refusal, placed_notches, seam_arcs, seam_corners
from .splitting import non_overlapping_runs, overlaps

if TYPE_CHECKING:
    from wrinkle_cad.strip.flat.unrolling import Unrolling
    from wrinkle_cad.strip.triangulation import Triangulation


_SAME_ARC: Final = 1e-3
"""mm; notches nearer to each other along a rail are partners."""


@dataclass(frozen=True, slots=True, eq=False)
class StripParts:
    """A flat strip, whole and as the parts that do not overlap themselves."""

    name: str
    """What its piece is called."""
    strip: FlatStrip
    """The whole strip at its neutral layer."""
    parts: tuple[FlatStrip, ...]
    """One, or more where it was split."""
    turned_over: bool
    """Whether the side that ``p' x (q - p)`` points away from is the right one."""

    @property
    def corners(self) -> tuple[Floats, Floats]:
        """Arc lengths in mm at which P and Q of its pieces have corners.

        Two strips that share a rail pass these to each other (``NotchRule.partner_corners``).
        """
        return seam_corners(self.strip, self.parts)


def strip_parts(
    unrolling: Unrolling,
    triangulation: Triangulation,
    *,
    name: str,
    settings: PieceSettings,
    turned_over: bool = False,
) -> StripParts:
    """Returns the neutral layer of a strip, whole and as the parts that do not overlap.

    A strip that overlaps itself when flat is cut at bridges into the fewest parts that do not,
    with the allowance of the ends and matching notches on the cut.

    Args:
        unrolling: the strip in the plane, Q on the left of P.
        triangulation: the strip in space; its rulings and fold angles are drawn.
        name: what the piece is called; the parts are ``NAME-1``, ``NAME-2``, ...
        settings: everything else.
        turned_over: the side that ``p' x (q - p)`` points away from is the right one.

    Raises:
        InputError: the strip overlaps itself and is not to be split; it is smaller than the
            tolerance.
    """
    is_over = turned_over != (settings.right_side == "back")
    strip = neutral_layer(flat_strip(unrolling, triangulation), settings, turned_over=is_over)
    runs: tuple[tuple[int, int], ...] = ((0, len(strip.bridges) - 1),)
    if overlaps(strip, settings.tolerance):
        if settings.overlap == "refuse":
            raise InputError(
                f"The pattern of {name} overlaps itself when flat, and one flat piece must not. "
                "Let it be split (overlap = split)."
            )
        runs = non_overlapping_runs(strip, tolerance=settings.tolerance)
    return StripParts(name, strip, tuple(strip.run(*run) for run in runs), is_over)


@dataclass(frozen=True, slots=True, eq=False)
class PieceDraft:
    """A piece whose notches are not yet agreed on with the pieces that it is sewn to."""

    piece: PatternPiece
    """With all notches that can stand on it."""
    refused: tuple[Refusal, ...]
    """Those that cannot."""
    turned_over: bool
    """As in ``StripParts``."""


def draft_pieces(parts: StripParts, chosen: PieceSettings) -> tuple[PieceDraft, ...]:
    """Returns the drafts of a strip's pieces, as seen from the side of ``p' x (q - p)``.

    Raises:
        InputError: a notch, hole or direction does not fit the strip.
    """
    arcs = seam_arcs(parts.strip, parts.parts, chosen)
    drafts: list[PieceDraft] = []
    count = len(parts.parts)
    for number, part in enumerate(parts.parts, start=1):
        label = parts.name if count == 1 else f"{parts.name}-{number}"
        piece, refused = _drafted(part.framed(), arcs, label, chosen)
        if count > 1:
            piece = replace(piece, findings=(_split_finding(parts.name, count), *piece.findings))
        drafts.append(PieceDraft(piece, refused, parts.turned_over))
    return tuple(drafts)


def refused_on_rails(drafts: Sequence[PieceDraft]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Returns the arc lengths in mm on P and on Q at which a piece of a strip can have no notch."""
    p_refused, q_refused = (
        tuple(refusal.arc for draft in drafts for refusal in draft.refused if refusal.side == side)
        for side in (P_SIDE, Q_SIDE)
    )
    return p_refused, q_refused


def finished_pieces(
    drafts: Sequence[PieceDraft],
    chosen: PieceSettings,
    *,
    left_out: tuple[Sequence[float], Sequence[float]] = ((), ()),
) -> tuple[PatternPiece, ...]:
    """Returns the pieces of one strip without the notches whose partners cannot stand.

    Args:
        drafts: of one strip.
        chosen: whether the other foot's pieces are wanted, too.
        left_out: arc lengths in mm on P and on Q at which the pieces sewn there have no notch.
    """
    pieces: list[PatternPiece] = []
    for number, draft in enumerate(drafts):
        # What is missing at the end of a piece is missing where the next one starts.
        before = drafts[number - 1].refused if number else ()
        after = drafts[number + 1].refused if number + 1 < len(drafts) else ()
        gone = {
            P_SIDE: left_out[0],
            Q_SIDE: left_out[1],
            START_SIDE: [refusal.arc for refusal in before if refusal.side == END_SIDE],
            END_SIDE: [refusal.arc for refusal in after if refusal.side == START_SIDE],
        }
        kept = tuple(
            notch
            for notch in draft.piece.notches
            if all(abs(notch.arc - arc) > _SAME_ARC for arc in gone[notch.side])
        )
        told = tuple(_refused_finding(draft.piece.name, refusal) for refusal in draft.refused)
        piece = replace(draft.piece, notches=kept, findings=(*draft.piece.findings, *told))
        pieces.extend(_both_hands(piece.turned_over() if draft.turned_over else piece, chosen))
    return tuple(pieces)


def _drafted(
    strip: FlatStrip, arcs: tuple[Floats, Floats], name: str, chosen: PieceSettings
) -> tuple[PatternPiece, tuple[Refusal, ...]]:
    sew = sew_outline(strip.p_line, strip.q_line, tolerance=chosen.tolerance)
    widths = _widths(strip, chosen)
    cut, cut_outs = cut_outline(
        sew, widths, mitre_limit=chosen.mitre_limit, tolerance=chosen.tolerance
    )
    grain = strip.flat_direction(chosen.grain, name="grain")
    stretch = None
    if chosen.stretch is not None:
        stretch = _line_inside(
            sew, strip.middle(), strip.flat_direction(chosen.stretch, name="stretch"), share=0.3
        )
    rulings, fold = _rulings(strip, chosen)
    bends = _bends(strip, chosen)
    notches, refused = placed_notches(strip, arcs, (sew, cut), cut_outs, widths, chosen)
    piece = PatternPiece(
        name=name,
        size=chosen.size,
        quantity=chosen.quantity,
        material=chosen.material,
        tolerance=chosen.tolerance,
        cut=cut,
        sew=sew,
        cut_outs=cut_outs,
        widths=widths,
        notches=notches,
        grain_line=_line_inside(sew, strip.middle(), grain, share=0.7),
        stretch_line=stretch,
        rulings=rulings,
        ruling_fold=fold,
        drill_holes=_drill_holes(strip, cut, chosen, name),
        p_span=(float(strip.p_arc[0]), float(strip.p_arc[-1])),
        q_span=(float(strip.q_arc[0]), float(strip.q_arc[-1])),
        bends=bends,
        findings=(
            *_bend_findings(name, bends, chosen),
            *_allowance_findings(name, cut_outs),
            *_dart_findings(name, sew, cut, widths, chosen.tolerance),
        ),
    )
    return piece, refused


def _widths(strip: FlatStrip, chosen: PieceSettings) -> PerSide:
    """Cut ends get the wider allowance of the two ends, or of the seams where those have none."""
    p_width, q_width, start, end = chosen.widths
    at_cut = max(start, end) or max(p_width, q_width)
    return (
        p_width,
        q_width,
        at_cut if strip.starts_at_cut else start,
        at_cut if strip.ends_at_cut else end,
    )


def _line_inside(sew: Outline, middle: Floats, direction: Floats, *, share: float) -> Floats:
    """Returns a line (2, 2) at the middle of the piece, ``share`` of what fits into it there."""
    region = shapely.Polygon(sew.points)
    reach = 2.0 * np.ptp(sew.points, axis=0).sum() * direction
    inside = region.intersection(shapely.LineString((middle - reach, middle + reach)))
    lines = [part for part in shapely.get_parts(inside) if part.geom_type == "LineString"]
    chord = min(lines, key=lambda line: line.distance(shapely.Point(middle)))
    ends = np.array(chord.coords)[[0, -1]]
    half = 0.5 * share * np.hypot(*(ends[1] - ends[0])) * direction
    centre = ends.mean(axis=0)
    return frozen((centre - half, centre + half))


def _rulings(strip: FlatStrip, chosen: PieceSettings) -> tuple[Floats, Floats]:
    if not chosen.rulings or len(strip.bridges) < 3:
        return frozen(np.zeros((0, 2, 2))), frozen(np.zeros(0))
    inner = strip.bridges[1:-1]
    lines = np.stack((strip.p[inner[:, 0]], strip.q[inner[:, 1]]), axis=1)
    keep = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) >= chosen.tolerance
    if chosen.ruling_spacing > 0.0:
        middles = lines.mean(axis=1)
        slot = np.floor(polyline.arc_lengths(middles) / chosen.ruling_spacing)
        keep &= np.concatenate(([True], np.diff(slot) > 0.0))
    return frozen(lines[keep]), frozen(strip.fold[1:-1][keep])


def _bends(strip: FlatStrip, chosen: PieceSettings) -> Bends | None:
    if chosen.equal_bends is not None:
        return equal_bends(all_bends(strip), chosen.equal_bends)
    return all_bends(strip) if chosen.bend_table else None


def _drill_holes(strip: FlatStrip, cut: Outline, chosen: PieceSettings, name: str) -> Floats:
    shares = np.array(chosen.drill_holes, dtype=np.float64).reshape(-1, 2)
    along, across = shares[:, 0], shares[:, 1]
    holes = np.zeros((len(shares), 2))
    for line, arcs, share in (
        (strip.p_line, strip.p_arc, 1.0 - across),
        (strip.q_line, strip.q_arc, across),
    ):
        at = arcs[0] + along * (arcs[-1] - arcs[0])
        holes += share[:, None] * polyline.points_at(line, arcs, at)
    region = shapely.Polygon(cut.points)
    for i in np.flatnonzero(~shapely.contains_xy(region, holes)):
        raise InputError(
            f"The drill hole {tuple(shares[i].tolist())} of {name} lies outside the flat piece. "
            "Move it inside."
        )
    return frozen(holes)


def _both_hands(piece: PatternPiece, chosen: PieceSettings) -> tuple[PatternPiece, ...]:
    if chosen.hand is None:
        return (piece,)
    other: Hand = "right" if chosen.hand == "left" else "left"
    label = piece.name
    return (
        replace(piece, name=f"{label} {chosen.hand.upper()}".strip(), hand=chosen.hand),
        # What was noticed is told once for both.
        replace(piece.mirrored(name=f"{label} {other.upper()}".strip(), hand=other), findings=()),
    )


def _split_finding(name: str, count: int) -> Finding:
    return Finding(
        "pattern-split",
        "warning",
        f"The pattern of {name} overlapped itself when flat and was split at bridges into {count} "
        "pieces. Sew the cuts together at their notches first.",
    )


def _bend_findings(name: str, bends: Bends | None, chosen: PieceSettings) -> Iterator[Finding]:
    if bends is not None and chosen.equal_bends is not None:
        yield Finding(
            "bends-reduced",
            "info",
            f"{name} is folded in {len(bends.fold)} bends, which leave its curve by at most "
            f"{bends.deviation:.3g} mm.",
        )


def _allowance_findings(name: str, cut_outs: tuple[Floats, ...]) -> Iterator[Finding]:
    if cut_outs:
        yield Finding(
            "allowance-encloses",
            "warning",
            f"The seam allowance of {name} runs into itself around {len(cut_outs)} openings, so "
            "edges stay joined there. Make it narrower or split the strip.",
        )


def _dart_findings(
    name: str, sew: Outline, cut: Outline, widths: PerSide, tolerance: float
) -> Iterator[Finding]:
    if not any(widths):
        return
    for point, mouth in closed_darts(sew, cut, tolerance):
        yield Finding(
            "dart-closed",
            "warning",
            f"A dart of {name} with its point at ({point[0]:.1f}, {point[1]:.1f}) mm is "
            f"{mouth:.3g} mm wide, narrower than the allowances of its edges, so it is not cut. "
            "Make the allowance there less than half as wide, or cut the dart by hand.",
        )


def _refused_finding(name: str, refusal: Refusal) -> Finding:
    return Finding(
        "notch-left-out",
        "warning",
        f"The notches at {refusal.arc:.4g} mm of {SIDES[refusal.side]} of {name} were left out on "
        f"both edges sewn there: {refusal.reason}. Move them, or make the allowance narrower.",
    )
