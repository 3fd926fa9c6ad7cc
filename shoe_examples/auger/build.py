"""One turn of a conveyor's auger flight: a helix on a shaft of 20 mm and one of 60 mm, pitch 40 mm.

The inner helix starts where the tangents of the helix of regression through it end: the surface of
tangents is developable, and its piece is a sector of a ring.

From the project's folder: python -m shoe_examples.auger.build
Then, in this one: wrinkle-cad run auger.step --job job.toml -o out
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from wrinkle_cad import Part, smooth_edge, write_step

HERE = Path(__file__).parent
REGRESSION = 8.0
"""mm; radius of the helix that all rulings touch."""
PITCH = 40.0
RADII = (10.0, 30.0)
POINTS = 241


def rail(radius: float) -> np.ndarray:
    """(k, 3) mm: where the tangents of the helix of regression meet a cylinder."""
    rise = PITCH / (2.0 * math.pi)
    reach = math.sqrt(radius**2 - REGRESSION**2) / REGRESSION
    turn = np.linspace(0.0, 2.0 * math.pi, POINTS)
    x = REGRESSION * (np.cos(turn) - reach * np.sin(turn))
    y = REGRESSION * (np.sin(turn) + reach * np.cos(turn))
    return np.stack((x, y, rise * (turn + reach)), axis=1)


def parts() -> list[Part]:
    """Both rails."""
    inner, outer = (smooth_edge(rail(radius)) for radius in RADII)
    return [Part(inner, "P"), Part(outer, "Q")]


if __name__ == "__main__":
    write_step(HERE / "auger.step", parts())
