"""What the examples on an upper share: write the input, draw what the job makes of it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from wrinkle_cad import (
    NotchRule,
    Part,
    PieceSettings,
    WrinkledUpper,
    choose_inputs,
    make_job,
    pattern_of_strips,
    plot_pattern,
    read_cad,
    wrinkle_upper,
    write_step,
)

BODY = (0.60, 0.38, 0.22)
WRINKLE = (0.74, 0.51, 0.31)
BAND = (0.68, 0.45, 0.27)


def stitched_upper(folder: Path) -> WrinkledUpper:
    """Returns what the example's job makes of its input."""
    job = make_job(folder / f"{folder.name}.step", toml_path=folder / "job.toml")
    chosen = choose_inputs(read_cad(job.input), p=job.p, q=job.q, upper=job.upper)
    return wrinkle_upper(job, chosen)


def draw_result(folder: Path) -> None:
    """Writes picture.png: the stitched upper from two views."""
    from shoe_examples.picture import draw

    result = stitched_upper(folder)
    names = {strip.name for strip in result.strips}
    colors = {"body": BODY, **dict.fromkeys(names, WRINKLE)}
    parts = [(faces, colors.get(name, BAND)) for name, faces in result.stitched.parts]
    draw(parts, folder / "picture.png")


def draw_pattern(folder: Path) -> None:
    """Writes pattern.png: the wrinkle's piece and its bands', with allowance and rulings."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    result = stitched_upper(folder)
    rule = NotchRule(count=5)
    wanted = PieceSettings(seam_allowance=(4.0,) * 4, notches_p=rule, notches_q=rule, rulings=True)
    pattern = pattern_of_strips([*result.strips, *result.bands], wanted)
    figure, axes = plt.subplots(figsize=(14.0, 5.6), dpi=90, layout="constrained")
    plot_pattern(axes, pattern.pieces)
    figure.savefig(folder / "pattern.png")
    plt.close(figure)


def main(folder: Path, parts: Sequence[Part], *, has_pattern: bool = False) -> None:
    """Writes the input of an example; with ``--picture`` draws what its job makes of it."""
    step = folder / f"{folder.name}.step"
    write_step(step, parts)
    print(f"{step.name}: {', '.join(part.name for part in parts)}")
    if "--picture" in sys.argv:
        draw_result(folder)
        if has_pattern:
            draw_pattern(folder)
