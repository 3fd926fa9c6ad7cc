"""The upper's outside is the pattern's right side, however its rails are named or drawn."""

from __future__ import annotations

import math
from itertools import product
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from build123d import Edge, Face, GeomType, Solid, Spline
from numpy.typing import NDArray
from shapely import affinity

from wrinkle_cad.cad.exchange.choose import choose_inputs
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.shapes import Part
from wrinkle_cad.cad.exchange.write import write_step
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.parts import limits_of, piece_settings_of
from wrinkle_cad.job.wrinkled_upper import wrinkle_upper
from wrinkle_cad.wrinkle.cut_pattern import pattern_of_strips

RADIUS = 60.0
DRAWINGS = list(product((False, True), repeat=3))
"""Names swapped, P reversed, Q reversed."""

Floats = NDArray[np.float64]


def half_cylinder() -> Face:
    """Its normal points away from the axis."""
    (face,) = Solid.make_cylinder(RADIUS, 100.0, angle=180.0).faces().filter_by(GeomType.CYLINDER)
    return face


def on_cylinder(height: float, wave: float, turns: float, *, is_reversed: bool) -> Edge:
    turn = np.linspace(0.4, 2.3, 41)
    z = height + wave * np.sin(turns * turn) + 3.0 * turn
    points = np.column_stack((RADIUS * np.cos(turn), RADIUS * np.sin(turn), z))
    rows = points[::-1] if is_reversed else points
    return Spline(*map(tuple, rows.tolist()))


def step_of(folder: Path, *, is_swapped: bool, p_reversed: bool, q_reversed: bool) -> Path:
    names = ("Q", "P") if is_swapped else ("P", "Q")
    path = folder / "tube.step"
    parts = [
        Part(half_cylinder().wrapped, "upper"),
        Part(on_cylinder(20.0, 4.0, 3.0, is_reversed=p_reversed).wrapped, names[0]),
        Part(on_cylinder(50.0, 2.0, 5.0, is_reversed=q_reversed).wrapped, names[1]),
    ]
    write_step(path, parts)
    return path


def cut_lines(dxf: Path) -> list[Floats]:
    return [
        np.array([point[:2] for point in entity.get_points("xy")])
        for entity in ezdxf.readfile(dxf).modelspace().query("LWPOLYLINE[layer=='CUT']")
    ]


def on_the_roll(points: Floats) -> Floats:
    """A cylinder's outside rolled out: x to the left as one looks at it from outside, y up."""
    turn = np.arctan2(points[:, 1], points[:, 0])
    return np.column_stack((RADIUS * turn, points[:, 2]))


def best_motion_misses(points: Floats, target: Floats) -> tuple[float, float]:
    """The largest distance after the best rotation without, and with, a mirror image.

    Both are closed outlines whose first points and directions may differ.
    """
    misses = []
    for mirror in (1.0, -1.0):
        ring = np.column_stack((points[:, 0], mirror * points[:, 1]))[:: int(mirror)]
        best = math.inf
        for shift in range(len(ring)):
            best = min(best, _miss(np.roll(ring, -shift, axis=0), target, best))
        misses.append(best)
    return misses[0], misses[1]


def _miss(points: Floats, target: Floats, bound: float) -> float:
    one, other = points - points.mean(axis=0), target - target.mean(axis=0)
    a = (one * other).sum()
    b = (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum()
    turn = math.atan2(b, a)
    rotation = np.array(((math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))))
    return float(np.abs(one @ rotation - other).max())


@pytest.fixture(scope="module")
def outlines(tmp_path_factory: pytest.TempPathFactory) -> list[list[Floats]]:
    made = []
    for number, (is_swapped, p_reversed, q_reversed) in enumerate(DRAWINGS):
        folder = tmp_path_factory.mktemp(f"drawing{number}")
        path = step_of(folder, is_swapped=is_swapped, p_reversed=p_reversed, q_reversed=q_reversed)
        job = Job(input=path, hand="left", tolerance=0.2)
        upper = wrinkle_upper(job, choose_inputs(read_cad(path)))
        pattern = pattern_of_strips(
            upper.strips, piece_settings_of(job, limits_of(job)), turned_over=upper.turned_over
        )
        pattern.export_dxf(folder / "tube.dxf")
        made.append(cut_lines(folder / "tube.dxf"))
    return made


def test_eight_drawings_of_the_same_rails_give_the_same_left_piece(
    outlines: list[list[Floats]],
) -> None:
    left, right = outlines[0]
    for other_left, other_right in outlines:
        assert len(other_left) == len(left)
        proper, mirrored = best_motion_misses(other_left, left)
        assert proper < 2e-6
        assert mirrored > 1.0
        assert best_motion_misses(other_right, right)[0] < 2e-6


def test_the_left_piece_is_the_outside_of_the_cylinder_rolled_out(
    outlines: list[list[Floats]],
) -> None:
    for left, right in outlines:
        for outline, is_outside in ((left, True), (right, False)):
            assert is_rolled_out(outline) == is_outside


def is_rolled_out(outline: Floats) -> bool:
    """Whether an outline fits the rolled-out rails without being mirrored."""
    turn = np.linspace(0.4, 2.3, 200)
    lower = np.column_stack((RADIUS * turn, 20.0 + 4.0 * np.sin(3.0 * turn) + 3.0 * turn))
    upper = np.column_stack((RADIUS * turn, 50.0 + 2.0 * np.sin(5.0 * turn) + 3.0 * turn))
    region = np.vstack((lower, upper[::-1]))
    fits = []
    for mirror in (1.0, -1.0):
        fits.append(_overlap(outline * (1.0, mirror), region))
    assert max(fits) > 0.999
    return fits[0] > fits[1]


def _overlap(outline: Floats, region: Floats) -> float:
    """The share of a region that an outline covers at best, centroid on centroid."""
    one, other = (
        affinity.translate(shape, -shape.centroid.x, -shape.centroid.y)
        for shape in (shapely.Polygon(outline), shapely.Polygon(region))
    )

    def covered(degrees: float) -> float:
        turned = affinity.rotate(one, degrees, origin=(0.0, 0.0))
        return float(turned.intersection(other).area / other.area)

    coarse = max(np.arange(0.0, 360.0, 3.0), key=covered)
    return max(map(covered, np.arange(coarse - 3.0, coarse + 3.0, 0.05)))
