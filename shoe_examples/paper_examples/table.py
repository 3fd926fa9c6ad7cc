"""Runs the paper's methods on its kind of examples; prints a table and draws a picture.

Run it with: python table.py
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
from build123d import import_step

from wrinkle_cad import Comparison, WrinkleStrip, compare

HERE = Path(__file__).parent
NAMES = ("example_1", "example_2", "example_3")


def make_strip(name: str) -> WrinkleStrip:
    """The strip of one example, its rails found by their labels in the STEP file."""
    shapes = {shape.label: shape for shape in import_step(HERE / f"{name}.step").children}
    settings = tomllib.loads((HERE / f"{name}.toml").read_text(encoding="utf-8"))
    return WrinkleStrip(shapes["P"], shapes["Q"], name=name, **settings)


def methods_of(strip: WrinkleStrip) -> dict[str, Comparison]:
    """Every method on the samples of a strip, by the paper's name of it."""
    samples = strip.triangulation
    rows = compare(samples.p, samples.q, planarity=samples.planarity)
    return {row.method: row for row in rows}


def all_bridges(row: Comparison) -> tuple[int, int]:
    """Valid interior bridges, and all bridges: the first and the last are not checked."""
    return row.valid_bridges, row.bridges + 2


def table_lines(strips: dict[str, WrinkleStrip]) -> Iterator[str]:
    """The table of the README: ours beside the paper's figures."""
    rows = {name: methods_of(strip) for name, strip in strips.items()}
    yield "| example | what is compared | the paper | here |"
    yield "|---|---|---|---|"
    easy = rows["example_1"]
    local, best = (all_bridges(easy[name]) for name in ("LODT+LMBT", "GODT+GMBT"))
    yield (
        "| I | valid bridges, LODT+LMBT and GODT+GMBT | the same strip |"
        f" the same strip: {local[0]} and {best[0]} of {best[1]} |"
    )
    lace = rows["example_2"]
    local, best = (all_bridges(lace[name]) for name in ("LODT+LMBT", "GODT+GMBT"))
    yield (
        "| II | valid bridges, LODT+LMBT against GODT+GMBT | 113 against 149 of 225 |"
        f" {local[0]} against {best[0]} of {best[1]} |"
    )
    third = rows["example_3"]
    best, least = (all_bridges(third[name]) for name in ("GODT+GMBT", "GMAT"))
    ratio = third["GODT+GMBT"].area_mm2 / third["GMAT"].area_mm2
    yield (
        "| III | valid bridges, GODT+GMBT against GMAT | 95 against 21 of 126 |"
        f" {best[0]} against {least[0]} of {best[1]} |"
    )
    yield (
        "| III | area, GODT+GMBT over GMAT | 7.4 / 6.6 = 1.12 |"
        f" {third['GODT+GMBT'].area_mm2:.0f} / {third['GMAT'].area_mm2:.0f} mm² = {ratio:.2f} |"
    )
    energies = third["LMBT"].bending, third["GMBT"].bending
    yield (
        "| IV | bending energy, LMBT over GMBT | 3.3 |"
        f" {energies[0]:.1f} / {energies[1]:.1f} = {energies[0] / energies[1]:.1f} |"
    )


def draw(strips: dict[str, WrinkleStrip], path: Path) -> None:
    """Writes a PNG: validity matrix with paths, and bending energy, of each example."""
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(len(strips), 2, figsize=(11, 11), width_ratios=(2, 3), dpi=90)
    for (matrix, energy), (name, strip) in zip(axes, strips.items(), strict=True):
        strip.plot_validity(matrix).set_title(f"{name}: chosen path and local one")
        strip.plot_energy(energy).set_title("chosen, local and least-bending")
    figure.tight_layout()
    figure.savefig(path, metadata={"Software": None})
    plt.close(figure)


def main() -> None:
    strips = {name: make_strip(name) for name in NAMES}
    for line in table_lines(strips):
        print(line)
    draw(strips, HERE / "paper_examples.png")


if __name__ == "__main__":
    main()
