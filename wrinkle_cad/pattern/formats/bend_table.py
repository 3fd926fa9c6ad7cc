"""The bends of all pieces as a table of comma-separated values."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wrinkle_cad.files.atomic import write_export
from wrinkle_cad.pattern.piece.piece import PatternPiece

COLUMNS = (
    "piece", "bend", "direction", "angle_deg", "radius_mm", "along_p_mm", "along_q_mm",
)  # fmt: skip


def bend_table(pieces: Sequence[PatternPiece]) -> str:
    """Returns a row for each bend: which way, how far, how sharply, and where on both seams.

    Up is towards the eye as one looks at the right side (a valley), down away from it.
    """
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow(COLUMNS)
    for piece in pieces:
        if piece.bends is None:
            continue
        rows = zip(piece.bends.fold, piece.bends.radius, piece.bends.arcs, strict=True)
        for number, (fold, radius, (p_mm, q_mm)) in enumerate(rows, start=1):
            table.writerow(
                (
                    piece.name,
                    number,
                    "DOWN" if fold > 0.0 else "UP",
                    f"{abs(float(np.degrees(fold))):.6f}",
                    f"{radius:.3f}",
                    f"{p_mm:.3f}",
                    f"{q_mm:.3f}",
                )
            )
    return stream.getvalue()


def write_bend_table(path: Path, pieces: Sequence[PatternPiece]) -> None:
    """Writes the table, whole or not at all, in UTF-8.

    Raises:
        ExportError: the file cannot be written.
    """
    write_export(path, "CSV", bend_table(pieces).encode("utf-8"))
