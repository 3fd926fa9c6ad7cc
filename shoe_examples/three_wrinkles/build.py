"""Three wrinkles behind each other, as where the toes bend.

From the project's folder: python -m shoe_examples.three_wrinkles.build
Then, in this one: wrinkle-cad run three_wrinkles.step --job job.toml -o out
"""

from __future__ import annotations

from pathlib import Path

from shoe_examples.example import main
from shoe_examples.rails import vamp_rail
from shoe_examples.upper import upper_face
from wrinkle_cad import Part

LEATHER = (0.60, 0.38, 0.22)
RAILS = (("front", 222.0, 205.0), ("middle", 196.0, 180.0), ("back", 171.0, 157.0))


def parts() -> list[Part]:
    """The upper and the rails."""
    upper = upper_face()
    made = [Part(upper, "upper", LEATHER)]
    for name, front, back in RAILS:
        made.append(Part(vamp_rail(upper, front, skew=2.0), f"{name}:P"))
        made.append(Part(vamp_rail(upper, back, skew=-2.0), f"{name}:Q"))
    return made


if __name__ == "__main__":
    main(Path(__file__).parent, parts())
