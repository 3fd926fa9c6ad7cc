from __future__ import annotations

import build123d
import numpy as np
import pytest

from tests.cad.shoes import opening
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.cad.upper.profiles import profile_curves, wrinkle_profiles
from wrinkle_cad.errors import InputError


def heights(profile: Directrix, rail_index: int) -> np.ndarray:
    """How far the profile stands over its rail, (k,) mm, along the outward normal."""
    return offsets(profile, rail_index, opening().rails[rail_index].feet.normals)


def offsets(profile: Directrix, rail_index: int, direction: np.ndarray) -> np.ndarray:
    """How far the profile stands off its rail, (k,) mm, along (k, 3) unit vectors."""
    rail = opening().rails[rail_index]
    offset = profile_points(profile, rail) - rail.points
    offset[[1, -2]] = offset[[0, -1]]
    return np.asarray((offset * direction).sum(axis=1))


def profile_points(profile: Directrix, rail: object) -> np.ndarray:
    """The points that the profile was drawn through: its knots."""
    (piece,) = profile.pieces
    knots = np.unique(piece.knots)
    inner = profile.point_at(knots)
    assert len(inner) >= len(rail.points) - 2  # type: ignore[attr-defined]
    # A cubic through k points has no knot at the second and the last but one.
    second, last = rail.points[1], rail.points[-2]  # type: ignore[attr-defined]
    return np.vstack((inner[:1], [second], inner[1:-1], [last], inner[-1:]))


def test_a_profile_starts_and_ends_on_its_rail_and_is_one_smooth_curve() -> None:
    for i, profile in enumerate(
        profile_curves(opening(), waves=5, height=3.0, phase_deg=(17.0, 57.0))
    ):
        assert len(profile.curves) == 1
        assert profile.breaks == ()
        ends = profile.point_at(np.array(profile.interval))
        assert np.allclose(ends, opening().rails[i].points[[0, -1]], atol=1e-9)


def test_the_wave_has_the_given_height_and_number_of_crests() -> None:
    p, q = profile_curves(opening(), waves=(4, 6), height=(2.0, 3.0), fade=0.1)
    for profile, i, waves, height in ((p, 0, 4, 2.0), (q, 1, 6, 3.0)):
        found = heights(profile, i)
        assert found.max() == pytest.approx(height, rel=0.02)
        assert found.min() > -0.05
        inner = found[1:-1]
        crests = (inner > found[:-2]) & (inner >= found[2:]) & (inner > 0.2 * height)
        assert crests.sum() == waves


def test_sides_are_out_in_and_both() -> None:
    out, _ = profile_curves(opening(), waves=5, height=2.0, side="out")
    inside, _ = profile_curves(opening(), waves=5, height=2.0, side="in")
    both, _ = profile_curves(opening(), waves=5, height=2.0, side="both")
    assert heights(out, 0).min() > -0.05
    assert heights(out, 0).max() > 1.8
    assert heights(inside, 0).max() < 0.05
    assert heights(inside, 0).min() < -1.8
    assert heights(both, 0).min() < -1.7
    assert heights(both, 0).max() > 1.7


def test_a_callable_of_the_arc_length_is_followed_exactly() -> None:
    rail = opening().rails[0]
    seen: list[np.ndarray] = []

    def ramp(arc: np.ndarray) -> np.ndarray:
        seen.append(arc)
        return 0.01 * arc

    p, q = profile_curves(opening(), waves=1, height=(ramp, 1.0))
    assert np.allclose(seen[0], rail.shares * rail.length)
    end = p.point_at(np.array(p.interval))[-1]
    expected = rail.points[-1] + 0.01 * rail.length * rail.feet.normals[-1]
    assert np.allclose(end, expected, atol=1e-9)
    assert np.allclose(q.point_at(np.array(q.interval))[-1], opening().rails[1].points[-1])


def test_across_moves_the_wave_towards_the_other_rail() -> None:
    for i in (0, 1):
        profile = profile_curves(opening(), waves=5, height=2.0, across=1.5)[i]
        toward = opening().across[i]
        other = opening().rails[1 - i].points
        assert offsets(profile, i, toward).max() == pytest.approx(1.5, rel=0.02)
        assert offsets(profile, i, toward).min() > -0.05
        assert heights(profile, i).max() == pytest.approx(2.0, rel=0.02)
        middle = opening().rails[i].points[80]
        nearest = other[np.linalg.norm(other - middle, axis=1).argmin()]
        assert (nearest - middle) @ toward[80] > 0.0


def test_the_public_profiles_are_build123d_edges() -> None:
    p, q = wrinkle_profiles(opening(), waves=5, height=3.0)
    assert isinstance(p, build123d.Edge)
    assert isinstance(q, build123d.Edge)
    assert (p.label, q.label) == ("P", "Q")
    plain, _ = profile_curves(opening(), waves=5, height=3.0)
    assert p.length == pytest.approx(plain.length, rel=1e-9)
    shifted, _ = wrinkle_profiles(
        opening(), waves=5, height=3.0, phase_deg=(40.0, 0.0), fade=0.3, side="both", across=1.0
    )
    curve, _ = profile_curves(
        opening(), waves=5, height=3.0, phase_deg=40.0, fade=0.3, side="both", across=1.0
    )
    assert shifted.length == pytest.approx(curve.length, rel=1e-9)
    assert abs(shifted.length - p.length) > 0.1


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"waves": 0, "height": 1.0}, "waves is 0 on P"),
        ({"waves": 500, "height": 1.0}, "waves is 500"),
        ({"waves": 5, "height": np.nan}, "height is nan"),
        ({"waves": 5, "height": 1.0, "fade": 0.6}, "fade is 0.6"),
        ({"waves": 5, "height": 1.0, "side": "up"}, "side is 'up'"),
        ({"waves": 5, "height": 1.0, "phase_deg": np.inf}, "phase_deg is inf"),
        ({"waves": 5, "height": lambda arc: arc[:-1]}, "callable height returned shape"),
        ({"waves": 5, "height": lambda arc: arc * np.nan}, "values not finite"),
    ],
)
def test_what_is_out_of_range_is_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        profile_curves(opening(), **options)  # type: ignore[arg-type]
