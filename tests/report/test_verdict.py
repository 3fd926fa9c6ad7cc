"""What is said about a strip, with and without limits."""

from __future__ import annotations

from typing import Any

import pytest

from wrinkle_cad.report.material import Limits
from wrinkle_cad.report.verdict import check_limits, invalid_percent, judge


def entry(**changes: Any) -> dict[str, Any]:
    return {
        "name": "wrinkle",
        "interior_bridges": 225,
        "invalid_bridges": 0,
        "inflection_bridges": 0,
        "invalid_length_p_mm": 0.0,
        "invalid_length_q_mm": 0.0,
        "max_fold_deg": 2.4,
        "max_twist_deg": 0.0,
        "smallest_bend_radius_mm": 3.0,
        "bending": 6.0,
        "least_bending": 1.5,
        "seam_lengths_mm": {
            "p": {"space": 100.0, "pattern": 100.5},
            "q": {"space": 150.0, "pattern": 150.0},
        },
        "overlaps": False,
        "gaps": [],
    } | changes


def bad_entry(**changes: Any) -> dict[str, Any]:
    given: dict[str, Any] = {
        "invalid_bridges": 80,
        "inflection_bridges": 4,
        "invalid_length_p_mm": 10.0,
        "invalid_length_q_mm": 15.0,
        "max_fold_deg": 31.25,
        "max_twist_deg": 12.0,
    }
    return entry(**(given | changes))


def test_a_developable_strip_is_called_so() -> None:
    verdict = judge([entry()], Limits())
    assert verdict.state == "developable"
    assert verdict.headline == (
        "Developable: all 225 bridges; largest fold 2.40°, largest twist 0°."
    )
    assert verdict.passed is None
    assert verdict.limits == ()


@pytest.mark.parametrize(
    ("runs", "words"), [(1, "1 inflection ruling ("), (2, "2 inflection rulings (")]
)
def test_inflection_rulings_are_counted_by_runs_of_bridges(runs: int, words: str) -> None:
    gaps = [{"kind": "inflection"}] * runs
    verdict = judge([entry(invalid_bridges=5, inflection_bridges=5, gaps=gaps)], Limits())
    assert verdict.state == "inflection"
    assert verdict.headline.startswith(f"Developable but for {words}5 of 225 bridges)")


def test_a_strip_that_is_not_developable_says_how_much() -> None:
    verdict = judge([bad_entry()], Limits())
    assert verdict.state == "not-developable"
    assert verdict.headline == (
        "Not developable: 76 of 225 bridges (and 4 at inflection rulings), covering 25.0 mm of"
        " rail; largest fold 31.2°, largest twist 12.0°."
    )


def test_the_worst_strip_decides_for_the_job() -> None:
    inflected = entry(invalid_bridges=1, inflection_bridges=1, gaps=[{"kind": "inflection"}])
    assert judge([entry(), inflected], Limits()).state == "inflection"
    verdict = judge([entry(), inflected, bad_entry()], Limits())
    assert verdict.state == "not-developable"
    assert verdict.headline == "Not developable: 1 of 3 strips."
    assert judge([entry(), inflected], Limits()).headline == (
        "Developable but for inflection rulings: both strips."
    )
    assert [strip.state for strip in verdict.strips] == [
        "developable",
        "inflection",
        "not-developable",
    ]


def test_derived_figures_follow_from_the_entry() -> None:
    (strip,) = judge([bad_entry()], Limits()).strips
    assert strip.price_of_developability == 4.0
    assert strip.invalid_percent == 10.0
    assert strip.seam_difference_p_mm == 0.5
    assert strip.seam_difference_q_mm == 0.0


def test_an_overlapping_pattern_is_mentioned() -> None:
    assert "cover itself" in judge([entry(overlaps=True)], Limits()).meaning
    assert "cover itself" not in judge([entry()], Limits()).meaning


@pytest.mark.parametrize(
    ("limits", "line"),
    [
        (Limits(max_fold_deg=10.0), "wrinkle - largest fold 31.2 degrees - at most 10 - "),
        (Limits(max_twist_deg=5.0), "wrinkle - largest twist 12.0 degrees - at most 5 - "),
        (
            Limits(max_invalid_percent=0.0),
            "wrinkle - rail covered by invalid bridges 10.0 per cent - at most 0 - ",
        ),
        (
            Limits(smallest_bend_radius_mm=3.5),
            "wrinkle - smallest bend radius 3.00 mm - at least 3.5 - ",
        ),
    ],
)
def test_each_limit_is_missed_on_its_own(limits: Limits, line: str) -> None:
    (missed,) = check_limits(bad_entry(), limits)
    assert missed.startswith(line)
    assert judge([bad_entry()], limits).passed is False


@pytest.mark.parametrize(
    "limits",
    [
        Limits(max_fold_deg=31.25),
        Limits(max_twist_deg=12.0),
        Limits(max_invalid_percent=10.0),
        Limits(smallest_bend_radius_mm=3.0),
    ],
)
def test_a_limit_that_is_just_reached_is_kept(limits: Limits) -> None:
    verdict = judge([bad_entry()], limits)
    assert verdict.passed is True
    assert verdict.missed == ()
    assert len(verdict.limits) == 1


def test_a_flat_strip_keeps_every_bend_radius() -> None:
    limits = Limits(smallest_bend_radius_mm=1e6)
    assert check_limits(entry(smallest_bend_radius_mm=None), limits) == ()


def test_the_missed_limits_of_all_strips_are_listed() -> None:
    verdict = judge([bad_entry(name="a"), entry(), bad_entry(name="b")], Limits(max_fold_deg=5))
    assert [line.split(" - ")[0] for line in verdict.missed] == ["a", "b"]


def test_inflections_do_not_count_as_invalid_rail() -> None:
    inflected = entry(invalid_bridges=9, inflection_bridges=9, gaps=[{"kind": "inflection"}])
    assert invalid_percent(inflected) == 0.0
    assert judge([inflected], Limits(max_invalid_percent=0.0)).passed is True


def test_the_verdict_is_plain_in_the_json() -> None:
    said = judge([bad_entry()], Limits(max_fold_deg=1.0)).as_json()
    assert said["passed"] is False
    assert said["strips"][0]["name"] == "wrinkle"


def test_strips_and_bands_are_counted_apart() -> None:
    inflected = entry(invalid_bridges=1, inflection_bridges=1, gaps=[{"kind": "inflection"}])
    bands = [bad_entry(role="band"), bad_entry(role="band"), entry(role="band")]
    strips = [entry(role="strip"), inflected | {"role": "strip"}]
    assert judge([*strips, *bands], Limits()).headline == (
        "Not developable: 2 of 3 bands. Both strips are developable but for inflection rulings."
    )
    assert judge([bad_entry(), entry(), bands[0]], Limits()).headline == (
        "Not developable: 1 of 2 strips and the band."
    )
    assert judge([entry(), bands[0], bands[1]], Limits()).headline == (
        "Not developable: both bands. The strip is developable."
    )
    assert judge([entry(), entry(role="band")], Limits()).headline == (
        "Developable: the strip and the band."
    )
