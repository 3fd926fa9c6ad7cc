"""Builds strips of the kind of the examples I to IV of Wang and Tang's paper.

The paper's curves are not published. These have as many bridges (225 in example II, 126 in III and
IV) and show the same: an easy strip on which looking one step ahead is enough (I), a lace on which
it is not (II), and a strip on which least area ruins developability (III) and a local search for
least bending costs several times the global one (IV). They were picked among random curves of two
families for coming close to the paper's figures. The tolerance in example_N.toml is the one at
which sampling gives that many bridges. Run it with: python build.py; then, for the table, table.py.
"""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from build123d import Compound, Edge, Vector, export_step
from numpy.typing import NDArray

Points = NDArray[np.float64]

HERE = Path(__file__).parent
SHARE = np.linspace(0.0, 1.0, 161)
TURN = 2.0 * np.pi


def easy_rail(y: float, height: float, waves: float, phase: float) -> Points:
    """A gentle wave over an arch of 80 mm."""
    arch = np.sin(np.pi * SHARE)
    wave = height * np.sin(TURN * waves * SHARE + phase)
    return np.column_stack((80.0 * SHARE, y + 4.0 * arch, 12.0 * arch + wave))


def lace_rails() -> tuple[Points, Points]:
    """A lace around a neckline: its inner edge lies nearly flat, its outer one is ruffled."""
    radius, width, height, waves = 89.5, 36.6, 6.0, 4.34
    angle = 2.12 * (SHARE - 0.5)
    outward = np.column_stack((np.sin(angle), -np.cos(angle), np.zeros_like(angle)))
    center = np.array([0.0, radius, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    inner_wave = 1.15 * np.sin(TURN * waves * SHARE + 0.565)
    swelling = 1.0 + 0.25 * np.sin(TURN * 0.66 * SHARE)
    outer_wave = height * swelling * np.sin(TURN * waves * SHARE)
    sway = 1.77 * np.cos(TURN * waves * SHARE + 0.68)
    inner = center + radius * outward + np.outer(inner_wave, up)
    outer = center + (radius + width + sway)[:, None] * outward + np.outer(outer_wave, up)
    return inner, outer


def wrinkle_rail(
    y: float, bow: float, sides: float, height: float, waves: float, phases: tuple[float, float],
    lean: float,
) -> Points:  # fmt: skip
    """A strong wave over 120 mm that also leans forwards and backwards."""
    up, along = phases
    x = 120.0 * SHARE + lean * np.sin(TURN * waves * SHARE + along)
    z = height * np.sin(TURN * waves * SHARE + up) + bow * np.sin(np.pi * SHARE)
    return np.column_stack((x, y + 6.73 * np.sin(np.pi * SHARE * sides), z))


def all_rails() -> Mapping[str, tuple[Points, Points]]:
    """The rails P and Q of every example, in mm."""
    return {
        "example_1": (easy_rail(0.0, 8.0, 1.48, 3.2), easy_rail(22.0, 6.6, 1.66, 3.89)),
        "example_2": lace_rails(),
        "example_3": (
            wrinkle_rail(0.0, 4.99, 2.752, 3.18, 4.277, (0.466, 3.478), 2.276),
            wrinkle_rail(44.86, 14.28, 2.259, 4.459, 4.7, (1.933, 1.312), 1.148),
        ),
    }


def spline(points: Points, label: str) -> Edge:
    edge = Edge.make_spline([Vector(*point) for point in points])
    edge.label = label
    return edge


def main() -> None:
    for name, (p, q) in all_rails().items():
        edges = [spline(p, "P"), spline(q, "Q")]
        target = HERE / f"{name}.step"
        fixed = datetime.datetime(2026, 1, 1)
        export_step(Compound(children=edges), target, timestamp=fixed)
        print(f"{target.name}: P {edges[0].length:.2f} mm, Q {edges[1].length:.2f} mm")


if __name__ == "__main__":
    main()
