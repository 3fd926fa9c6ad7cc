from __future__ import annotations

import math

import build123d as b3d
import numpy as np
import pytest

from wrinkle_cad.cad.build123d_objects import sketch_from_outline, to_build123d
from wrinkle_cad.cad.kernel.topology import make_compound, shells_of
from wrinkle_cad.errors import CadError, InputError

from .makers import box, line

SQUARE = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]


def test_a_shape_becomes_the_class_of_its_kind_with_label_and_color() -> None:
    (shell,) = shells_of(box())
    found = to_build123d(shell, label="Führung (1)", color=(1.0, 0.5, 0.0))
    assert isinstance(found, b3d.Shell)
    assert found.wrapped.IsSame(shell)
    assert found.label == "Führung (1)"
    assert tuple(found.color) == pytest.approx((1.0, 0.5, 0.0, 1.0))
    assert isinstance(to_build123d(line((0, 0, 0), (1, 0, 0))), b3d.Edge)
    assert isinstance(to_build123d(make_compound([shell])), b3d.Compound)


def test_a_color_may_be_a_name() -> None:
    assert tuple(to_build123d(box(), color="red").color) == pytest.approx((1.0, 0.0, 0.0, 1.0))
    with pytest.raises(InputError, match="'no color at all'"):
        to_build123d(box(), color="no color at all")


@pytest.mark.parametrize("corners", [SQUARE, SQUARE[::-1], [*SQUARE, SQUARE[0]]])
def test_an_outline_becomes_a_face_that_looks_up(corners: list[tuple[float, float]]) -> None:
    sketch = sketch_from_outline([np.array(corners)])
    assert isinstance(sketch, b3d.Sketch)
    (face,) = sketch.faces()
    assert tuple(face.normal_at()) == pytest.approx((0.0, 0.0, 1.0))
    assert sketch.area == pytest.approx(4.0)
    assert b3d.extrude(sketch, amount=3.0).volume == pytest.approx(12.0)


def test_each_outline_is_a_face_of_its_own() -> None:
    moved = np.add(SQUARE, (5.0, 0.0))
    assert len(sketch_from_outline([SQUARE, moved]).faces()) == 2


def test_long_outlines_are_no_trouble() -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 4_000, endpoint=False)
    outline = 100.0 * np.column_stack((np.cos(angle), np.sin(angle)))
    assert sketch_from_outline([outline]).area == pytest.approx(1e4 * math.pi, rel=1e-5)


@pytest.mark.parametrize(
    ("corners", "error", "message"),
    [
        ([(0, 0), (1, 1), (1, 0), (0, 1)], CadError, "crosses itself"),
        ([(0, 0), (1, 1)], InputError, "2 corners"),
        ([(0, 0), (0, 0), (1, 1), (1, 1)], InputError, "2 corners"),
        ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], InputError, "shape"),
        ([(0, 0), (1, 0), (math.nan, 1)], InputError, "finite"),
    ],
)
def test_what_is_no_polygon_is_refused(
    corners: list[tuple[float, ...]], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        sketch_from_outline([corners])
