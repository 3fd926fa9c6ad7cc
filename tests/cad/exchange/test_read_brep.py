"""Damaged BREP files are refused in a sentence before the kernel loses its way in them."""

from __future__ import annotations

import io
import random
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import build123d as b3d
import OCP.TopTools
import pytest
from OCP.BinTools import BinTools
from OCP.BRepTools import BRepTools

from tests.cad.makers import brep_bytes
from tests.fuzz.mutations import drop_lines, flip_bytes
from tests.seeds import seeds
from wrinkle_cad.batch.alone import answer_alone
from wrinkle_cad.cad.exchange.brep_geometry import geometry_sizes
from wrinkle_cad.cad.exchange.brep_shapes import check_shapes
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.kernel.topology import make_compound
from wrinkle_cad.errors import InputError, WrinkleError
from wrinkle_cad.job.inspection import inspect_file

NUMBER = re.compile(rb"(?<=[ \n])-?\d+(?:\.\d*)?(?:e[+-]?\d+)?(?=[ \n])")
HOSTILE = (b"0", b"-1", b"1e308", b"nan", b"inf", b"25", b"2147483647", b"9.5", b"3", b"")


@cache
def tube() -> bytes:
    """A cylinder and a spline: three surfaces, seams and a curve of its own."""
    curve = b3d.Spline((0, 0, 0), (30, 20, 0), (60, 0, 0), (90, 5, 0))
    return brep_bytes(make_compound([b3d.Solid.make_cylinder(3, 4).wrapped, curve.wrapped]))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"\nLocations 0", b"\nLocations 1\n2 1 1 0", "entry 1 of its table of Locations has '1'"),
        (b"\nSurfaces 3", b"\nSurfaces 4", "has 'Triangulations' where a whole number belongs"),
        (b"\nSurfaces 3", b"\nSurfaces 2", "'1' stands where its table of Triangulations begins"),
        (b"\nSurfaces 3", b"\nSurfaces 2147483647", "a number from 0 to"),
        (b"\nPolygon3D 0", b"", "'PolygonOnTriangulations' stands where its table of Polygon3D"),
        (b"\nTriangulations 0", b"\nTriangulations 0 7", "'7' stands behind its tables"),
        (b"\n7 0 0  3 6 4", b"\n7 0 0  3 2147483647 4", "from 2 to 268435456 belongs"),
        (b"\n7 0 0  3 6 4", b"\n7 0 0  26 6 4", "entry 4 of its table of Curves has '26'"),
        (b"\n7 0 0  3 6 4", b"\n7 0 0  3 5 4", "where a whole number belongs|where a number from"),
        (b" 0 4 36.0", b" 0 3 36.0", "has 6 poles, and its knots are those of 5"),
        (b" 0 4 36.0", b" 50 4 36.0", "has knots that do not grow: 50, then 36.0"),
        (b"\n2 0 0 4", b"\n8 0 1" * 22 + b"\n2 0 0 4", "made from others more than 20 times"),
        (b"3 4CN", b"3 4XX", "has '4XX' where the number of a curve belongs"),
        (b"3 4CN", b"3 99CN", "has '99CN' where the number of a curve belongs"),
        (b"0  1e-07 3 0", b"0  1e-07 9 0", "has '9' where a number from 0 to 3 belongs"),
    ],
)
def test_what_is_wrong_in_the_tables_is_said_with_its_place(
    tmp_path: Path, old: bytes, new: bytes, message: str
) -> None:
    path = tmp_path / "a.brep"
    path.write_bytes(tube())
    assert [shape.kind for shape in read_cad(path).shapes] == ["solid", "edge"]
    assert old in tube()
    path.write_bytes(tube().replace(old, new, 1))
    with pytest.raises(InputError, match=rf"Cannot read a\.brep: damaged: .*({message})"):
        read_cad(path)


SHAPES: dict[str, Callable[[], b3d.Shape]] = {
    "cone": lambda: b3d.Solid.make_cone(5, 2, 9),
    "ball": lambda: b3d.Solid.make_sphere(4),
    "torus": lambda: b3d.Solid.make_torus(9, 2),
    "helix": lambda: b3d.Helix(3, 20, 5),
    "periodic": lambda: b3d.Spline((0, 0), (30, 20), (60, 0), (30, -20), periodic=True),
    "rational": lambda: b3d.Edge.make_bezier((0, 0), (1, 2), (3, 3), weights=[1, 2, 1]),
    "swept ellipse": lambda: b3d.extrude(b3d.Ellipse(4, 3), 4),
    "turned ellipse": lambda: b3d.revolve(b3d.Pos(9, 0) * b3d.Ellipse(4, 3)),
    "rounded": lambda: b3d.fillet(b3d.Box(9, 9, 9).edges(), 1),
    "placed": lambda: b3d.Compound([b3d.Pos(1, 2) * b3d.Rot(9, 8) * b3d.Box(1, 1, 1)] * 2),
    "letter": lambda: b3d.Text("Q", 30),
    "loft": lambda: b3d.loft([b3d.Rectangle(9, 9), b3d.Pos(0, 0, 9) * b3d.Circle(3)]),
}


@pytest.mark.parametrize("is_meshed", [False, True])
@pytest.mark.parametrize("name", SHAPES)
def test_whatever_the_kernel_writes_in_any_version_is_sound(name: str, is_meshed: bool) -> None:
    shape = SHAPES[name]()
    if is_meshed and shape.faces():
        shape.tessellate(0.5)
    for version in (1, 2, 3):
        kind = getattr(OCP.TopTools, f"TopTools_FormatVersion_VERSION_{version}")
        stream = io.BytesIO()
        BRepTools.Write_s(shape.wrapped, stream, True, True, kind)
        check_shapes(stream.getvalue(), geometry_sizes(stream.getvalue()))


def damaged(content: bytes, chance: random.Random) -> bytes:
    """Content with other bits, lines or numbers."""
    how = chance.randrange(3) if content.startswith(b"\nCASCADE") else 0
    if how == 0:
        return flip_bytes(content, chance)
    if how == 1:
        return drop_lines(content, chance)
    spots = [at for at in NUMBER.finditer(content) if at.start() > 60]
    for at in sorted(chance.sample(spots, chance.randint(1, 4)), key=lambda at: -at.start()):
        content = content[: at.start()] + chance.choice(HOSTILE) + content[at.end() :]
    return content


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(150, 0))
@pytest.mark.parametrize("is_binary", [False, True])
def test_a_damaged_file_is_read_or_refused_in_a_sentence(
    tmp_path: Path, is_binary: bool, seed: int
) -> None:
    content = tube()
    if is_binary:
        stream = io.BytesIO()
        BinTools.Write_s(b3d.Solid.make_cylinder(3, 4).wrapped, stream)
        content = stream.getvalue()
    path = tmp_path / "a.brep"
    path.write_bytes(damaged(content, random.Random(seed)))
    said = "Cannot read a.brep: "
    try:
        answer_alone(path, inspect_file, timeout=60)
    except WrinkleError as error:
        said = str(error)
    assert said.startswith("Cannot read a.brep: ")
    assert "0x" not in said
