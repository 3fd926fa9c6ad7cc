"""The angle between the surfaces on both sides of a seam."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from wrinkle_cad.cad.kernel.measures import length_of
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.strip.portable import dot, norm

from .pieces import edge_frame, oriented_edges


@dataclass(frozen=True, slots=True)
class SeamAngle:
    """How sharply the surfaces turn along one seam; 0 where one runs smoothly into the other."""

    seam: str
    """Which two surfaces meet: ``body | wrinkle``, ``body | wrinkle band P``, ..."""
    length_mm: float
    """Length of the seam."""
    mean: float
    """rad; by length."""
    largest: float
    """rad."""


def seam_angles(faces: Sequence[TopoDS_Face], parts: Sequence[str]) -> tuple[SeamAngle, ...]:
    """Returns the angles along the seams between parts, at the middle of each edge.

    Args:
        faces: of one shell.
        parts: per face, the part that it belongs to.
    """
    index = ShapeIndex()
    uses: list[list[tuple[int, TopoDS_Edge]]] = []
    for i, face in enumerate(faces):
        for edge in oriented_edges(face):
            at = index.add(edge)
            if at == len(uses):
                uses.append([])
            uses[at].append((i, edge))
    found: dict[str, list[tuple[float, float]]] = {}
    for owners in uses:
        if len(owners) == 2 and parts[owners[0][0]] != parts[owners[1][0]]:
            normals = [edge_frame(edge, faces[i])[2] for i, edge in owners]
            first, second = normals
            turn = math.atan2(norm(np.cross(first, second)), float(dot(first, second)))
            seam = " | ".join(sorted(parts[i] for i, _ in owners))
            found.setdefault(seam, []).append((length_of(owners[0][1]), turn))
    return tuple(_summed(seam, found[seam]) for seam in sorted(found))


def _summed(seam: str, measured: Sequence[tuple[float, float]]) -> SeamAngle:
    lengths = [length for length, _ in measured]
    turns = [turn for _, turn in measured]
    return SeamAngle(seam, sum(lengths), float(np.average(turns, weights=lengths)), max(turns))
