"""Loose edges of a file with gaps between them are one rail where somebody asks for it."""

from __future__ import annotations

import random
from itertools import pairwise
from pathlib import Path

import pytest

from tests.cad.makers import line
from tests.seeds import seeds
from wrinkle_cad import Job, JobDone, Part, read_cad, run_job, write_step
from wrinkle_cad.cad.exchange.choose import Chosen, choose_inputs
from wrinkle_cad.cad.exchange.joined_curves import gap_hint, joined_curves
from wrinkle_cad.cad.exchange.shapes import NamedShape
from wrinkle_cad.errors import InputError
from wrinkle_cad.job.inspection import inspect_file

LEFT, RIGHT = line((0, 0, 0), (50, 0, 0)), line((50.2, 0, 0), (100, 0, 0))
OTHER = line((0, 30, 0), (100, 30, 0))


def written(path: Path, *names: str) -> Path:
    edges = (LEFT, OTHER, RIGHT)
    write_step(path, [Part(edge, name) for edge, name in zip(edges, names, strict=True)])
    return path


def chosen_in(path: Path, join: float, **choice: str) -> Chosen:
    return choose_inputs(read_cad(path), join=join, **choice)


@pytest.mark.parametrize("names", [("P", "Q", "P"), ("", "", ""), ("toe:P", "toe:Q", "toe:P")])
def test_edges_with_a_gap_are_one_rail_up_to_join(tmp_path: Path, names: tuple[str, ...]) -> None:
    path = written(tmp_path / "shoe.step", *names)
    (strip,) = chosen_in(path, 0.5).strips
    assert (strip.p.parts, strip.q.parts) == ((1, 3), ())
    assert strip.p.measure == pytest.approx(99.8)
    with pytest.raises(InputError, match=r"Gaps of 0\.2 mm are closed with --join 0\.4\."):
        chosen_in(path, 0.1)


def test_a_run_closes_the_gap_and_says_so(tmp_path: Path) -> None:
    path = written(tmp_path / "shoe.step", "P", "Q", "P")
    done = run_job(Job(input=path, output_dir=tmp_path / "out", join=0.5))
    assert isinstance(done, JobDone)
    assert done.summary["strips"][0]["area_3d_mm2"] == pytest.approx(3000.0)
    assert (
        "Rail P had a gap of 0.2 mm at (50.1, 0, 0) mm, which was closed in its middle as asked"
        " (join)."
    ) in [finding.message for finding in done.findings]


def test_inspect_shows_what_is_joined(tmp_path: Path) -> None:
    seen = inspect_file(written(tmp_path / "shoe.step", "P", "Q", "P"), join=0.5)
    assert [row.taken_as for row in seen.rows] == ["P", "Q", "P"]
    assert seen.reasons[0] == "P is [1] 'P' wire 99.8 mm (joined from [1] and [3]), by its name"


def test_a_rail_chosen_by_name_or_left_over_is_joined_likewise(tmp_path: Path) -> None:
    path = written(tmp_path / "shoe.step", "hem", "edge", "hem")
    for choice in ({"p": "hem"}, {"q": "edge"}, {"p": "hem", "q": "edge"}):
        (strip,) = chosen_in(path, 0.5, **choice).strips
        assert (strip.p.parts, strip.q.index) == ((1, 3), 2)
    with pytest.raises(InputError, match="means 2 shapes"):
        chosen_in(path, 0.1, p="hem")


def test_a_join_wider_than_the_strip_joins_no_rails(tmp_path: Path) -> None:
    write_step(tmp_path / "a.step", [Part(LEFT, ""), Part(line((0, 2, 0), (50, 2, 0)), "")])
    (strip,) = chosen_in(tmp_path / "a.step", 5.0).strips
    assert (strip.p.index, strip.q.index) == (1, 2)


@pytest.mark.parametrize("seed", seeds(50, 5))
def test_any_number_of_pieces_in_any_order_and_direction_are_one_rail(seed: int) -> None:
    chance = random.Random(seed)
    points = [(10.0 * i, chance.uniform(-3, 3), 0.0) for i in range(chance.randint(3, 9))]
    edges = []
    for (x, y, z), end in pairwise(points):
        ends = ((x + chance.uniform(0.01, 0.2), y, z), end)
        edges.append(line(*(ends if chance.random() < 0.5 else ends[::-1])))
    chance.shuffle(edges)
    curves = [NamedShape("P", i, "edge", edge, 10.0) for i, edge in enumerate(edges, 1)]
    (rail,) = joined_curves(curves, 0.25)
    assert rail.parts == tuple(range(1, len(edges) + 1)) if len(edges) > 1 else rail is curves[0]
    assert len(joined_curves(curves, 0.005)) == len(curves)
    assert len(joined_curves(curves, 0.0)) == len(curves)


def test_gaps_that_are_no_slip_are_not_offered_to_be_closed() -> None:
    far = [
        NamedShape("", i, "edge", line((0, 20 * i, 0), (50, 20 * i, 0)), 50.0) for i in range(1, 4)
    ]
    assert not gap_hint(far, 2)
