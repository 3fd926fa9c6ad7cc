"""What is said about a strip, with and without limits."""

from __future__ import annotations

from typing import Any

import pytest

from wrinkle_cad.report.limits import Limits
from wrinkle_cad.report.material import Material
from wrinkle_cad.report.verdict import invalid_percent, judge

CALF = Material(
    name="calf leather, 1.2 mm",
    thickness_mm=1.2,
    smallest_bend_radius_mm=2.0,
    largest_strain_percent=2.0,
    largest_twist_deg=4.0,
)


def entry(**changes: Any) -> dict[str, Any]:
    return {
        "name": "wrinkle",
        "state": "developable",
        "developable_share": 1.0,
        "max_strain_percent": 0.0,
        "stretched_mm": 0.0,
        "creases": [],
        "interior_bridges": 225,
        "invalid_bridges": 0,
        "inflection_bridges": 0,
        "invalid_length_p_mm": 0.0,
        "invalid_length_q_mm": 0.0,
        "max_fold_deg": 2.4,
        "max_twist_deg": 0.0,
        "inner_bend_radius_mm": 3.0,
        "bend_radius_along_grain_mm": 3.0,
        "bend_radius_across_grain_mm": 30.0,
        "bending": 6.0,
        "least_bending": 1.5,
        "seam_lengths_mm": {
            "p": {"space": 100.0, "pattern": 100.5},
            "q": {"space": 150.0, "pattern": 150.0},
        },
        "overlaps": False,
        "cut": {"longer_percent": 0.1, "larger_percent": 0.01, "differs": False},
        "gaps": [],
        "trials": [],
    } | changes


def stretched(**changes: Any) -> dict[str, Any]:
    given: dict[str, Any] = {
        "state": "stretched",
        "developable_share": 0.62,
        "max_strain_percent": 0.52,
        "stretched_mm": 41.0,
        "max_twist_deg": 11.7,
        "invalid_bridges": 80,
        "inflection_bridges": 4,
        "invalid_length_p_mm": 10.0,
        "invalid_length_q_mm": 15.0,
        "max_fold_deg": 31.25,
    }
    return entry(**(given | changes))


def creased(**changes: Any) -> dict[str, Any]:
    crease = {"angle_deg": 45.0, "p_mm": 40.0, "q_mm": 40.0, "cause": "corner"}
    given = {"state": "creased", "creases": [crease], "inner_bend_radius_mm": 0.0}
    return entry(**(given | changes))


@pytest.mark.parametrize(
    ("given", "headline"),
    [
        (
            entry(),
            "Developable: strain 0%. 100% of the rails developable, smallest bend radius"
            " 3.00 mm, largest twist 0°.",
        ),
        (
            stretched(),
            "Stretched: by at most 0.520%, over 41.0 mm. 62.0% of the rails developable, smallest"
            " bend radius 3.00 mm, largest twist 11.7°.",
        ),
        (
            creased(),
            "Creased: by 45.0° at 40.0 mm of P. 100% of the rails developable, smallest bend"
            " radius 0 mm, largest twist 0°.",
        ),
        (
            entry(state="folded", inner_bend_radius_mm=None),
            "Folded: the strip lies back on itself or passes through itself. 100% of the rails"
            " developable, flat, largest twist 0°.",
        ),
    ],
)
def test_each_state_is_said_with_all_figures(given: dict[str, Any], headline: str) -> None:
    verdict = judge([given], Limits())
    assert verdict.state == given["state"]
    assert verdict.headline == headline
    assert verdict.passed is None
    assert verdict.limits == ()


def test_of_several_creases_the_sharpest_is_named() -> None:
    creases = [{"angle_deg": angle, "p_mm": 10 * angle, "q_mm": 0.0} for angle in (6, 30, 9)]
    headline = judge([creased(creases=creases)], Limits()).headline
    assert headline.startswith("Creased: by 30.0° at 300 mm of P and at 2 more places.")


def test_the_worst_strip_decides_for_the_job() -> None:
    verdict = judge([entry(), stretched(), creased()], Limits())
    assert verdict.state == "creased"
    assert verdict.headline == (
        "1 of 3 strips creased, 1 of 3 strips stretched, 1 of 3 strips developable."
    )
    assert judge([entry(), entry()], Limits()).headline == "Developable: both strips."
    assert judge([entry()] * 3, Limits()).headline == "Developable: all 3 strips."


