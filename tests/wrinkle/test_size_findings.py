"""A strip of a few tolerances says so, and which unit its numbers may be in."""

from __future__ import annotations

import numpy as np
import pytest

from wrinkle_cad import WrinkleStrip
from wrinkle_cad.errors import Finding

X = np.linspace(0.0, 1.0, 33)


def plank(length: float, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Two chines that bow outwards by a twentieth of their length."""
    bow = 0.05 * length * np.sin(np.pi * X)
    p = np.stack((length * X, bow, 0.02 * length * X), axis=1)
    return p, p + np.array([0.0, width, 0.1 * width])


def found(length: float, width: float, tolerance: float = 0.05) -> list[Finding]:
    strip = WrinkleStrip(*plank(length, width), tolerance=tolerance, name="plank")
    return [finding for finding in strip.findings if finding.code == "size-near-tolerance"]


@pytest.mark.parametrize(
    ("length", "width", "unit"),
    [(4.0, 0.3, "m"), (11.0, 0.6, "m"), (6.0, 0.6, "m"), (18.0, 1.2, "m"), (60.0, 0.4, "ft")],
)
def test_a_plank_in_another_unit_is_found(length: float, width: float, unit: str) -> None:
    (finding,) = found(length, width)
    assert f"--unit {unit}" in finding.message
    assert finding.severity == "warning"


def test_the_message_names_sizes_and_unit() -> None:
    assert [finding.message for finding in found(4.0, 0.3)] == [
        "plank is 4.03 mm long and 0.3 mm wide; in m it would be 4025 x 300 mm. That is 81 and 6"
        " times its tolerance of 0.05 mm, too few to keep its shape. If its numbers are m, read the"
        " file with --unit m, export it in its true unit, or multiply by 1000 in the script; else"
        " give a finer tolerance."
    ]


@pytest.mark.parametrize(("length", "width"), [(80.0, 6.0), (31.0, 1.0), (4000.0, 300.0), (12, 9)])
def test_strips_that_keep_their_shape_are_not(length: float, width: float) -> None:
    assert found(length, width) == []


def test_a_finer_tolerance_keeps_a_small_strip() -> None:
    assert found(4.0, 0.3, tolerance=1e-3) == []
