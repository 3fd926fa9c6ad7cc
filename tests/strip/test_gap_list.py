"""Gaps as they stand in the JSON."""

from __future__ import annotations

import json
import math
from typing import get_args

import pytest

from tests.report.strips import view_of, wavy_rails
from wrinkle_cad.strip.gaps import ADVICE, Kind, gap_entry


def test_a_gap_has_its_units_in_its_names() -> None:
    view = view_of(wavy_rails())
    assert len(view.gaps) > 0
    for gap in view.gaps:
        entry = json.loads(json.dumps(gap_entry(gap)))
        assert math.radians(entry["angle_defect_deg"]) == pytest.approx(gap.angle_defect)
        assert math.radians(entry["twist_deg"]) == pytest.approx(gap.twist)
        assert entry["p_length_mm"] == gap.p_length
        assert entry["q_length_mm"] == gap.q_length
        assert (entry["first_bridge"], entry["last_bridge"]) == (gap.first, gap.last)
        assert entry["advice"] == ADVICE[gap.kind]


def test_every_kind_of_gap_has_its_advice() -> None:
    assert set(ADVICE) == set(get_args(Kind))
