"""How carving and stitching grow with the number of wrinkles, and of faces of the upper.

Processor time, so that what else the machine does counts for nothing; ratios within one run.
By hand: ``pytest -n 0 -m slow tests/benchmarks``.
"""

from __future__ import annotations

import resource
from time import process_time
from typing import Final

import numpy as np
import pytest
from build123d import Edge, Spline
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
from OCP.Geom import Geom_BSplineSurface
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.kernel.splines import make_surface
from wrinkle_cad.cad.upper.carve import carve_all
from wrinkle_cad.cad.upper.profiles import profile_curves
from wrinkle_cad.cad.upper.stitch import stitch
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

LARGEST_EXPONENT: Final = 1.1
LARGEST_RATIO: Final = 8.0
LARGEST_MEMORY_MB: Final = 800.0
WIDTH: Final = 250.0


def surface(length: float) -> Geom_BSplineSurface:
    """Gently bent both ways, 250 mm wide."""
    x, y = np.meshgrid(np.linspace(0, WIDTH, 9), np.linspace(0, length, 9), indexing="ij")
    z = 8.0 * np.cos(3.0 * x / WIDTH) + 6.0 * np.sin(4.0 * y / length)
    knots, counts = np.linspace(0, 1, 7), np.array([4, 1, 1, 1, 1, 1, 4])
    return make_surface(np.stack((x, y, z), 2), (knots, knots), (counts, counts), (3, 3))


def upper(across: int, along: int, length: float) -> TopoDS_Shape:
    """The surface in so many faces each way, sewn."""
    sewing = BRepBuilderAPI_Sewing(1e-4)
    for i in range(across):
        for j in range(along):
            part = surface(length)
            part.Segment(i / across, (i + 1) / across, j / along, (j + 1) / along)
            sewing.Add(BRepBuilderAPI_MakeFace(part, 1e-7).Face())
    sewing.Perform()
    return sewing.SewedShape()


def rails(y: float, length: float) -> tuple[Edge, Edge]:
    """12 mm apart, 120 mm long, across the surface."""
    held = surface(length)
    share = np.linspace(0.0, 1.0, 25)

    def rail(at: float) -> Edge:
        us, vs = (70.0 + 120.0 * share) / WIDTH, (at + 3.0 * np.sin(np.pi * share)) / length
        places = [held.Value(float(u), float(v)) for u, v in zip(us, vs, strict=True)]
        return Spline(*[place.Coord() for place in places])

    return rail(y), rail(y + 12.0)


def seconds(shape: TopoDS_Shape, pairs: list[tuple[Edge, Edge]]) -> float:
    """Processor time of carving and stitching; the wrinkles themselves are not counted."""
    start = process_time()
    openings = carve_all(shape, pairs, margin=2.0)
    taken = process_time() - start
    strips = [
        WrinkleStrip(*profile_curves(opening, waves=4, height=1.5), name=f"w{i}")
        for i, opening in enumerate(openings)
    ]
    start = process_time()
    assert stitch(openings, strips).report.is_valid
    return taken + process_time() - start


def warm() -> None:
    seconds(upper(1, 1, 400.0), [rails(200.0, 400.0)])


@pytest.mark.slow
def test_the_time_for_wrinkles_grows_with_their_number_and_no_faster() -> None:
    warm()
    shape, numbers = upper(1, 1, 800.0), (1, 3, 10, 30)
    taken = [
        seconds(shape, [rails(15.0 + 26.0 * i, 800.0) for i in range(count)]) for count in numbers
    ]
    exponent = np.polyfit(np.log(numbers), np.log(taken), 1)[0]
    assert exponent <= LARGEST_EXPONENT, taken


@pytest.mark.slow
def test_an_upper_of_a_thousand_faces_takes_eight_times_the_time_of_ten() -> None:
    warm()
    taken = [
        seconds(upper(across, along, 400.0), [rails(200.0, 400.0)])
        for across, along in ((1, 1), (2, 5), (10, 10), (25, 40))
    ]
    assert taken[3] <= LARGEST_RATIO * taken[1], taken
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0 <= LARGEST_MEMORY_MB
