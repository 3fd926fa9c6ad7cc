"""One wrinkle across the vamp: the paper's Fig. 11.

From the project's folder: python -m shoe_examples.one_wrinkle.build
Then, in this one: wrinkle-cad run one_wrinkle.step --job job.toml -o out
"""

from __future__ import annotations

from pathlib import Path

from shoe_examples.example import main
from shoe_examples.rails import vamp_rail
from shoe_examples.upper import upper_face
from wrinkle_cad import Part

LEATHER = (0.60, 0.38, 0.22)


def parts() -> list[Part]:
    """The upper and the rails."""
    upper = upper_face()
    return [
        Part(upper, "upper", LEATHER),
        Part(vamp_rail(upper, 206.0, skew=3.0), "P"),
        Part(vamp_rail(upper, 180.0, skew=-3.0), "Q"),
    ]


if __name__ == "__main__":
    main(Path(__file__).parent, parts())
