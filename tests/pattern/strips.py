"""Strips whose shape is known, unrolled by the package itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wrinkle_cad.pattern.formats.dxf import dxf_file
from wrinkle_cad.pattern.piece.making import draft_pieces, finished_pieces, strip_parts
from wrinkle_cad.pattern.piece.options import PieceSettings
from wrinkle_cad.strip import triangulate, unroll


def unrolled(p, q, criteria=("invalid", "bending")):
    """(unrolling, triangulation) of the strip between two sampled rails."""
    triangulation = triangulate(np.asarray(p, float), np.asarray(q, float), criteria=criteria)
    return unroll(triangulation), triangulation


def rectangle(length=120.0, width=40.0, count=2):
    x = np.linspace(0.0, length, count)
    zero = np.zeros(count)
    return unrolled(np.column_stack((x, zero, zero)), np.column_stack((x, zero + width, zero)))


def cylinder(radius=30.0, angle=2.0, width=25.0, count=60, *, inward=False):
    """A part of a cylinder; its right side is the outside of the cylinder, or the inside."""
    turn = np.linspace(0.0, angle, count)
    sign = -1.0 if inward else 1.0
    ring = np.column_stack((radius * np.sin(turn), 0.0 * turn, sign * radius * np.cos(turn)))
    return unrolled(ring, ring + np.array((0.0, width, 0.0)))


def random_strip(seed):
    """Wavy rails, tapering to points at times, at times strongly curved."""
    random = np.random.default_rng(seed)
    count = int(random.integers(8, 60))
    t = np.linspace(0.0, 1.0, count)
    length = random.uniform(20.0, 300.0)
    sweep = random.uniform(-2.2, 2.2) if seed % 3 else random.uniform(-0.3, 0.3)
    heading = sweep * (t - 0.5) + random.uniform(0, 0.6) * np.sin(
        2 * np.pi * random.uniform(1, 4) * t
    )
    step = length / (count - 1)
    spine = np.cumsum(np.column_stack((np.cos(heading), np.sin(heading))), axis=0) * step
    across = np.column_stack((-np.sin(heading), np.cos(heading)))
    width = (
        length * random.uniform(0.03, 0.15) * (1 + 0.5 * np.sin(6.3 * random.uniform(0.5, 3) * t))
    )
    taper = int(random.integers(4))
    if taper in (1, 3):
        width = width * np.sqrt(t)
    if taper in (2, 3):
        width = width * np.sqrt(1 - t)
    lift = random.uniform(0, 0.05) * length * np.sin(6.3 * random.uniform(0.5, 3) * t)
    p = np.column_stack((spine - 0.5 * width[:, None] * across, lift))
    q = np.column_stack((spine + 0.5 * width[:, None] * across, 0.7 * lift))
    return unrolled(p, q)


def ramp(turns=1.6, inner=20.0, outer=30.0, rise=6.0, count=160):
    """A spiral ramp: laid flat it runs over itself after one turn."""
    angle = np.linspace(0.0, 2.0 * np.pi * turns, count)
    ring = np.column_stack((np.cos(angle), np.sin(angle), 0.0 * angle))
    lift = np.column_stack((0.0 * angle, 0.0 * angle, rise * angle / (2.0 * np.pi)))
    return unrolled(outer * ring + lift, inner * ring + lift, ("length",))


def lens(length=150.0, width=30.0, count=41):
    """Rails that meet at both ends, lifted into a gentle arch."""
    t = np.linspace(0.0, 1.0, count)
    bulge = 0.5 * width * np.sin(np.pi * t)
    lift = 0.1 * length * np.sin(np.pi * t)
    return unrolled(
        np.column_stack((length * t, -bulge, lift)), np.column_stack((length * t, bulge, lift))
    )


def kinked(length=120.0, width=30.0):
    """A plane strip whose P rail has a sharp corner in its middle."""
    p = np.array(((0, 0, 0), (0.5 * length, -25, 0), (length, 0, 0)))
    x = np.linspace(0.0, length, 9)
    return unrolled(p, np.column_stack((x, 0 * x + width, 0 * x)))


def make_pieces(unrolling, triangulation, *, name, settings=None, turned_over=False):
    """The pieces of a strip that is sewn to no other."""
    chosen = settings or PieceSettings()
    parts = strip_parts(
        unrolling, triangulation, name=name, settings=chosen, turned_over=turned_over
    )
    return finished_pieces(draft_pieces(parts, chosen), chosen)


def one_piece(unrolling, triangulation, *, name, settings=None):
    """The piece of a strip that needs no second one."""
    (piece,) = make_pieces(
        unrolling,
        triangulation,
        name=name,
        settings=replace(settings or PieceSettings(), overlap="refuse"),
    )
    return piece


def dxf_bytes(pieces, **options):
    """Only the bytes of a DXF file."""
    return dxf_file(pieces, **options).content
