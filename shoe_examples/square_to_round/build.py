"""A duct from a square of 200 mm to a circle of 100 mm, 150 mm above it: 4 planes and 4 cones.

From the project's folder: python -m shoe_examples.square_to_round.build [--result]
Then, in this one: wrinkle-cad run square_to_round.step --job job.toml -o out
"""

from __future__ import annotations

import sys
from pathlib import Path

from build123d import Edge, Pos, Rectangle

from wrinkle_cad import Part, PieceSettings, WrinkleStrip, write_step

HERE = Path(__file__).parent
ZINC = (0.62, 0.66, 0.70)


def rails() -> tuple[object, object]:
    """The square and the circle, as one draws them: nothing tells where the seam is to be."""
    return Rectangle(200, 200).wire(), Pos(0, 0, 150) * Edge.make_circle(50)


def parts() -> list[Part]:
    """Both rails."""
    square, circle = rails()
    return [Part(square.wrapped, "P"), Part(circle.wrapped, "Q")]


def write_result() -> None:
    """Writes the duct and its pattern."""
    duct = WrinkleStrip(*rails(), name="duct", color=ZINC, tolerance=0.02)
    duct.export_step(HERE / "duct.step")
    pattern = duct.pattern(PieceSettings(tolerance=0.02, seam_allowance=(8.0, 8.0, 8.0, 8.0)))
    pattern.export_dxf(HERE / "duct.dxf")


if __name__ == "__main__":
    write_step(HERE / "square_to_round.step", parts())
    if "--result" in sys.argv:
        write_result()
