"""A gathered cuff around the ankle, in a ring-shaped opening below the collar.

From the project's folder: python -m shoe_examples.cuff.build [--result]
Then, in this one: wrinkle-cad run cuff.step --job job.toml -o out
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from OCP.TopoDS import TopoDS_Edge

from shoe_examples.example import main, stitched_upper
from shoe_examples.upper import upper_face, upper_surface
from wrinkle_cad import Part, PieceSettings, pattern_of_strips, smooth_edge, write_step

HERE = Path(__file__).parent
LEATHER = (0.60, 0.38, 0.22)
POINTS = 81


def ring_rail(height: float) -> TopoDS_Edge:
    """A loop around the upper.

    Args:
        height: from the feather edge, 0, to the collar, 1.
    """
    surface = upper_surface()
    around = np.linspace(0.0, 20.0, POINTS)
    points = np.array(
        [(at.X(), at.Y(), at.Z()) for at in (surface.Value(u, height) for u in around.tolist())]
    )
    points[-1] = points[0]
    return smooth_edge(points)


def parts() -> list[Part]:
    """The upper and the rails."""
    return [
        Part(upper_face(), "upper", LEATHER),
        Part(ring_rail(0.74), "P"),
        Part(ring_rail(0.9), "Q"),
    ]


def write_result() -> None:
    """Writes the stitched upper and the pattern of the cuff and its bands."""
    result = stitched_upper(HERE)
    shell = [Part(result.stitched.shell_shape, "upper", LEATHER)]
    write_step(HERE / "stitched.step", shell)
    pattern = pattern_of_strips([*result.strips, *result.bands], PieceSettings(notches=5))
    pattern.export_dxf(HERE / "pattern.dxf")


if __name__ == "__main__":
    main(HERE, parts())
    if "--result" in sys.argv:
        write_result()
