"""What the examples on an upper share: write the input, make what the job makes of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from wrinkle_cad import (
    Part,
    WrinkledUpper,
    choose_inputs,
    make_job,
    read_cad,
    wrinkle_upper,
    write_step,
)


def stitched_upper(folder: Path) -> WrinkledUpper:
    """Returns what the example's job makes of its input."""
    job = make_job(folder / f"{folder.name}.step", toml_path=folder / "job.toml")
    chosen = choose_inputs(read_cad(job.input), p=job.p, q=job.q, upper=job.upper)
    return wrinkle_upper(job, chosen)


def main(folder: Path, parts: Sequence[Part]) -> None:
    """Writes the input of an example."""
    step = folder / f"{folder.name}.step"
    write_step(step, parts)
    print(f"{step.name}: {', '.join(part.name for part in parts)}")
