"""Parts of rails: what a strip has of them that begins behind their start or ends before it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import curve_arrays, make_curve
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.strip.curve.sampling import Samples

from .directrix import Directrix, assembled


def part_of(piece: PoleCurve, first: float, last: float) -> PoleCurve:
    """Returns an edge between two of its parameters, which it keeps.

    Raises:
        CadError: the kernel cannot cut it.
    """
    if first <= piece.knots[0] + settings.KNOT_GAP and last >= piece.knots[-1] - settings.KNOT_GAP:
        return piece
    curve = make_curve(piece.poles, piece.knots, piece.multiplicities, piece.degree, piece.weights)
    with kernel_step("cut a rail in two"):
        curve.Segment(first, last, settings.KNOT_GAP)
    poles, weights, knots, multiplicities = curve_arrays(curve)
    return PoleCurve(piece.degree, knots, multiplicities, poles, weights)


def trimmed(rail: Directrix, samples: Samples, first: int, last: int) -> tuple[Directrix, Samples]:
    """Returns an open rail from one of its samples to another, and the samples between.

    Args:
        rail: the rail.
        samples: of the rail.
        first: number of the sample where it is to start.
        last: number of the sample where it is to end.

    Raises:
        CadError: the kernel cannot cut a curve.
    """
    if first == 0 and last == len(samples.points) - 1:
        return rail, samples
    start, end = float(samples.parameters[first]), float(samples.parameters[last])
    kept = [
        part_of(piece, max(start, float(piece.knots[0])), min(end, float(piece.knots[-1])))
        for piece in rail.pieces
        if piece.knots[-1] > start + settings.KNOT_GAP and piece.knots[0] < end - settings.KNOT_GAP
    ]
    part = replace(
        assembled(rail.name, rail.name or "rail", kept, is_polyline=rail.is_polyline),
        is_reversed=rail.is_reversed,
    )
    old = np.array([float(kept[0].knots[0]), *(float(piece.knots[-1]) for piece in kept)])
    new = np.array([0.0, *(float(piece.knots[-1]) for piece in part.pieces)])
    own = slice(first, last + 1)
    parameters = np.interp(samples.parameters[own], old, new)
    return part, Samples(parameters, samples.points[own].copy())
