"""What the page draws: strips and meshes as compact records for its scripts.

Arrays travel as base64 of little-endian numbers, lengths and angles as 32-bit floats relative to
the middle of everything, so that a model far from the origin loses nothing.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.piece.piece import PatternPiece
from wrinkle_cad.strip.flat.unrolling import Unrolling
from wrinkle_cad.strip.triangulation import Triangulation

from .flat import bridge_ends
from .matrix import matrix_pictures

Role = Literal["strip", "band"]

_SHORT_INDEX: Final = 2**16


@dataclass(frozen=True, slots=True, eq=False)
class StripView:
    """One strip with everything that is shown of it."""

    name: str
    """As in the file; any text."""
    triangulation: Triangulation
    """The strip as it was built."""
    unrolling: Unrolling
    """The same in the plane."""
    pieces: tuple[PatternPiece, ...] = ()
    """What goes to the cutter."""
    valid: NDArray[np.bool_] | None = None
    """(m, n) bool; the validity matrix; None where it is too large to be drawn."""
    local: Triangulation | None = None
    """LODT+LMBT on the same samples, for comparison."""
    least_bending: Triangulation | None = None
    """GMBT on the same samples: what the strip would cost if developability did not count."""
    role: Role = "strip"
    """``strip``, or ``band`` for the sheets between a strip and the body."""
    surface: MeshView | None = None
    """The surface that is written, where it is drawn beside the triangulation's own triangles."""


@dataclass(frozen=True, slots=True, eq=False)
class MeshView:
    """A triangle mesh that is shown around the strips."""

    name: str
    """What the layer is called; any text."""
    vertices: NDArray[np.float32]
    """(k, 3) mm."""
    faces: NDArray[np.int32]
    """(l, 3) into the vertices."""
    color: tuple[float, float, float] | None = None
    """Red, green, blue in 0..1; the page's own grey when None."""


def scene_payload(strips: Sequence[StripView], body: MeshView | None) -> dict[str, Any]:
    """Packs all that the page's scripts draw.

    Raises:
        InputError: the body's faces point at vertices that do not exist.
    """
    center = _center(strips, body)
    return {
        "center": center.tolist(),
        "stretch_percent": settings.STRETCH_PERCENT,
        "crease_deg": settings.CREASE_DEG,
        "fold_back": 2.0 * math.atan(settings.STEEPEST_HALF_FOLD),
        "strips": [_strip_payload(view, center) for view in strips],
        "body": None if body is None else _mesh_payload(body, center),
    }


def _center(strips: Sequence[StripView], body: MeshView | None) -> NDArray[np.float64]:
    clouds = [np.vstack((view.triangulation.p, view.triangulation.q)) for view in strips]
    if body is not None and len(body.vertices):
        clouds.append(np.asarray(body.vertices, dtype=np.float64))
    if not clouds:
        return np.zeros(3)
    points = np.vstack(clouds)
    middle: NDArray[np.float64] = (points.min(axis=0) + points.max(axis=0)) / 2
    return middle


def _strip_payload(view: StripView, center: NDArray[np.float64]) -> dict[str, Any]:
    strip, flat = view.triangulation, view.unrolling
    matrix = None if view.valid is None else matrix_pictures(view.valid, strip.bridges)
    return {
        "name": view.name,
        "role": view.role,
        "p": _floats(strip.p - center),
        "q": _floats(strip.q - center),
        "inflection": _bytes(strip.inflection),
        "twist": _floats(strip.twist),
        "flat_p": _floats(flat.p),
        "flat_q": _floats(flat.q),
        "chosen": _path_payload(strip),
        "local": None if view.local is None else _path_payload(view.local),
        "least": None if view.least_bending is None else _path_payload(view.least_bending),
        "matrix": matrix,
        "surface": None if view.surface is None else _mesh_payload(view.surface, center),
        "pieces": [_piece_payload(piece, view) for piece in view.pieces],
    }


def _path_payload(strip: Triangulation) -> dict[str, str]:
    return {
        "steps": _bytes(strip.steps),
        "valid": _bytes(strip.valid),
        "fold": _floats(strip.fold),
        "bending": _floats(strip.bending_at),
    }


def _piece_payload(piece: PatternPiece, view: StripView) -> dict[str, Any]:
    first, ends = bridge_ends(piece, view.triangulation, view.unrolling)
    notches = [
        [*notch.position, *notch.direction, notch.depth if piece.has_allowance else 0.0]
        for notch in piece.notches
    ]
    return {
        "name": piece.name,
        "texts": list(piece.texts),
        "cut": _floats(piece.cut_line),
        "sew": _floats(piece.sew_line) if piece.has_allowance else None,
        "cut_outs": [_floats(outline) for outline in piece.cut_outs],
        "notches": _floats(notches),
        "grain": _floats(piece.grain_line),
        "stretch": None if piece.stretch_line is None else _floats(piece.stretch_line),
        "holes": _floats(piece.drill_holes),
        "first": first,
        "ends": _floats(ends),
    }


def _mesh_payload(body: MeshView, center: NDArray[np.float64]) -> dict[str, Any]:
    """Positions as 16-bit shares of the body's box: an upper of 300 mm loses 0.005 mm at most."""
    count = len(body.vertices)
    if len(body.faces) and not 0 <= int(body.faces.min()) <= int(body.faces.max()) < count:
        raise InputError(
            f"The faces of a body use vertices {int(body.faces.min())} to {int(body.faces.max())},"
            f" and it has {count}. Hand in faces that index the vertices from 0."
        )
    points = np.asarray(body.vertices, dtype=np.float64) - center
    low = points.min(axis=0) if count else np.zeros(3)
    span = points.max(axis=0) - low if count else np.zeros(3)
    share = np.rint((points - low) / np.where(span > 0, span, 1.0) * (_SHORT_INDEX - 1))
    kind = "<u2" if count <= _SHORT_INDEX else "<u4"
    return {
        "name": body.name,
        "color": None if body.color is None else [float(part) for part in body.color],
        "low": low.tolist(),
        "span": span.tolist(),
        "points": _base64(share.astype("<u2")),
        "faces": _base64(body.faces.astype(kind)),
        "wide": kind == "<u4",
    }


def _floats(values: ArrayLike) -> str:
    return _base64(np.asarray(values, dtype="<f4"))


def _bytes(values: ArrayLike) -> str:
    return _base64(np.asarray(values).astype(np.uint8))


def _base64(values: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")
