"""Builds vamp_strip.step: two directrices of one wrinkle across a shoe's vamp.

The vamp is an arch from feather edge to feather edge, 96 mm wide and 58 mm high. P and Q run over
it 14 mm apart and wave along its normal, as in a crease that forms where the toes bend; the waves
fade out at both ends. Run it with: python build.py
"""

from __future__ import annotations

import datetime
from pathlib import Path

import numpy as np
from build123d import Compound, Edge, Vector, export_step

HALF_WIDTH_MM = 48.0
HEIGHT_MM = 58.0
STRIP_WIDTH_MM = 14.0
WAVE_HEIGHT_MM = 2.5
WAVES = 4.0
POINTS = 81


def vamp_rail(position_mm: float, phase: float, waves: float, label: str) -> Edge:
    """One rail over the arch at a position along the foot, waving along the arch's normal."""
    share = np.linspace(0.0, 1.0, POINTS)
    angle = np.pi * share
    across = -HALF_WIDTH_MM * np.cos(angle)
    up = HEIGHT_MM * np.sin(angle) ** 0.9
    # The foot slopes towards the toe, so the front rail lies lower.
    up = up * (1.0 - 0.012 * position_mm)
    tangent = np.gradient(np.column_stack([across, up]), share, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    fade = np.sin(angle) ** 2
    wave = WAVE_HEIGHT_MM * fade * np.sin(2.0 * np.pi * waves * share + phase)
    x = across - wave * tangent[:, 1]
    z = up + wave * tangent[:, 0]
    y = position_mm + 2.0 * np.cos(angle)
    edge = Edge.make_spline([Vector(*point) for point in np.column_stack([x, y, z])])
    edge.label = label
    return edge


def main() -> None:
    p = vamp_rail(0.0, 0.0, WAVES, "P")
    q = vamp_rail(STRIP_WIDTH_MM, 0.5, WAVES, "Q")
    target = Path(__file__).with_name("vamp_strip.step")
    fixed = datetime.datetime(2026, 1, 1)
    export_step(Compound(children=[p, q]), target, timestamp=fixed)
    print(f"{target.name}: P {p.length:.2f} mm, Q {q.length:.2f} mm")


if __name__ == "__main__":
    main()
