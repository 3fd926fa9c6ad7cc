"""``Pattern``: the flat pieces of one or several strips, and their way into files and sketches."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding, InputError
from wrinkle_cad.pattern.piece.making import (
    StripParts,
    draft_pieces,
    finished_pieces,
    refused_on_rails,
    strip_parts,
)  # fmt: skip
from wrinkle_cad.pattern.piece.options import NotchRule, PieceSettings
from wrinkle_cad.pattern.piece.piece import PatternPiece
from wrinkle_cad.pattern.piece.stacking import laid_out
from wrinkle_cad.strip.sampled_strip import SampledStrip

if TYPE_CHECKING:
    from build123d import Sketch

    from wrinkle_cad.pattern.piece.nesting import NestedSheet
    from wrinkle_cad.strip.flat.unrolling import Unrolling


class UnrolledStrip(SampledStrip, Protocol):
    """What a pattern needs of a strip."""

    @property
    def p(self) -> object:
        """Its rail P; a strip sewn to that rail has the same object."""

    @property
    def q(self) -> object:
        """Its rail Q, likewise."""

    @property
    def role(self) -> str:
        """What it is for: ``strip``, or ``band`` between a strip and an upper."""

    @property
    def unrolling(self) -> Unrolling:
        """The strip in the plane."""


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Flat pieces at one scale, in mm.

    Example:
        >>> from wrinkle_cad import WrinkleStrip
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> WrinkleStrip(p, q, name="tent").pattern(seam_allowance=(6, 6, 6, 6), hand="left")
        Pattern(2 pieces: tent LEFT, tent RIGHT)
    """

    pieces: tuple[PatternPiece, ...]
    """Laid side by side, none overlapping."""
    strip_index: tuple[int, ...]
    """For each piece the index of the strip that it belongs to."""

    def __repr__(self) -> str:
        names = dict.fromkeys(piece.name for piece in self.pieces)
        more = ", ..." if len(names) > 3 else ""
        return f"Pattern({len(self.pieces)} pieces: {', '.join([*names][:3])}{more})"

    def _repr_html_(self) -> str:
        """What a notebook shows: the drawing of all pieces."""
        from wrinkle_cad.pattern.formats.notebook import figures_with_drawing
        from wrinkle_cad.pattern.formats.svg import drawing_of

        return figures_with_drawing("", {}, drawing_of(self.pieces))

    def pieces_of(self, strip_index: int) -> tuple[PatternPiece, ...]:
        """The pieces of one strip, by its index."""
        pairs = zip(self.strip_index, self.pieces, strict=True)
        return tuple(piece for index, piece in pairs if index == strip_index)

    def notch_arcs(self, strip_index: int, side: int) -> tuple[float, ...]:
        """Where one strip has notches on one side, in mm along the rail in space, ascending.

        Args:
            strip_index: of the strip.
            side: 0 for P, 1 for Q.
        """
        arcs = {
            notch.arc
            for piece in self.pieces_of(strip_index)
            for notch in piece.notches
            if notch.side == side
        }
        return tuple(sorted(arcs))

    def nested(
        self, sheet: tuple[float, float], *, seconds: int = settings.NESTING_SECONDS
    ) -> tuple[NestedSheet, ...]:
        """Nests the pieces, in their quantities, on sheets of material, their grain along x.

        Args:
            sheet: mm, length along the grain and width.
            seconds: that each sheet is searched further for a closer layout, by the package
                spyrrow; with 0 the layout is the same on every machine.

        Raises:
            InputError: a piece does not fit on a sheet, or spyrrow is not installed.
        """
        from wrinkle_cad.pattern.piece.compacting import compacted
        from wrinkle_cad.pattern.piece.nesting import nested

        return tuple(compacted(one, seconds=seconds) for one in nested(self.pieces, sheet=sheet))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What was noticed while the pieces were made."""
        return tuple(finding for piece in self.pieces for finding in piece.findings)

    @property
    def sketch(self) -> Sketch:
        """The cut lines as a build123d ``Sketch`` on XY."""
        from wrinkle_cad.cad.build123d_objects import sketch_from_outline

        return sketch_from_outline([piece.cut_line for piece in self.pieces])

    def export_dxf(
        self,
        path: str | Path,
        *,
        profile: str | Path = settings.DXF_PROFILE,
        version: settings.DxfVersion | None = None,
        curves: settings.Curves = "lines",
        timestamp: datetime | None = None,
        test_square: bool = False,
    ) -> tuple[Finding, ...]:
        """Writes all pieces into one DXF file and returns what had to be changed.

        Args:
            path: the file; replaced as a whole.
            profile: ``cutter``, ``aama``, ``astm`` or a TOML file of layers.
            version: ``R12``, ``R2000`` or ``R2010``; when None, R2000, and R12 for aama, astm.
            curves: what curved cut lines become: ``lines``, ``arcs`` or ``splines``.
            timestamp: the time in the file; when None the one that the environment variable
                SOURCE_DATE_EPOCH gives, else now.
            test_square: adds a square of 100 mm.

        Raises:
            InputError: an unknown profile or version, or SOURCE_DATE_EPOCH is no time.
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from wrinkle_cad.pattern.formats.dxf import write_dxf

        return write_dxf(
            Path(path),
            self.pieces,
            profile=profile,
            version=version,
            curves=curves,
            timestamp=_moment() if timestamp is None else timestamp,
            test_square=test_square,
        )

    def export_svg(
        self, path: str | Path, *, profile: str | Path = settings.DXF_PROFILE
    ) -> tuple[Finding, ...]:
        """Writes all pieces as SVG, 1:1 in mm, and returns what had to be changed.

        It has the same layers as the DXF, and a scale bar.

        Raises:
            InputError: an unknown profile.
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from wrinkle_cad.pattern.formats.svg import write_svg

        return write_svg(Path(path), self.pieces, profile=profile)

    def export_pdf(
        self,
        path: str | Path,
        *,
        profile: str | Path = settings.DXF_PROFILE,
    ) -> tuple[Finding, ...]:
        """Writes all pieces as PDF, 1:1, tiled on A4 sheets, and returns what had to be changed.

        Raises:
            InputError: an unknown profile.
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from wrinkle_cad.pattern.formats.pdf import write_pdf

        return write_pdf(Path(path), self.pieces, profile=profile)


