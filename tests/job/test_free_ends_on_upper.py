"""A strip with free ends on an upper: the opening is as long as the strip that was found."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from build123d import Edge, Solid, Spline, Wire

from wrinkle_cad import InputError, Job, Part, choose_inputs, read_cad, write_step
from wrinkle_cad.job.wrinkled_upper import WrinkledUpper, wrinkle_upper

RADIUS = 60.0


def on_sphere(longitude_deg: float, latitude_deg: float) -> tuple[float, float, float]:
    turn, rise = math.radians(longitude_deg), math.radians(latitude_deg)
    across = RADIUS * math.cos(rise)
    return across * math.cos(turn), across * math.sin(turn), RADIUS * math.sin(rise)


def along(latitude_deg: float) -> Edge:
    return Spline(*[on_sphere(60 + 10 * k, latitude_deg) for k in range(12)])


@pytest.fixture(scope="module")
def ball(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two rails around a ball, of which Q turns off towards the pole at its end."""
    tail = Spline(*[on_sphere(170 + k, 10 + 2 * k) for k in range(5)])
    rails = {"P": along(-10), "Q": Wire([along(10), tail])}
    path = tmp_path_factory.mktemp("ball") / "ball.step"
    upper = Solid.make_sphere(RADIUS, angle1=-90, angle2=90).faces()[0]
    shapes = {"upper": upper, **rails}
    write_step(path, [Part(shape.wrapped, name) for name, shape in shapes.items()])
    return path


def made(ball: Path, **options: object) -> WrinkledUpper:
    job = Job(input=ball, ends="free", give_up=14.0, **options)
    return wrinkle_upper(job, choose_inputs(read_cad(ball)))


@pytest.mark.slow
@pytest.mark.parametrize("options", [{"pinned": ((50.0, 50.0),)}, {"margin": 5.0}])
def test_an_opening_ends_where_the_strip_does(ball: Path, options: dict) -> None:
    wrinkled = made(ball, **options)
    (strip,) = wrinkled.strips
    assert strip.report.unused_p_mm == (0.0, 0.0)
    assert strip.report.unused_q_mm[0] == 0.0
    assert 9.0 < strip.report.unused_q_mm[1] < 10.0
    assert "rail-unused" in [finding.code for finding in strip.findings]
    report = wrinkled.stitched.report
    assert report.is_valid
    assert (report.free_edges_before, report.free_edges_after) == (0, 0)


def test_waves_that_leave_rail_are_refused_with_what_to_do(ball: Path) -> None:
    with pytest.raises(
        InputError, match=r"leaves 9\.\d+ mm at the end of Q, .* Leave its ends fixed, or shorten"
    ):
        made(ball, waves=3, height=1.0)
