"""From an unrolled strip to pattern pieces: the order in which everything is put on."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from wrinkle_cad.errors import Finding, InputError
from wrinkle_cad.strip.curve import polyline

from .allowance import cut_outline
from .flat import FlatStrip, flat_strip
from .neutral import neutral_layer
from .options import Hand, PerSide, PieceSettings
from .outline import sew_outline
from .piece import Floats, Outline, PatternPiece, frozen
from .placing import placed_notches, seam_arcs, seam_corners
from .splitting import non_overlapping_runs, overlaps

if TYPE_CHECKING:
    from wrinkle_cad.strip.flat.unrolling import Unrolling
    from wrinkle_cad.strip.triangulation import Triangulation


def make_pieces(
    unrolling: Unrolling,
    triangulation: Triangulation,
    *,
    name: str,
    settings: PieceSettings | None = None,
) -> tuple[PatternPiece, ...]:
    """Returns the pieces of one strip: one, or more where it must be split or is wanted twice.

    A strip that overlaps itself when flat is cut at bridges into the fewest pieces that do not
    (``NAME-1``, ``NAME-2``, ...), with the allowance of the ends and matching notches on the cut.
    With ``settings.hand`` each piece is followed by its mirror image for the other foot.

    Args:
        unrolling: the strip in the plane, Q on the left of P.
        triangulation: the strip in space; its rulings and fold angles are drawn.
        name: what the piece is called.
        settings: everything else.

    Raises:
        InputError: the strip overlaps itself and is not to be split; a notch, hole or direction
            does not fit it; it is smaller than the tolerance.
    """
    chosen = settings or PieceSettings()
    strip, parts = _strip_in_parts(unrolling, triangulation, name, chosen)
    arcs = seam_arcs(strip, parts, chosen)
    pieces: list[PatternPiece] = []
    for count, part in enumerate(parts, start=1):
        label = name if len(parts) == 1 else f"{name}-{count}"
        piece = _one_piece(part.framed(), arcs, label, chosen)
        if len(parts) > 1:
            piece = replace(piece, findings=(_split_finding(name, len(parts)), *piece.findings))
        pieces.extend(_both_hands(piece, chosen))
    return tuple(pieces)


def rail_corners(
    unrolling: Unrolling,
    triangulation: Triangulation,
    *,
    name: str,
    settings: PieceSettings | None = None,
) -> tuple[Floats, Floats]:
    """Returns the arc lengths in mm at which P and Q of a strip's pieces have corners.

    Two strips that share a rail pass these to each other (``NotchRule.partner_corners``).

    Raises:
        InputError: as ``make_pieces``, where the strip overlaps itself.
    """
    chosen = settings or PieceSettings()
    return seam_corners(*_strip_in_parts(unrolling, triangulation, name, chosen))


def _strip_in_parts(
    unrolling: Unrolling, triangulation: Triangulation, name: str, chosen: PieceSettings
) -> tuple[FlatStrip, list[FlatStrip]]:
    """Returns the neutral layer of a strip, whole and as the parts that do not overlap."""
    strip = neutral_layer(flat_strip(unrolling, triangulation), chosen.neutral_offset)
    runs: tuple[tuple[int, int], ...] = ((0, len(strip.bridges) - 1),)
    if overlaps(strip, chosen.tolerance):
        if chosen.overlap == "refuse":
            raise InputError(
                f"pattern of {name} - it overlaps itself when flat - one flat piece must not - "
                "let it be split (overlap: split)"
            )
        runs = non_overlapping_runs(strip, tolerance=chosen.tolerance)
    return strip, [strip.run(*run) for run in runs]


def make_piece(
    unrolling: Unrolling,
    triangulation: Triangulation,
    *,
    name: str,
    settings: PieceSettings | None = None,
) -> PatternPiece:
    """Returns the one piece of a strip that fits into one; see ``make_pieces``.

    Raises:
        InputError: as ``make_pieces``, and whenever more than one piece would be needed.
    """
    chosen = replace(settings or PieceSettings(), overlap="refuse")
    pieces = make_pieces(unrolling, triangulation, name=name, settings=chosen)
    if len(pieces) > 1:
        raise InputError(
            f"pattern of {name} - {len(pieces)} pieces wanted (hand) - one - use make_pieces"
        )
    return pieces[0]


def _one_piece(
    strip: FlatStrip, arcs: tuple[Floats, Floats], name: str, chosen: PieceSettings
) -> PatternPiece:
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
    return PatternPiece(
        name=name,
        size=chosen.size,
        quantity=chosen.quantity,
        material=chosen.material,
        tolerance=chosen.tolerance,
        cut=cut,
        sew=sew,
        cut_outs=cut_outs,
        widths=widths,
        notches=placed_notches(strip, arcs, cut, widths, chosen),
        grain_line=_line_inside(sew, strip.middle(), grain, share=0.7),
        stretch_line=stretch,
        rulings=rulings,
        ruling_fold=fold,
        drill_holes=_drill_holes(strip, cut, chosen, name),
        p_span=(float(strip.p_arc[0]), float(strip.p_arc[-1])),
        q_span=(float(strip.q_arc[0]), float(strip.q_arc[-1])),
        findings=_allowance_findings(name, cut_outs),
    )


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
            f"drill hole {tuple(shares[i])} of {name} - outside the flat piece - inside - move it"
        )
    return frozen(holes)


def _both_hands(piece: PatternPiece, chosen: PieceSettings) -> tuple[PatternPiece, ...]:
    if chosen.hand is None:
        return (piece,)
    other: Hand = "right" if chosen.hand == "left" else "left"
    label = piece.name
    return (
        replace(piece, name=f"{label} {chosen.hand.upper()}".strip(), hand=chosen.hand),
        piece.mirrored(name=f"{label} {other.upper()}".strip(), hand=other),
    )


def _split_finding(name: str, count: int) -> Finding:
    return Finding(
        "pattern-split",
        "warning",
        f"pattern of {name} - overlapped itself when flat - split at bridges into {count} pieces "
        "- sew the cuts together at their notches first",
    )


def _allowance_findings(name: str, cut_outs: tuple[Floats, ...]) -> tuple[Finding, ...]:
    if not cut_outs:
        return ()
    return (
        Finding(
            "allowance-encloses",
            "warning",
            f"seam allowance of {name} - runs into itself around {len(cut_outs)} openings - edges "
            "stay joined there - make it narrower or split the strip",
        ),
    )
