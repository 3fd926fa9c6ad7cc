"""Pieces as a file, exact to the last bit: what the sheets of a whole batch are nested from."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

import numpy as np

from wrinkle_cad.errors import InputError
from wrinkle_cad.files.atomic import write_export
from wrinkle_cad.files.regular import read_regular
from wrinkle_cad.pattern.piece.piece import (
    Bends,
    Floats,
    Notch,
    Outline,
    PatternPiece,
    frozen,
    make_outline,
)

SCHEMA: Final = "wrinkle_cad/pieces"
SCHEMA_VERSION: Final = 1

_SIZE_LIMIT: Final = 64 * 2**20
"""Bytes of the largest file that is read."""


def pieces_text(pieces: Sequence[PatternPiece]) -> str:
    """Returns pieces as JSON, without what was noticed while they were made."""
    values = [_values_of(piece) for piece in pieces]
    content = {"schema": SCHEMA, "version": SCHEMA_VERSION, "pieces": values}
    return json.dumps(content, allow_nan=False) + "\n"


def write_pieces(path: Path, pieces: Sequence[PatternPiece]) -> None:
    """Writes pieces, whole or not at all.

    Raises:
        ExportError: the file cannot be written.
    """
    write_export(path, "pieces", pieces_text(pieces).encode("ascii"))


def read_pieces(path: Path) -> tuple[PatternPiece, ...]:
    """Returns the pieces of a file that ``write_pieces`` wrote.

    Raises:
        InputError: it cannot be read, or is no such file.
    """
    try:
        content = json.loads(read_regular(path, size_limit=_SIZE_LIMIT))
        if (content["schema"], content["version"]) != (SCHEMA, SCHEMA_VERSION):
            raise ValueError("another schema")
        return tuple(_piece_of(values) for values in content["pieces"])
    except OSError as error:
        message = f"{path.name} cannot be read ({error.strerror or error}). Make it anew."
        raise InputError(message) from error
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise InputError(
            f"{path.name} is no file of pieces of this version. Make it anew from its input."
        ) from error


def _values_of(value: Any) -> Any:
    """Returns a piece, or a part of one, as values that JSON can hold."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return [_values_of(part) for part in value]
    if isinstance(value, PatternPiece | Outline | Notch | Bends):
        names = (field.name for field in fields(value) if field.name != "findings")
        return {name: _values_of(getattr(value, name)) for name in names}
    return value


def _piece_of(values: Mapping[str, Any]) -> PatternPiece:
    plain = ("name", "size", "quantity", "material", "tolerance", "hand", "is_mirrored")
    bends = values["bends"]
    return PatternPiece(
        **{name: values[name] for name in plain},
        cut=_outline_of(values["cut"]),
        sew=_outline_of(values["sew"]),
        cut_outs=tuple(_points(ring, (-1, 2)) for ring in values["cut_outs"]),
        widths=tuple(map(float, values["widths"])),  # type: ignore[arg-type]
        notches=tuple(_notch_of(notch) for notch in values["notches"]),
        grain_line=_points(values["grain_line"], (2, 2)),
        stretch_line=_points(values["stretch_line"], (2, 2)) if values["stretch_line"] else None,
        rulings=_points(values["rulings"], (-1, 2, 2)),
        ruling_fold=_points(values["ruling_fold"], (-1,)),
        drill_holes=_points(values["drill_holes"], (-1, 2)),
        p_span=_span_of(values["p_span"]),
        q_span=_span_of(values["q_span"]),
        bends=None if bends is None else _bends_of(bends),
    )


def _outline_of(values: Mapping[str, Any]) -> Outline:
    points = _points(values["points"], (-1, 2))
    outline = make_outline(points, values["sides"], values["corners"])
    if not len(points) == len(outline.sides) == len(outline.corners):
        raise ValueError("an outline of different lengths")
    return outline


def _notch_of(values: Mapping[str, Any]) -> Notch:
    arrays = {name: _points(values[name], (2,)) for name in ("seam", "position", "direction")}
    return Notch(**{**values, **arrays})


def _bends_of(values: Mapping[str, Any]) -> Bends:
    return Bends(
        lines=_points(values["lines"], (-1, 2, 2)),
        fold=_points(values["fold"], (-1,)),
        arcs=_points(values["arcs"], (-1, 2)),
        radius=_points(values["radius"], (-1,)),
        deviation=float(values["deviation"]),
    )


def _span_of(values: Sequence[float]) -> tuple[float, float]:
    first, last = map(float, values)
    return first, last


def _points(values: Any, shape: tuple[int, ...]) -> Floats:
    array = np.array(values, dtype=np.float64).reshape(shape)
    if not np.all(np.isfinite(array)):
        raise ValueError("a number that is none")
    return frozen(array)
