"""The files of a run, folded back: DXF and table of bends give the strip of the STEP file.

Eight drawings of the same two rails (names swapped, either rail reversed) on the outside of a
cylinder: the left piece is one and the same, and a rigid motion, no mirror image, puts it onto the
wrinkle in the STEP, with its right side out.
"""

from __future__ import annotations

import csv
from itertools import product
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from build123d import Compound, Vertex, import_step
from numpy.typing import NDArray

from tests.wrinkle.test_right_side_on_upper import RADIUS, best_motion_misses, on_cylinder, step_of
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone
from wrinkle_cad.job.workflow import run_job

Floats = NDArray[np.float64]
DRAWINGS = list(product((False, True), repeat=3))
SLOW = pytest.mark.slow


def run(folder: Path, tolerance: float = 0.05, **drawing: bool) -> Path:
    folder.mkdir(exist_ok=True)
    job = Job(
        input=step_of(folder, **drawing),
        output_dir=folder / "out",
        hand="left",
        tolerance=tolerance,
        bend_table=True,
    )
    outcome = run_job(job)
    assert isinstance(outcome, JobDone), outcome
    return job.output_dir


def bends_of(folder: Path, piece: str) -> tuple[Floats, Floats, Floats]:
    """Lines (b, 2, 2) from P to Q in the DXF, folds (b,) and arcs (b, 2) in the table."""
    with (folder / "tube.bends.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    space = ezdxf.readfile(folder / "tube.dxf").modelspace()
    lines = [line for line in space.query("LINE") if line.dxf.layer.startswith("BEND_")]
    assert len(lines) == len(rows)
    picked = [pair for pair in zip(rows, lines, strict=True) if pair[0]["piece"] == piece]
    signs = {"DOWN": 1.0, "UP": -1.0}
    for row, line in picked:
        assert line.dxf.layer == f"BEND_{row['direction']}"
    return (
        np.array([(tuple(line.dxf.start)[:2], tuple(line.dxf.end)[:2]) for _, line in picked]),
        np.array([signs[row["direction"]] * float(row["angle_deg"]) for row, _ in picked]),
        np.array([(float(row["along_p_mm"]), float(row["along_q_mm"])) for row, _ in picked]),
    )


def folded(lines: Floats, degrees: Floats) -> tuple[Floats, Floats]:
    """Ends of the bends in space, (b, 2, 3), and the normal of the right side before each."""
    middles = lines.mean(axis=1)
    turn, shift = np.eye(3), np.zeros(3)
    ends, normals = [], []
    for k, (line, fold) in enumerate(zip(lines, np.radians(degrees), strict=True)):
        p, q = np.append(line[0], 0.0), np.append(line[1], 0.0)
        ends.append((turn @ p + shift, turn @ q + shift))
        normals.append(turn[:, 2])
        along = (q - p) / np.linalg.norm(q - p)
        ahead = middles[min(k + 1, len(lines) - 1)] - middles[max(k - 1, 0)]
        forward = np.cross(along, (0.0, 0.0, 1.0))
        # Mountains bend what lies ahead away from the eye.
        angle = fold if forward[:2] @ ahead > 0.0 else -fold
        own = np.cos(angle) * np.eye(3) + np.sin(angle) * np.cross(np.eye(3), along)
        own += (1.0 - np.cos(angle)) * np.outer(along, along)
        shift = shift + turn @ (p - own @ p)
        turn = turn @ own
    return np.array(ends), np.array(normals)


def motion(points: Floats, target: Floats, *, mirrored: bool) -> tuple[Floats, Floats]:
    """The best rotation, or rotation and mirror image, and shift of points onto others."""
    middle, aim = points.mean(axis=0), target.mean(axis=0)
    left, _, right = np.linalg.svd((points - middle).T @ (target - aim))
    sign = np.sign(np.linalg.det(left @ right)) * (-1.0 if mirrored else 1.0)
    turn = (left @ np.diag((1.0, 1.0, sign)) @ right).T
    return turn, aim - turn @ middle


def onto_the_step(folder: Path, drawing: dict[str, bool], piece: str) -> tuple[float, float, bool]:
    """How far a folded piece lies off the STEP's edges at most, moved and mirrored; right side."""
    lines, degrees, arcs = bends_of(folder, piece)
    ends, normals = folded(lines, degrees)
    points = ends.reshape(-1, 3)
    edges = Compound(children=list(import_step(folder / "tube.step").edges()))
    misses, is_out = [], False
    for mirrored in (False, True):
        target = nearly(points, arcs, drawing, mirrored=mirrored)
        for _ in range(3):
            turn, shift = motion(points, target, mirrored=mirrored)
            moved = points @ turn.T + shift
            met = (edges.distance_to_with_closest_points(Vertex(*row))[1] for row in moved)
            target = np.array([tuple(point) for point in met])
        misses.append(float(np.linalg.norm(moved - target, axis=1).max()))
        if not mirrored:
            radial = moved.reshape(-1, 2, 3)[:, 0] * (1.0, 1.0, 0.0) / RADIUS
            is_out = bool(np.all(((normals @ turn.T) * radial).sum(axis=1) > 0.5))
    return misses[0], misses[1], is_out


def nearly(points: Floats, arcs: Floats, drawing: dict[str, bool], *, mirrored: bool) -> Floats:
    """Places on the rails as drawn that the arcs name, whichever way they are counted."""
    first = on_cylinder(20.0, 4.0, 3.0, is_reversed=drawing["p_reversed"])
    second = on_cylinder(50.0, 2.0, 5.0, is_reversed=drawing["q_reversed"])
    rails = (second, first) if drawing["is_swapped"] else (first, second)
    trials = []
    for backward in product((False, True), repeat=2):
        target = np.array(
            [
                tuple(rail.position_at(1.0 - arc / rail.length if back else arc / rail.length))
                for row in arcs
                for arc, rail, back in zip(row, rails, backward, strict=True)
            ]
        )
        turn, shift = motion(points, target, mirrored=mirrored)
        trials.append((float(np.abs(points @ turn.T + shift - target).max()), target))
    return min(trials, key=lambda trial: trial[0])[1]


@pytest.mark.parametrize(
    ("is_swapped", "p_reversed", "q_reversed"),
    [pytest.param(*drawing, marks=() if i == 6 else SLOW) for i, drawing in enumerate(DRAWINGS)],
)
def test_the_left_piece_folds_back_onto_the_step_by_a_motion_and_the_right_one_by_a_mirror(
    is_swapped: bool, p_reversed: bool, q_reversed: bool, tmp_path: Path
) -> None:
    drawing = {"is_swapped": is_swapped, "p_reversed": p_reversed, "q_reversed": q_reversed}
    folder = run(tmp_path, **drawing)
    moved, mirrored, is_out = onto_the_step(folder, drawing, "tube LEFT")
    # Bends stand for the cones between them: 0.014 mm at a chord tolerance of 0.05.
    assert moved < 0.02
    assert mirrored > 1.0
    assert is_out
    moved, mirrored, _ = onto_the_step(folder, drawing, "tube RIGHT")
    assert moved > 1.0
    assert mirrored < 0.02


@SLOW
def test_the_finer_the_samples_the_nearer_the_folded_piece_comes(tmp_path: Path) -> None:
    drawing = {"is_swapped": False, "p_reversed": False, "q_reversed": False}
    misses = [
        onto_the_step(run(tmp_path / f"{tolerance}", tolerance, **drawing), drawing, "tube LEFT")[0]
        for tolerance in (0.05, 0.01, 0.002)
    ]
    assert misses[1] < 0.3 * misses[0]
    assert misses[2] < 0.3 * misses[1]


@SLOW
def test_all_eight_left_pieces_are_one_and_the_same(tmp_path: Path) -> None:
    outlines = []
    for number, drawing in enumerate(DRAWINGS):
        named = dict(zip(("is_swapped", "p_reversed", "q_reversed"), drawing, strict=True))
        space = ezdxf.readfile(run(tmp_path / f"{number}", **named) / "tube.dxf").modelspace()
        outlines.append(
            [np.array(line.get_points("xy")) for line in space.query("*[layer=='CUT']")]
        )
    for pieces in outlines:
        for outline, first in zip(pieces, outlines[0], strict=True):
            proper, mirrored = best_motion_misses(outline, first)
            # The file's numbers end at 1e-6.
            assert proper < 2e-6
            assert mirrored > 1.0
