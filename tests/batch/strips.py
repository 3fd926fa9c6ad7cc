"""STEP files of many strips, all made from the example by stretching it."""

from __future__ import annotations

import random
import re
from pathlib import Path
from typing import Final

EXAMPLE: Final = Path(__file__).parents[2] / "shoe_examples" / "vamp_strip" / "vamp_strip.step"
_POINT: Final = re.compile(r"(CARTESIAN_POINT\(\s*'[^']*'\s*,\s*\()([^)]*)(\)\s*\))")


def stretched(factors: tuple[float, float, float]) -> str:
    """The example stretched along the axes: affine maps keep B-splines what they are."""

    def stretch(match: re.Match[str]) -> str:
        values = [float(part) for part in match.group(2).split(",")]
        if len(values) != 3:
            return match.group()
        moved = ",".join(
            f"{value * factor:.9E}" for value, factor in zip(values, factors, strict=True)
        )
        return f"{match.group(1)}{moved}{match.group(3)}"

    text = EXAMPLE.read_text()
    moved, count = _POINT.subn(stretch, text)
    assert count == text.count("CARTESIAN_POINT"), "every point is moved"
    return moved


def put_strips(folder: Path, count: int, seed: int = 0) -> list[Path]:
    """Writes as many strips, all different."""
    chance = random.Random(seed)
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"strip{number:03d}.step" for number in range(count)]
    for path in paths:
        x, y, z = (chance.uniform(0.8, 1.25) for _ in range(3))
        path.write_text(stretched((x, y, z)))
    return paths