def test_bands_are_judged_apart_from_the_wrinkles() -> None:
    bands = [creased(role="band", name="a"), entry(role="band", name="b")]
    verdict = judge([entry(), *bands], Limits().of(CALF))
    assert verdict.state == "developable"
    assert verdict.passed is True
    assert verdict.reasons == ()
    assert verdict.bands == "Bands: 1 of 2 bands creased, 1 of 2 bands developable."
    crease, radius = verdict.strips[1].missed
    assert crease.startswith("a has a crease of 45.0°")
    assert radius == "a has a bend radius of 0 mm, and 2 is the least."
    assert [strip.passed for strip in verdict.strips] == [True, False, True]


def test_with_limits_the_verdict_is_pass_or_fail_in_words() -> None:
    kept = stretched(max_strain_percent=0.14, max_twist_deg=3.0)
    assert judge([kept], Limits().of(CALF)).headline == (
        "PASS for calf leather, 1.2 mm: gives 2%, needs 0.140%; bends to 2 mm, needs 3.00 mm."
    )
    failed = judge([creased()], Limits().of(CALF))
    assert failed.passed is False
    assert failed.headline == (
        "FAIL for calf leather, 1.2 mm: wrinkle has a crease of 45.0°, and none of 5° or more is"
        " allowed unless --max-crease says so. And 1 more."
    )


@pytest.mark.parametrize(
    ("limits", "found"),
    [
        (Limits(max_strain_percent=0.5), "a strain of 0.520%, and 0.5 is allowed"),
        (Limits(max_twist_deg=5.0), "a twist of 11.7°, and 5 is allowed"),
        (Limits(max_fold_deg=10.0), "a fold of 31.2°, and 10 is allowed"),
        (
            Limits(max_invalid_percent=0.0),
            "invalid bridges on 10.0% of its rails, and 0 is allowed",
        ),
        (Limits(min_radius_mm=3.5), "a bend radius of 3.00 mm, and 3.5 is the least"),
    ],
)
def test_each_limit_is_missed_on_its_own(limits: Limits, found: str) -> None:
    verdict = judge([stretched()], limits)
    (reason,) = verdict.reasons
    assert reason == f"wrinkle has {found}."
    assert verdict.passed is False


def test_a_crease_limit_is_held_against_the_sharpest_crease() -> None:
    assert judge([creased()], Limits(max_crease_deg=44.9)).passed is False
    assert judge([creased()], Limits(max_crease_deg=45.0)).passed is True
    assert judge([entry()], Limits(max_crease_deg=0.0)).passed is True


@pytest.mark.parametrize(
    "limits",
    [
        Limits(max_strain_percent=0.52),
        Limits(max_fold_deg=31.25),
        Limits(max_twist_deg=11.7),
        Limits(max_invalid_percent=10.0),
        Limits(min_radius_mm=3.0),
    ],
)
def test_a_limit_that_is_just_reached_is_kept(limits: Limits) -> None:
    verdict = judge([stretched()], limits)
    assert verdict.passed is True
    assert verdict.reasons == ()
    assert verdict.limits[1:] == ("no crease of 5° or more",)


def test_a_crease_passes_only_where_it_is_asked_for() -> None:
    """Whoever asks for a strain gets no sharp fold unseen."""
    for limits in (Limits(max_strain_percent=2.0), Limits(max_fold_deg=170.0)):
        verdict = judge([creased()], limits)
        assert verdict.passed is False
        assert "a crease of 45.0°" in verdict.headline
    slight = [{"angle_deg": 4.9, "p_mm": 40.0, "q_mm": 40.0, "cause": "corner"}]
    assert judge([entry(creases=slight)], Limits(max_strain_percent=2.0)).passed is True
    allowed = judge([creased()], Limits(max_strain_percent=2.0, max_crease_deg=90.0))
    assert allowed.passed is True
    assert "creased by 45.0°, and 90° is allowed" in allowed.headline


def test_a_folded_strip_passes_no_limits() -> None:
    folded = entry(state="folded")
    for limits in (Limits(max_crease_deg=180.0), Limits(max_strain_percent=100.0)):
        verdict = judge([folded], limits)
        assert verdict.passed is False
        assert "lies back on itself or passes through itself" in verdict.headline
    assert judge([folded], Limits()).passed is None


def test_a_strain_that_nobody_asked_about_is_said_with_the_pass() -> None:
    verdict = judge([stretched()], Limits(min_radius_mm=1.0))
    assert verdict.passed is True
    assert "needs 0.520%, which no limit asks about" in verdict.headline


