"""Runs of invalid bridges as they stand in the JSON."""

from __future__ import annotations

import json
import math

import pytest

from tests.report.strips import view_of, wavy_rails
from wrinkle_cad.strip.invalid_runs import find_invalid_runs, run_entry


def test_a_run_has_its_units_in_its_names() -> None:
    runs = find_invalid_runs(view_of(wavy_rails()).triangulation)
    assert len(runs) > 0
    for run in runs:
        entry = json.loads(json.dumps(run_entry(run)))
        assert math.radians(entry["angle_defect_deg"]) == pytest.approx(run.angle_defect)
        assert math.radians(entry["twist_deg"]) == pytest.approx(run.twist)
        assert entry["p_length_mm"] == run.p_length
        assert entry["q_length_mm"] == run.q_length
        assert (entry["first_bridge"], entry["last_bridge"]) == (run.first, run.last)
