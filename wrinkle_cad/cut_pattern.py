"""``Pattern``: the flat pieces of one or several strips, and their way into files and sketches."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from . import settings
from .findings import Finding
from .pattern.making import make_pieces
from .pattern.nesting import laid_out
from .pattern.options import PieceSettings
from .pattern.piece import PatternPiece

if TYPE_CHECKING:
    from .pattern.contours import Curves
    from .pattern.dxf import DxfVersion
    from .strip.triangulation import Triangulation
    from .strip.unrolling import Unrolling


class FlatStrip(Protocol):
    """What a pattern needs of a strip."""

    @property
    def name(self) -> str:
        """What its pieces are called."""

    @property
    def triangulation(self) -> Triangulation:
        """The strip in space."""

    @property
    def unrolling(self) -> Unrolling:
        """The strip in the plane."""


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Flat pieces at one scale, in mm."""

    pieces: tuple[PatternPiece, ...]
    """Laid side by side, none overlapping."""
    strip_index: tuple[int, ...]
    """For each piece the index of the strip that it belongs to."""

    def pieces_of(self, strip_index: int) -> tuple[PatternPiece, ...]:
        """The pieces of one strip, by its index."""
        pairs = zip(self.strip_index, self.pieces, strict=True)
        return tuple(piece for index, piece in pairs if index == strip_index)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What was noticed while the pieces were made."""
        return tuple(finding for piece in self.pieces for finding in piece.findings)

    @property
    def sketch(self) -> Any:
        """The cut lines as a build123d ``Sketch`` on XY."""
        from .cad.guests import sketch_from_outline

        return sketch_from_outline([piece.cut_line for piece in self.pieces])

    def export_dxf(
        self,
        path: str | Path,
        *,
        profile: str | Path = settings.DXF_PROFILE,
        version: DxfVersion | None = None,
        curves: Curves = "lines",
        timestamp: datetime | None = None,
        test_square: bool = False,
    ) -> tuple[Finding, ...]:
        """Writes all pieces into one DXF file and returns what had to be changed.

        Args:
            path: the file; replaced as a whole.
            profile: ``cutter``, ``aama``, ``astm`` or a TOML file of layers.
            version: ``R12``, ``R2000`` or ``R2010``; when None, R2000, and R12 for aama, astm.
            curves: what curved cut lines become: ``lines``, ``arcs`` or ``splines``.
            timestamp: the time in the file; the start of 1970 when None.
            test_square: adds a square of 100 mm.

        Raises:
            InputError: an unknown profile or version.
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from .pattern.dxf import write_dxf

        return write_dxf(
            Path(path),
            self.pieces,
            profile=profile,
            version=version,
            curves=curves,
            timestamp=timestamp,
            test_square=test_square,
        )

    def export_svg(self, path: str | Path, *, profile: str | Path = settings.DXF_PROFILE) -> None:
        """Writes all pieces as SVG, 1:1 in mm, with the same layers and a scale bar.

        Raises:
            InputError: an unknown profile.
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from .pattern.svg import write_svg

        write_svg(Path(path), self.pieces, profile=profile)

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
        from .pattern.pdf import write_pdf

        return write_pdf(Path(path), self.pieces, profile=profile)


def pattern_of_strips(
    strips: Iterable[FlatStrip], piece_settings: PieceSettings | None = None
) -> Pattern:
    """Makes the pieces of strips and lays them out.

    Args:
        strips: each gives one piece, or several where it must be split.
        piece_settings: of every piece; the defaults when None.

    Raises:
        InputError: a strip covers itself when flat and is not to be split, or a setting does not
            fit it.
    """
    made = [
        (index, piece)
        for index, strip in enumerate(strips)
        for piece in make_pieces(
            strip.unrolling, strip.triangulation, name=strip.name, settings=piece_settings
        )
    ]
    return Pattern(laid_out([piece for _, piece in made]), tuple(index for index, _ in made))