TRIALS = [
    {"change": "--height 1.5", "max_strain_percent": 0.2, "max_twist_deg": 4.0},
    {"change": "--margin 6", "failed": "The opening leaves the upper."},
    {"change": "--tolerance 0.0125", "max_strain_percent": 0.51, "max_twist_deg": 11.0},
]


def test_a_missed_limit_names_what_was_tried_and_keeps_it() -> None:
    (reason,) = judge([stretched(trials=TRIALS)], Limits(max_strain_percent=0.3)).reasons
    assert reason.endswith("Tried, and enough: --height 1.5 gives 0.200%.")
    (reason,) = judge([stretched(trials=TRIALS)], Limits(max_strain_percent=0.1)).reasons
    assert reason.endswith(
        "Of what was tried nothing is enough; the nearest: --height 1.5 gives 0.200%."
    )


def test_of_radii_the_largest_trial_is_the_nearest() -> None:
    tried = [
        {"change": "--height 1.5", "inner_bend_radius_mm": 3.2},
        {"change": "--fade 0.45", "inner_bend_radius_mm": 3.9},
        {"change": "--margin 6", "inner_bend_radius_mm": None},
    ]
    (reason,) = judge([entry(trials=tried[:2])], Limits(min_radius_mm=5.0)).reasons
    assert "the nearest: --fade 0.45 gives 3.90 mm" in reason
    (reason,) = judge([entry(trials=tried)], Limits(min_radius_mm=5.0)).reasons
    assert "Tried, and enough: --margin 6 gives no bend." in reason


def test_a_flat_strip_keeps_every_bend_radius() -> None:
    assert judge([entry(inner_bend_radius_mm=None)], Limits(min_radius_mm=1e6)).passed is True


def test_bends_are_held_against_the_limit_of_their_direction_in_the_grain() -> None:
    board = Material(
        name="board",
        smallest_bend_radius_mm=5.0,
        smallest_bend_radius_across_grain_mm=2.0,
    )
    limits = Limits().of(board)
    along = entry(bend_radius_along_grain_mm=3.0, bend_radius_across_grain_mm=30.0)
    across = entry(bend_radius_along_grain_mm=30.0, bend_radius_across_grain_mm=3.0)
    assert judge([along], limits).passed is False
    assert judge([across], limits).passed is True


def test_the_missed_limits_of_all_strips_are_listed() -> None:
    verdict = judge([stretched(name="a"), entry(), stretched(name="b")], Limits(max_fold_deg=5))
    assert [line.split(" has ")[0] for line in verdict.reasons] == ["a", "b"]
    assert verdict.headline.endswith(" And 1 more.")


def test_derived_figures_follow_from_the_entry() -> None:
    (strip,) = judge([stretched()], Limits()).strips
    assert strip.price_of_developability == 4.0
    assert strip.invalid_percent == 10.0
    assert strip.seam_difference_p_mm == 0.5
    assert strip.seam_difference_q_mm == 0.0


def test_inflections_do_not_count_as_invalid_rail() -> None:
    assert invalid_percent(entry(invalid_bridges=9, inflection_bridges=9)) == 0.0


def test_an_overlapping_pattern_is_mentioned() -> None:
    assert "cover itself" in judge([entry(overlaps=True)], Limits()).meaning
    assert "cover itself" not in judge([entry()], Limits()).meaning


def test_the_verdict_is_plain_in_the_json() -> None:
    said = judge([stretched()], Limits(max_fold_deg=1.0)).as_json()
    assert said["passed"] is False
    assert said["strips"][0]["name"] == "wrinkle"


def test_a_piece_that_is_another_surface_is_said_with_every_verdict() -> None:
    cut = {"longer_percent": 14.0, "larger_percent": -2.75, "differs": True}
    words = "up to 14.0% longer along the rulings, 2.75% smaller in area"
    alone = judge([entry(cut=cut)], Limits())
    assert alone.headline.endswith(f"But the piece that is cut is another surface: {words}.")
    assert words in alone.meaning
    passed = judge([entry(cut=cut), entry(name="other")], Limits(max_strain_percent=1.0))
    assert passed.passed is True
    assert passed.headline.endswith("But the piece that is cut is another surface.")
    assert passed.piece_differs
    band = judge([entry(), entry(name="band", role="band", cut=cut)], Limits())
    assert "another surface" not in band.headline + band.meaning
