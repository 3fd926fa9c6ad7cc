"""Pattern pieces as DXF: one entry for every profile and version, whole files, fixed bytes.

Drawings for cutters come from ``cutter``, blocks for pattern CAD from ``aama``. R12 is written in
its plainest form: by ezdxf's exporter for R12, and for blocks by its exporter for Gerber, without
any block that is not a piece.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Final, get_args

from ezdxf.addons import gerber_D6673, r12export
from ezdxf.document import Drawing

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding, InputError
from wrinkle_cad.files.atomic import write_export
from wrinkle_cad.pattern.piece.piece import PatternPiece
from wrinkle_cad.pattern.piece.stacking import laid_out
from wrinkle_cad.settings import Curves, DxfVersion

from .aama import STYLE_NAME, block_document, block_text_box, scale_piece
from .cutter import cutter_document
from .drawing import text_box
from .ezdxf_log import without_ezdxf_log
from .layers import Profile, profile_from
from .stamping import EPOCH, stamped

VERSIONS: Final[tuple[str, ...]] = get_args(DxfVersion)
CURVES: Final[tuple[str, ...]] = get_args(Curves)


@dataclass(frozen=True, slots=True, eq=False)
class DxfFile:
    """A finished file in memory."""

    content: bytes
    """Its bytes, 7-bit ASCII, the same for the same pieces on every machine."""
    findings: tuple[Finding, ...]
    """Texts that had to be changed, and what its readers may not like."""


def dxf_file(
    pieces: Sequence[PatternPiece],
    *,
    profile: str | Path | Profile = settings.DXF_PROFILE,
    version: DxfVersion | None = None,
    curves: Curves = "lines",
    test_square: bool = False,
    style: str = STYLE_NAME,
    timestamp: datetime | None = None,
    sheet: tuple[float, float] | None = None,
) -> DxfFile:
    """Returns a DXF file of all pieces, laid out side by side at one scale.

    Args:
        pieces: at least one.
        profile: a shipped profile, the user's own ``.toml`` file or a profile itself.
        version: of DXF; None is R2000 for drawings and R12 for blocks (aama, astm).
        curves: contours as ``lines``, with ``arcs`` or as ``splines``; blocks have lines only.
        test_square: add a square of 100 mm to check the scale on the machine.
        style: what all pieces belong to, as files of pieces (aama, astm) state it.
        timestamp: what the file says about when it was made; ``EPOCH`` if None.
        sheet: mm, length and width of the material on which the pieces are nested: they stay where
            they are, and a piece without room for its texts has its name in the waste near it.

    Raises:
        InputError: no pieces, an unknown option, or options that exclude each other.
    """
    chosen = profile if isinstance(profile, Profile) else profile_from(profile)
    _check_options(pieces, chosen, version, curves)
    if sheet is not None and chosen.is_blocks:
        raise InputError(
            f"Sheets are drawings for a cutter, and {chosen.name} is a file of pieces that pattern "
            "CAD nests itself. Choose the profile cutter."
        )
    moment = timestamp or EPOCH
    release = version or ("R12" if chosen.is_blocks else settings.DXF_VERSION)
    stream = io.StringIO()
    # R12 has no unit, and every piece states it.
    with without_ezdxf_log(about="$INSUNITS"):
        if chosen.is_blocks:
            everything = [*pieces, scale_piece(pieces[0])] if test_square else pieces
            document, findings = block_document(
                laid_out(everything, reach=partial(block_text_box, profile=chosen)),
                chosen,
                style=style,
                release=release,
                timestamp=moment,
            )
            if release != "R12":
                findings = (*findings, _layout_blocks_finding(chosen.name, release))
        else:
            document, findings = cutter_document(
                pieces if sheet is not None else laid_out(pieces, reach=text_box),
                chosen,
                release="R2000" if release == "R12" else release,
                curves=curves,
                test_square=test_square,
                sheet=sheet,
            )
        _export(document, stream, is_r12=release == "R12", is_blocks=chosen.is_blocks)
    return DxfFile(stamped(stream.getvalue(), moment).encode("ascii"), findings)


def _export(document: Drawing, stream: io.StringIO, *, is_r12: bool, is_blocks: bool) -> None:
    """Writes a document, R12 in the plainest form that its readers know."""
    if not is_r12:
        document.write(stream)
    elif is_blocks:
        gerber_D6673.export_stream(document, stream)
    else:
        r12export.write(document, stream)


def write_dxf(
    path: Path,
    pieces: Sequence[PatternPiece],
    *,
    profile: str | Path | Profile = settings.DXF_PROFILE,
    version: DxfVersion | None = None,
    curves: Curves = "lines",
    test_square: bool = False,
    timestamp: datetime | None = None,
    sheet: tuple[float, float] | None = None,
) -> tuple[Finding, ...]:
    """Writes a DXF file, whole or not at all, and returns the findings of ``dxf_file``.

    The style is named after the file; the other arguments are those of ``dxf_file``.

    Raises:
        InputError: as ``dxf_file``.
        ExportError: the file cannot be written.
    """
    made = dxf_file(
        pieces,
        profile=profile,
        version=version,
        curves=curves,
        test_square=test_square,
        style=path.stem,
        timestamp=timestamp,
        sheet=sheet,
    )
    write_export(path, "DXF", made.content)
    return made.findings


def _check_options(
    pieces: Sequence[PatternPiece], profile: Profile, version: str | None, curves: str
) -> None:
    if not pieces:
        raise InputError("There are no pieces to write as DXF. Make a pattern first.")
    if version is not None and version not in VERSIONS:
        raise InputError(f"The DXF version is {version!r}. Choose one of {', '.join(VERSIONS)}.")
    if curves not in CURVES:
        raise InputError(f"The curves are {curves!r}. Choose one of {', '.join(CURVES)}.")
    if profile.is_blocks and curves != "lines":
        raise InputError(
            f"The curves are {curves}, and contours of the profile {profile.name} are polylines. "
            "Choose lines."
        )
    if version == "R12" and curves == "splines":
        raise InputError("DXF R12 has no splines. Choose the version R2000 or later.")


def _layout_blocks_finding(profile: str, release: str) -> Finding:
    return Finding(
        "layout-blocks",
        "warning",
        f"The {profile} file is {release}, which needs layout blocks that are no pieces; Gerber "
        "reads blocks of pieces only. Use R12 for it.",
    )
