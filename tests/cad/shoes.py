"""Uppers, rails and seeded variations that the tests of carving and stitching start from."""

from __future__ import annotations

from functools import cache

import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.gp import gp_Trsf, gp_Vec
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from shoe_examples.rails import rail_points, vamp_rail
from shoe_examples.upper import sewn, upper_face, upper_panels
from wrinkle_cad.cad.kernel.topology import make_compound
from wrinkle_cad.cad.upper.carve import carve
from wrinkle_cad.cad.upper.opening import Opening
from wrinkle_cad.cad.upper.profiles import profile_curves
from wrinkle_cad.cad.upper.smooth import smooth_edge
from wrinkle_cad.cad.upper.stitch import Stitched, stitch
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip


@cache
def shoe() -> TopoDS_Face:
    return upper_face()


@cache
def rails(front: float = 205.0, back: float = 180.0) -> tuple[TopoDS_Edge, TopoDS_Edge]:
    return vamp_rail(shoe(), front, skew=3.0), vamp_rail(shoe(), back, skew=-3.0)


@cache
def opening(margin: float = 4.0) -> Opening:
    return carve(shoe(), *rails(), margin=margin)


@cache
def wrinkle() -> tuple[WrinkleStrip, Stitched]:
    """One wrinkle of five waves, 3 mm high, with P and Q out of step, stitched into the shoe."""
    strip = WrinkleStrip(
        *profile_curves(opening(), waves=5, height=3.0, phase_deg=(0.0, 57.3)), name="wrinkle"
    )
    return strip, stitch(opening(), strip)


@cache
def two_panels() -> TopoDS_Shape:
    """The upper in two faces that share a seam at the toe and one at the heel."""
    return sewn(upper_panels((0.0, 10.0, 20.0)))


def gaping_panels(gap: float) -> TopoDS_Shape:
    """The two panels, a gap in mm between them all along the toe and the heel."""
    first, second = upper_panels((0.0, 10.0, 20.0))
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(0.0, gap, 0.0))
    moved = BRepBuilderAPI_Transform(second, move, True).Shape()
    return make_compound([first, moved])


def lens_rail(sign: float) -> TopoDS_Edge:
    """A rail that bows forward or backward from two points that both signs share."""
    points = rail_points(shoe(), 192.0, bow=0.0, reach_deg=(-60.0, 60.0))
    angles = np.radians(np.linspace(-60.0, 60.0, len(points)))
    lifted = points + np.outer(sign * 12.0 * np.cos(1.5 * angles), [1.0, 0.0, 0.0])
    return smooth_edge(lifted)
