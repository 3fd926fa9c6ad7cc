"""The pieces sew together: seams of the pattern against edges of the stitched STEP, re-read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Edge

from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.shapes import CadFile
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import (
    edges_of,
    faces_of,
    make_compound,
    vertex_point,
    vertices_of,
)
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix
from wrinkle_cad.job.job import Job, make_job
from wrinkle_cad.job.outcome import JobDone
from wrinkle_cad.job.parts import limits_of, piece_settings_of
from wrinkle_cad.job.workflow import run_job
from wrinkle_cad.job.wrinkled_upper import wrinkle_upper
from wrinkle_cad.pattern.piece.piece import PatternPiece

EXAMPLES = Path(__file__).parent.parent / "shoe_examples"
ON_UPPER = [
    "one_wrinkle",
    "three_wrinkles",
    *(pytest.param(name, marks=pytest.mark.slow) for name in ("across_seam", "feather_to_feather")),
]
RELATIVE = 1e-4

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Sewn:
    """An example's stitched STEP, read back, and the pieces of its pattern by name."""

    step: CadFile
    pieces: dict[str, PatternPiece]
    strips: tuple[str, ...]


def sewn(name: str, folder: Path) -> Sewn:
    from wrinkle_cad.cad.exchange.choose import choose_inputs
    from wrinkle_cad.wrinkle.cut_pattern import pattern_of_strips

    toml = EXAMPLES / name / "job.toml"
    options = {"output_dir": folder, "notches": 4, "seam_allowance": 5}
    job: Job = make_job(EXAMPLES / name / f"{name}.step", options, toml)
    done = run_job(job)
    assert isinstance(done, JobDone), done.message
    step = read_cad(next(path for path in done.outputs if path.suffix == ".step"))
    upper = wrinkle_upper(job, choose_inputs(read_cad(job.input), upper=job.upper))
    pattern = pattern_of_strips(
        [*upper.strips, *upper.bands], piece_settings_of(job, limits_of(job))
    )
    pieces = {piece.name: piece for piece in pattern.pieces}
    return Sewn(step, pieces, tuple(strip.name for strip in upper.strips))


@pytest.fixture(scope="module", params=ON_UPPER)
def example(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Sewn:
    return sewn(request.param, tmp_path_factory.mktemp(request.param))


def edges_of_part(step: CadFile, name: str | None) -> list[TopoDS_Edge]:
    """The edges of the faces with a name; of the body's, which have none, for None."""
    (shell,) = (shape for shape in step.shapes if shape.kind == "shell")
    styled = ShapeIndex(style.face for style in shell.faces)
    body = [face for face in faces_of(shell.shape) if styled.find(face) < 0]
    named = [style.face for style in shell.faces if style.name == name]
    return [edge for face in (body if name is None else named) for edge in edges_of(face)]


def seam_in_step(step: CadFile, one: str | None, other: str) -> Directrix:
    """The edges that two parts of the shell share, as one curve."""
    ones = ShapeIndex(edges_of_part(step, one))
    shared = [edge for edge in edges_of_part(step, other) if ones.find(edge) >= 0]
    assert shared, f"{one!r} and {other!r} share no edge"
    return make_directrix(make_compound(shared))


def notch_points(step: CadFile, label: str) -> Floats:
    """The named points of a row of notches, in their order."""
    found = {shape.name: vertices_of(shape.shape) for shape in step.shapes}
    names = sorted(name for name in found if name.startswith(f"{label} notch "))
    return np.array([vertex_point(found[name][0]) for name in names])


def arcs_of(rail: Directrix, points: Floats) -> Floats:
    """How far along a rail points lie, mm from its start, found by an own dense sampling."""
    at = np.linspace(*rail.interval, 200_001)
    line = rail.point_at(at)
    walked = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))))
    found = []
    for point in points:
        distance = np.linalg.norm(line - point, axis=1)
        nearest = int(distance.argmin())
        assert distance[nearest] < 2e-3, "a notch does not lie on its seam"
        found.append(walked[nearest])
    return np.array(found)