def write_sheets(
    paths: Sequence[Path],
    sheets: Sequence[NestedSheet],
    *,
    profile: str | Path = settings.DXF_PROFILE,
    version: settings.DxfVersion | None = None,
    curves: settings.Curves = "lines",
    timestamp: datetime | None = None,
) -> tuple[Finding, ...]:
    """Writes each sheet into a DXF file of its own and returns what had to be changed.

    Args:
        paths: one for each sheet; replaced as a whole.
        sheets: of ``Pattern.nested``.
        profile: as for ``Pattern.export_dxf``, and likewise the others; ``aama`` and ``astm``
            have no sheets.
        version: of DXF.
        curves: of the cut lines.
        timestamp: the time in the files.

    Raises:
        InputError: an option does not fit.
        ExportError: a file could not be written.
    """
    from wrinkle_cad.pattern.formats.dxf import write_dxf

    moment = _moment() if timestamp is None else timestamp
    return tuple(
        finding
        for path, sheet in zip(paths, sheets, strict=True)
        for finding in write_dxf(
            path,
            sheet.pieces,
            profile=profile,
            version=version,
            curves=curves,
            timestamp=moment,
            sheet=sheet.size,
        )
    )


def _moment() -> datetime:
    """The time of reproducible builds where it is set, else now."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not given:
        return datetime.now(UTC).replace(microsecond=0)
    try:
        return datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError) as error:
        raise InputError(
            f"SOURCE_DATE_EPOCH is {given[:40]!r} and must be whole seconds since 1970, before the "
            "year 10000. Correct it, or give a timestamp."
        ) from error


def pattern_of_strips(
    strips: Iterable[UnrolledStrip],
    piece_settings: PieceSettings | None = None,
    *,
    turned_over: Sequence[bool] = (),
) -> Pattern:
    """Makes the pieces of strips and lays them out.

    Strips that share a rail are sewn together there: their notches stand at the same arcs, and
    where one of them can have none the other has none either.

    Args:
        strips: each gives one piece, or several where it must be split.
        piece_settings: of every piece; the defaults when None.
        turned_over: for each strip whether ``p' x (q - p)`` points away from its right side, as
            it may on an upper; not when empty.

    Raises:
        InputError: a strip covers itself when flat and is not to be split, or a setting does not
            fit it.

    Example:
        >>> from wrinkle_cad import WrinkleStrip
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> strips = [WrinkleStrip(p, q, name="tent"), WrinkleStrip(p, q, name="tent 2")]
        >>> pattern_of_strips(strips, PieceSettings(notches=2))
        Pattern(2 pieces: tent, tent 2)
    """
    given = list(strips)
    over = tuple(turned_over) or (False,) * len(given)
    chosen = piece_settings or PieceSettings()
    parts = [
        strip_parts(
            strip.unrolling, strip.triangulation, name=strip.name, settings=chosen, turned_over=side
        )
        for strip, side in zip(given, over, strict=True)
    ]
    own_settings = list(_settings_by_strip(given, parts, chosen))
    drafts = [draft_pieces(*pair) for pair in zip(parts, own_settings, strict=True)]
    refused: dict[int, tuple[float, ...]] = {}
    for strip, draft in zip(given, drafts, strict=True):
        for rail, arcs in zip(_rails(strip), refused_on_rails(draft), strict=True):
            refused[rail] = (*refused.get(rail, ()), *arcs)
    made = [
        (index, piece)
        for index, (strip, draft, own) in enumerate(zip(given, drafts, own_settings, strict=True))
        for piece in finished_pieces(
            draft, own, left_out=(refused[_rails(strip)[0]], refused[_rails(strip)[1]])
        )
    ]
    return Pattern(laid_out([piece for _, piece in made]), tuple(index for index, _ in made))


def _settings_by_strip(
    strips: Sequence[UnrolledStrip], parts: Sequence[StripParts], chosen: PieceSettings
) -> Iterator[PieceSettings]:
    """The settings of each strip: seams know the corners of the strip on their other side."""
    corners: dict[int, list[float]] = {}
    for strip, own in zip(strips, parts, strict=True):
        for rail, at in zip(_rails(strip), own.corners, strict=True):
            corners.setdefault(rail, []).extend(at.tolist())
    rules: dict[int, NotchRule] = {}
    for strip in strips:
        p_rail, q_rail = _rails(strip)
        # A band follows the rule of the rail that it shares, on its other side as well.
        shared = rules.get(p_rail) or rules.get(q_rail)
        p_own, q_own = chosen.notch_rules
        p_rule = rules.setdefault(p_rail, shared or p_own)
        q_rule = rules.setdefault(q_rail, shared or q_own)
        yield replace(
            chosen,
            notches_p=replace(p_rule, partner_corners=tuple(corners[p_rail])),
            notches_q=replace(q_rule, partner_corners=tuple(corners[q_rail])),
            drill_holes=() if strip.role == "band" else chosen.drill_holes,
        )


def _rails(strip: UnrolledStrip) -> tuple[int, int]:
    # Not by its samples: a band has more of them where a face would be folded.
    return id(strip.p), id(strip.q)
