"""A lampshade: a tilted ring of 120 mm over an oval foot, as one draws them.

From the project's folder: python -m shoe_examples.lampshade.build
Then, in this one: wrinkle-cad run lampshade.step --job job.toml -o out
"""

from __future__ import annotations

from pathlib import Path

from build123d import Edge, Ellipse, Pos, Rot

from wrinkle_cad import Part, write_step

HERE = Path(__file__).parent


def parts() -> list[Part]:
    """Both rings."""
    foot = Ellipse(150, 120).wire()
    top = Pos(15, 0, 190) * Rot(0, 12, 0) * Edge.make_circle(60)
    return [Part(foot.wrapped, "P"), Part(top.wrapped, "Q")]


if __name__ == "__main__":
    write_step(HERE / "lampshade.step", parts())
