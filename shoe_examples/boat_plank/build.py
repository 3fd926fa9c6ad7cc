"""A plank of a skiff: from the chine to the sheer, 3.6 m long, bent and twisted towards the stem.

From the project's folder: python -m shoe_examples.boat_plank.build
Then, in this one: wrinkle-cad run boat_plank.step --job job.toml -o out
"""

from __future__ import annotations

from pathlib import Path

from build123d import Edge, Spline

from wrinkle_cad import Part, write_step

HERE = Path(__file__).parent
CHINE = [(0, 430, 60), (900, 520, 20), (1800, 540, 10), (2700, 400, 60), (3480, 60, 220)]
SHEER = [(-40, 560, 420), (900, 680, 370), (1800, 700, 360), (2700, 540, 420), (3600, 60, 560)]
"""mm; from the transom to the stem, the keel's line at y 0."""


def parts() -> list[Part]:
    """Both rails."""
    rails: list[Edge] = [Spline(*line) for line in (CHINE, SHEER)]
    return [Part(rail.wrapped, name) for rail, name in zip(rails, "PQ", strict=True)]


if __name__ == "__main__":
    write_step(HERE / "boat_plank.step", parts())
