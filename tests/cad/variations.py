"""Wrinkles at random on four kinds of uppers, as the tests of carving and stitching try them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, Literal

import numpy as np
from build123d import Cylinder, Edge, Sphere, Spline, Torus
from OCP.TopoDS import TopoDS_Shape

from shoe_examples.rails import vamp_rail
from shoe_examples.upper import sewn, upper_panels
from tests.cad.last import last_like_face, rail_on_face
from tests.cad.shoes import shoe
from wrinkle_cad.cad.kernel.topology import unwrap
from wrinkle_cad.cad.upper.carve import carve
from wrinkle_cad.cad.upper.opening import Opening
from wrinkle_cad.cad.upper.profiles import profile_curves
from wrinkle_cad.cad.upper.stitch import Stitched, stitch
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

KINDS: Final = ("lofted last", "uneven last with poles", "shoe of eight faces", "round solids")
RADIUS: Final = 50.0
"""mm; of the sphere."""


@dataclass(frozen=True)
class Variation:
    """A wrinkle at random: where it is, how it is turned, how wide, how wavy, how high."""

    upper: TopoDS_Shape
    rails: tuple[Any, Any]
    margin: float
    fade: float
    waves: float
    height: float
    phase_deg: tuple[float, float]
    side: Literal["out", "both", "in"]

    def made(self) -> tuple[Opening, WrinkleStrip, Stitched]:
        carved = carve(self.upper, *self.rails, margin=self.margin, fade=self.fade, limit=25.0)
        profiles = profile_curves(
            carved,
            waves=self.waves,
            height=self.height,
            phase_deg=self.phase_deg,
            fade=self.fade,
            side=self.side,
        )
        strip = WrinkleStrip(*profiles, name="wrinkle")
        return carved, strip, stitch(carved, strip)


def variation(seed: int) -> Variation:
    """Of the kind that comes next: four seeds in a row are one of each."""
    random = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    if kind == "lofted last":
        return _wavy(random, shoe(), *_across_the_vamp(random), 5.0)
    if kind == "shoe of eight faces":
        return _wavy(random, eight_faces(), *_across_the_vamp(random), 5.0)
    if kind == "uneven last with poles":
        face = last_like_face(seed)
        return _wavy(random, face, *_on_last(random, face), 2.0)
    upper, p, q = _on_round_solid(random, seed // len(KINDS) % 3)
    return _wavy(random, upper, p, q, 2.0)


@cache
def eight_faces() -> TopoDS_Shape:
    """The upper in eight faces around the last, sewn."""
    return sewn(upper_panels(np.linspace(0.0, 20.0, 9).tolist()))


def _wavy(
    random: np.random.Generator, upper: TopoDS_Shape, p: Any, q: Any, highest: float
) -> Variation:
    sides: tuple[Literal["out", "both", "in"], ...] = ("out", "both", "in")
    side = sides[random.integers(3)]
    height = random.uniform(0.5, min(highest, 2.0) if side == "in" else highest)
    return Variation(
        upper=upper,
        rails=(p, q),
        margin=height * random.uniform(0.9, 1.6),
        fade=random.uniform(0.1, 0.5),
        waves=random.uniform(2.0, 8.0),
        height=height,
        phase_deg=(random.uniform(0.0, 360.0), random.uniform(0.0, 360.0)),
        side=side,
    )


def _across_the_vamp(random: np.random.Generator) -> tuple[Any, Any]:
    width = random.uniform(8.0, 35.0)
    middle = min(random.uniform(165.0, 225.0), 232.0 - width / 2)
    # Turned further against each other, narrow strips would cross.
    skews = random.uniform(-1.0, 1.0, 2) * min(10.0, 0.35 * width)
    reach = (-random.uniform(30.0, 68.0), random.uniform(30.0, 68.0))
    apart = random.uniform(-4.0, 4.0, 2)
    return (
        vamp_rail(shoe(), middle + width / 2, skew=skews[0], reach_deg=reach),
        vamp_rail(
            shoe(),
            middle - width / 2,
            skew=skews[1],
            reach_deg=(reach[0] + apart[0], reach[1] + apart[1]),
        ),
    )


def _on_last(random: np.random.Generator, face: Any) -> tuple[Edge, Edge]:
    """Around the last or along it, over its seam and near its poles too."""
    if random.integers(2):
        u, du, v = random.uniform(-0.3, 0.9), random.uniform(0.1, 0.4), random.uniform(0.05, 0.85)
        dv = random.uniform(0.03, 0.08)
        return rail_on_face(face, (u, v), (u + du, v)), rail_on_face(
            face, (u, v + dv), (u + du, v + dv)
        )
    u, du = random.uniform(0.0, 1.0), random.uniform(0.05, 0.15)
    v, dv = random.uniform(0.02, 0.5), random.uniform(0.2, 0.47)
    return rail_on_face(face, (u, v), (u, v + dv)), rail_on_face(
        face, (u + du, v), (u + du, v + dv)
    )


def _on_round_solid(random: np.random.Generator, which: int) -> tuple[TopoDS_Shape, Edge, Edge]:
    start, tilt = random.uniform(-0.8, -0.2), random.uniform(-15.0, 15.0)
    width, low = random.uniform(8.0, 20.0), random.uniform(-20.0, 5.0)
    turn = random.uniform(0.0, 2.0 * math.pi, 2)

    def at(along: float, across: float) -> tuple[float, float, float]:
        angle, height = start + 1.2 * along, low + across + tilt * along
        if which == 0:
            return 40.0 * math.cos(angle), 40.0 * math.sin(angle), height
        if which == 1:
            out = 80.0 + 30.0 * math.cos(height / 30.0)
            return out * math.cos(angle), out * math.sin(angle), 30.0 * math.sin(height / 30.0)
        # Over the sphere's pole or past it, then turned anywhere, the seam and the poles crossed.
        x, y = low + across, RADIUS * math.sin(angle + 0.1)
        z = math.sqrt(max(RADIUS**2 - x * x - y * y, 0.0))
        x, z = _turned(x, z, turn[0] if turn[1] > math.pi else 0.0)
        x, y = _turned(x, y, turn[1])
        return x, y, z

    p, q = (Spline(*[at(t, side) for t in np.linspace(0.0, 1.0, 9)]) for side in (0.0, width))
    solid = (Cylinder(40.0, 200.0), Torus(80.0, 30.0), Sphere(RADIUS))[which]
    return unwrap(solid), p, q


def _turned(x: float, y: float, by: float) -> tuple[float, float]:
    return x * math.cos(by) - y * math.sin(by), x * math.sin(by) + y * math.cos(by)
