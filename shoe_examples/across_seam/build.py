"""An upper of four panels whose seams the strip crosses: at the toe and at both sides.

From the project's folder: python -m shoe_examples.across_seam.build
Then, in this one: wrinkle-cad run across_seam.step --job job.toml -o out
"""

from __future__ import annotations

from pathlib import Path

from shoe_examples.example import main
from shoe_examples.rails import vamp_rail
from shoe_examples.upper import sewn, upper_panels
from wrinkle_cad import Part

LEATHER = (0.60, 0.38, 0.22)


def parts() -> list[Part]:
    """The upper and the rails."""
    upper = sewn(upper_panels((0.0, 7.5, 10.0, 13.0, 20.0)))
    return [
        Part(upper, "upper", LEATHER),
        Part(vamp_rail(upper, 206.0, skew=3.0), "P"),
        Part(vamp_rail(upper, 182.0, skew=-3.0), "Q"),
    ]


if __name__ == "__main__":
    main(Path(__file__).parent, parts())