def spans(arcs: Floats, length: float) -> Floats:
    """The distances from the start over every notch to the end, read from the nearer end."""
    ordered = np.sort(arcs)
    steps = np.diff(np.concatenate(([0.0], ordered, [length])))
    return steps if steps[0] <= steps[-1] else steps[::-1]


def sides_of(example: Sewn) -> Iterator[tuple[str, str, PatternPiece, int]]:
    """Every seam with the body: (part in the STEP, label of its notches, its piece, its side)."""
    for strip in example.strips:
        for side, rail in enumerate("PQ"):
            band = f"{strip} band {rail}"
            yield band, f"{band} opening", example.pieces[band], side


def test_the_seams_are_as_long_as_the_openings_edges(example: Sewn) -> None:
    for part, _, piece, side in sides_of(example):
        seam = seam_in_step(example.step, None, part)
        assert sewn_length(piece, side) == pytest.approx(seam.length, rel=RELATIVE), part


def test_neighbouring_notches_are_as_far_apart_as_on_the_opening(example: Sewn) -> None:
    for part, label, piece, side in sides_of(example):
        seam = seam_in_step(example.step, None, part)
        points = notch_points(example.step, label)
        assert len(points) == 4
        in_space = spans(arcs_of(seam, points), seam.length)
        on_piece = spans(*notches_along(piece, side))
        assert on_piece == pytest.approx(in_space, rel=RELATIVE, abs=2e-3), part


def test_wrinkle_and_band_are_notched_alike(example: Sewn) -> None:
    for strip in example.strips:
        for side, rail in enumerate("PQ"):
            wrinkle = notches_along(example.pieces[strip], side)
            # The wrinkle's P is the band's Q and the other way round.
            band = notches_along(example.pieces[f"{strip} band {rail}"], 1 - side)
            assert wrinkle[1] == pytest.approx(band[1], rel=RELATIVE)
            assert len(wrinkle[0]) == 4
            assert wrinkle[0] == pytest.approx(band[0], rel=RELATIVE)


def test_a_seam_of_another_length_would_be_seen(example: Sewn) -> None:
    part, _, piece, side = next(sides_of(example))
    seam = seam_in_step(example.step, None, part)
    assert 1.001 * sewn_length(piece, side) != pytest.approx(seam.length, rel=RELATIVE)


def seam_line(piece: PatternPiece, side: int) -> Floats:
    """The sew line of one side of a piece, in order, from the piece's own outline."""
    outline = piece.sew
    mine = np.flatnonzero(outline.sides == side)
    gaps = np.flatnonzero(np.diff(mine) > 1)
    if len(gaps):
        mine = np.roll(mine, -(gaps[0] + 1))
    line = outline.points[np.append(mine, (mine[-1] + 1) % len(outline.points))]
    # The outline runs round the piece: along P, back along Q.
    return line if side == 0 else line[::-1]


def sewn_length(piece: PatternPiece, side: int) -> float:
    steps = np.diff(seam_line(piece, side), axis=0)
    return float(np.linalg.norm(steps, axis=1).sum())


def notches_along(piece: PatternPiece, side: int) -> tuple[Floats, float]:
    """Where the notches stand along the flat sew line, measured on it, and its length."""
    line = seam_line(piece, side)
    walked = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))))
    found = []
    for notch in piece.notches:
        if notch.side == side:
            chord = np.diff(line, axis=0)
            share = ((notch.seam - line[:-1]) * chord).sum(axis=1) / (chord**2).sum(axis=1)
            feet = line[:-1] + np.clip(share, 0, 1)[:, None] * chord
            nearest = int(np.linalg.norm(feet - notch.seam, axis=1).argmin())
            found.append(walked[nearest] + np.linalg.norm(feet[nearest] - line[nearest]))
    return np.sort(np.array(found)), float(walked[-1])
