"""Strips that look different on a page, with the JSON that goes with them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.pattern.strips import make_pieces
from wrinkle_cad.files.json_values import finite
from wrinkle_cad.pattern.piece.options import NotchRule, PieceSettings
from wrinkle_cad.report.limits import Limits
from wrinkle_cad.report.verdict import judge
from wrinkle_cad.report.views import MeshView, StripView
from wrinkle_cad.strip.convexity import validity_matrix
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.flat.unrolling import unroll
from wrinkle_cad.strip.invalid_runs import find_invalid_runs
from wrinkle_cad.strip.rulings.surface import rule_strip
from wrinkle_cad.strip.rulings.through_points import rail_through
from wrinkle_cad.strip.triangulation import triangulate
from wrinkle_cad.wrinkle.cut_report import CutReport
from wrinkle_cad.wrinkle.gap_report import gap_reports
from wrinkle_cad.wrinkle.grain import Stock, inner_radii
from wrinkle_cad.wrinkle.strip_report import report_on

Rail = NDArray[np.float64]


def cylinder_rails(m: int = 60, n: int = 75) -> tuple[Rail, Rail]:
    """Two curves on a cylinder of radius 40 mm about y: developable, no inflection."""

    def on_cylinder(turn: Rail, y: Rail) -> Rail:
        return np.column_stack((40.0 * np.sin(turn), y, 40.0 * np.cos(turn)))

    s, t = np.linspace(-1.2, 1.2, m), np.linspace(-1.2, 1.2, n)
    return on_cylinder(s, 2.0 * np.sin(3.0 * s)), on_cylinder(t, 18.0 + 3.0 * np.cos(2.0 * t))


def wavy_rails(
    m: int = 110, n: int = 114, *, height: float = 4.0, waves: float = 4.0, offset: float = 0.0
) -> tuple[Rail, Rail]:
    """Two waves out of step over a bent strip of 120 mm: not developable."""

    def wave(count: int, phase: float, y: float, amplitude: float) -> Rail:
        x = np.linspace(0.0, 120.0, count)
        fade = np.sin(math.pi * x / 120.0)
        z = amplitude * fade * np.sin(2.0 * math.pi * waves * x / 120.0 + phase)
        return np.column_stack((x, y + 3.0 * fade + offset, 14.0 * fade + z))

    return wave(m, 0.0, 0.0, height), wave(n, 1.1, 16.0, 0.8 * height)


def planar_rails(m: int = 30, n: int = 34) -> tuple[Rail, Rail]:
    """Two curves in one plane: every bridge is valid."""
    s, t = np.linspace(0.0, 80.0, m), np.linspace(0.0, 80.0, n)
    return (
        np.column_stack((s, 3.0 * np.sin(s / 14.0), np.zeros(m))),
        np.column_stack((t, 20.0 + 2.0 * np.cos(t / 11.0), np.zeros(n))),
    )


def view_of(
    rails: tuple[Rail, Rail],
    name: str = "vamp wrinkle",
    *,
    role: Any = "strip",
    settings: PieceSettings | None = None,
) -> StripView:
    """Everything a page shows of the strip between two sampled rails."""
    strip = triangulate(*rails)
    flat = unroll(strip)
    settings = settings or PieceSettings(
        seam_allowance=(6.0, 6.0, 4.0, 4.0), notches_p=NotchRule(3), notches_q=NotchRule(3)
    )
    return StripView(
        name,
        strip,
        flat,
        make_pieces(flat, strip, name=name, settings=settings),
        validity_matrix(*rails, planarity=strip.planarity),
        triangulate(*rails, search="local", planarity=strip.planarity),
        triangulate(*rails, criteria=("bending",), planarity=strip.planarity),
        role,
    )


def entry_of(view: StripView) -> dict[str, Any]:
    """A view's entry in the ``strips`` of the JSON."""
    strip, flat = view.triangulation, view.unrolling
    assert view.least_bending is not None
    p, q = rail_through(strip.p), rail_through(strip.q)
    places = [arc_lengths(rail) for rail in (strip.p, strip.q)]
    i, j = strip.bridges.T
    ruled = rule_strip(p, q, (places[0][i], places[1][j]))
    report = report_on(
        view.name,
        strip,
        flat,
        ruled,
        role=view.role,
        area_mm2=strip.area,
        face_count=len(strip.triangles),
        lengths_mm=(float(places[0][-1]), float(places[1][-1])),
        least_bending=view.least_bending.bending,
        gaps=gap_reports((p, q), ruled, strip, is_closed=False, may_turn=view.role == "strip"),
        invalid_runs=find_invalid_runs(strip),
        inner_radii_mm=inner_radii(strip, flat, ruled, Stock()),
        cut=CutReport(0.02, 0.13, 40.0, 0.01, False),
    )
    return dict(finite({**report.as_json(), "passed": None, "trials": []}))


def summary_of(
    views: Sequence[StripView], limits: Limits | None = None, **changes: Any
) -> dict[str, Any]:
    """The JSON of a job with these strips."""
    entries = [entry_of(view) for view in views]
    return {
        "schema": "wrinkle_cad/job",
        "schema_version": 1,
        "input": {"file": "vamp.step", "format": "STEP", "unit": "mm"},
        "settings": {"tolerance": 0.05, "surface": "cones", "criteria": ["invalid", "bending"]},
        "versions": {"wrinkle-cad": "0.1.0", "numpy": "2.1.0"},
        "strips": entries,
        "verdict": judge(entries, limits or Limits()).as_json(),
        "findings": [
            {
                "code": "rails-turned-alike",
                "severity": "info",
                "message": "Q - it ran against P - both run alike now - nothing to do",
            }
        ],
        "seconds": {"read": 0.012, "search": 0.034},
        **changes,
    }


def dome(side: int = 120, size: float = 200.0) -> MeshView:
    """A body of 2 (side - 1)^2 triangles."""
    x, y = np.meshgrid(np.linspace(-40.0, 160.0, side), np.linspace(-60.0, 80.0, side))
    z = -6.0 + 14.0 * np.sin(math.pi * x / 120.0) - 0.002 * (y - 8.0) ** 2
    keep = np.arange(side * side).reshape(side, side)
    a, b, c, d = (
        part.ravel() for part in (keep[:-1, :-1], keep[:-1, 1:], keep[1:, 1:], keep[1:, :-1])
    )
    faces = np.vstack((np.column_stack((a, b, c)), np.column_stack((a, c, d))))
    points = np.column_stack((x.ravel(), y.ravel(), z.ravel()))
    return MeshView("upper", points.astype(np.float32), faces.astype(np.int32))
