"""Sixty random strips at four tolerances: one state, one PASS or FAIL, one set of figures."""

from __future__ import annotations

import warnings
from typing import Any, Final

import build123d as b3d
import numpy as np
import pytest

from tests.strip.rulings.rails import bumps, twisted
from wrinkle_cad import WrinkleStrip, WrinkleWarning, settings
from wrinkle_cad.report.judging import largest_crease
from wrinkle_cad.report.limits import Limits
from wrinkle_cad.report.verdict import judge

TOLERANCES: Final = (0.1, 0.05, 0.01, 0.002)
NEAR: Final = 0.1
"""Figures within this share of a threshold may fall on either side of it."""
LIMITS: Final = Limits(max_strain_percent=1.0, min_radius_mm=2.0, max_twist_deg=10.0)


def entries_of(seed: int, tolerances: tuple[float, ...] = TOLERANCES) -> list[dict[str, Any]]:
    """The entry of one strip at each tolerance; strips of even seeds hardly twist."""
    rails = [
        b3d.Spline(*[tuple(at) for at in rail.point_at(np.linspace(*rail.interval, 41)).tolist()])
        for rail in (bumps, twisted)[seed % 2](seed // 2)
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WrinkleWarning)
        return [
            WrinkleStrip(*rails, tolerance=tolerance).trial_report.as_json() | {"trials": []}
            for tolerance in tolerances
        ]


def is_near(entries: list[dict[str, Any]], key: str, limit: float) -> bool:
    """Whether a figure lies within a tenth of a threshold at any tolerance."""
    values = [entry[key] for entry in entries]
    return any(value is not None and abs(value - limit) <= NEAR * limit for value in values)


def faults_of(entries: list[dict[str, Any]]) -> list[str]:
    """Which of the state and the verdict is not the same at all tolerances."""
    found = []
    thresholds = [("max_strain_percent", settings.STRETCH_PERCENT)]
    if len({entry["state"] for entry in entries}) > 1 and not is_near(entries, *thresholds[0]):
        found.append(f"state {[entry['state'] for entry in entries]}")
    said = [judge([entry], LIMITS).passed for entry in entries]
    thresholds = [
        ("max_strain_percent", 1.0),
        ("inner_bend_radius_mm", 2.0),
        ("max_twist_deg", 10.0),
    ]
    if len(set(said)) > 1 and not any(is_near(entries, *each) for each in thresholds):
        found.append(f"passed {said}")
    return found


@pytest.mark.slow
def test_sixty_strips_have_one_state_and_one_verdict_at_four_tolerances() -> None:
    faults, spreads = [], []
    for seed in range(60):
        entries = entries_of(seed)
        faults += [f"{seed}: {fault}" for fault in faults_of(entries)]
        shares = [100.0 * entry["developable_share"] for entry in entries]
        strains = [entry["max_strain_percent"] for entry in entries]
        spreads.append(float(np.ptp(shares)))
        if np.ptp(strains) > max(0.02, 0.1 * max(strains)):
            faults.append(f"{seed}: strains {strains}")
        if max(map(largest_crease, entries)) >= settings.CREASE_DEG:
            faults.append(f"{seed}: a smooth strip is creased")
    assert not faults, "\n".join(faults)
    assert np.median(spreads) <= 1.0


@pytest.mark.parametrize("seed", [0, 5])
def test_a_strip_has_one_state_and_one_verdict_at_two_tolerances(seed: int) -> None:
    assert faults_of(entries_of(seed, (0.1, 0.01))) == []
