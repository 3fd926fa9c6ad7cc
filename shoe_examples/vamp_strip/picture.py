"""Draws picture.png: the strip from two views, its pattern and its validity matrix.

Run it with: python picture.py
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from build123d import import_step

from wrinkle_cad import PieceSettings, WrinkleStrip

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from picture import draw  # noqa: E402 - the drawing tool of all examples lies one folder up


def main() -> None:
    shapes = {shape.label: shape for shape in import_step(HERE / "vamp_strip.step").children}
    strip = WrinkleStrip(shapes["P"], shapes["Q"], name="vamp")
    faces = [face.wrapped for face in strip.shell().faces()]
    space = HERE / "picture.png"
    draw([(faces, strip.color)], space, views=((28.0, -62.0), (30.0, 55.0)))

    figure = plt.figure(figsize=(14.0, 9.2), dpi=90)
    top = figure.add_axes((0.0, 0.45, 1.0, 0.55))
    top.imshow(plt.imread(space))
    top.set_axis_off()
    strip.plot_pattern(figure.add_axes((0.05, 0.06, 0.6, 0.36)), PieceSettings(rulings=True))
    strip.plot_validity(figure.add_axes((0.7, 0.06, 0.28, 0.36)))
    figure.savefig(space)
    print(f"{space.name}: {strip!r}")


if __name__ == "__main__":
    main()
