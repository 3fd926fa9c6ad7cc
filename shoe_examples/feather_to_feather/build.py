"""A strip from feather edge to feather edge: it ends on the upper's border and cuts it in two.

From the project's folder: python -m shoe_examples.feather_to_feather.build
Then, in this one: wrinkle-cad run feather_to_feather.step --job job.toml -o out
"""

from __future__ import annotations

from pathlib import Path

from shoe_examples.example import main
from shoe_examples.rails import feather_rail
from shoe_examples.upper import upper_face
from wrinkle_cad import Part

LEATHER = (0.60, 0.38, 0.22)


def parts() -> list[Part]:
    """The upper and the rails."""
    upper = upper_face()
    return [
        Part(upper, "upper", LEATHER),
        Part(feather_rail(upper, 205.0, skew=3.0), "P"),
        Part(feather_rail(upper, 182.0, skew=-3.0), "Q"),
    ]


if __name__ == "__main__":
    main(Path(__file__).parent, parts())
