"""Entities that the kernel cannot take in are told before it makes shapes of them and crashes."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.structure import entities_of
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.errors import InputError

EXAMPLES = Path(__file__).parents[3] / "shoe_examples"
UPPER = EXAMPLES / "one_wrinkle" / "one_wrinkle.step"
STRIP = EXAMPLES / "vamp_strip" / "vamp_strip.step"

WAYS = {
    "without its last parameter": lambda body: body.rpartition(b",")[0] + b")",
    "with one too many": lambda body: body.rpartition(b")")[0] + b",1.)",
    "without any": lambda body: body.partition(b"(")[0] + b"()",
    "with nothing told": lambda body: body.partition(b"(")[0] + b"($,$,$,$)",
}


def changed(source: Path, keyword: bytes, way: str, folder: Path) -> Path:
    """The file with the first entity of a kind changed."""
    content = source.read_bytes()
    own = entities_of(content)
    number = next(number for number, body in own.items() if body.startswith(keyword))
    own[number] = WAYS[way](own[number])
    head, _, rest = content.partition(b"DATA;")
    lines = b"\n".join(b"#%d = %s;" % item for item in own.items())
    path = folder / source.name
    path.write_bytes(head + b"DATA;\n" + lines + b"\n" + rest[rest.rindex(b"ENDSEC;") :])
    return path


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    ("source", "keyword"),
    [
        (STRIP, b"AXIS2_PLACEMENT_3D"),
        (STRIP, b"CARTESIAN_POINT"),
        (STRIP, b"DIRECTION"),
        (STRIP, b"B_SPLINE_CURVE_WITH_KNOTS"),
        (UPPER, b"SHELL_BASED_SURFACE_MODEL"),
        (UPPER, b"B_SPLINE_SURFACE_WITH_KNOTS"),
    ],
    ids=lambda value: value.decode() if isinstance(value, bytes) else value.stem,
)
def test_geometry_without_its_values_is_one_sentence(
    tmp_path: Path, source: Path, keyword: bytes, way: str
) -> None:
    with pytest.raises(InputError, match=r"damaged: .*Export it again\.") as caught:
        read_cad(changed(source, keyword, way, tmp_path))
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("way", WAYS)
def test_a_color_without_its_values_costs_the_colors_only(tmp_path: Path, way: str) -> None:
    read = read_cad(changed(UPPER, b"SURFACE_STYLE_USAGE", way, tmp_path))
    assert [shape.name for shape in read.shapes] == [shape.name for shape in read_cad(UPPER).shapes]


def test_points_without_names_are_no_fault(tmp_path: Path) -> None:
    path = tmp_path / "a.step"
    path.write_bytes(STRIP.read_bytes().replace(b"CARTESIAN_POINT('',", b"CARTESIAN_POINT($,"))
    assert [shape.measure for shape in read_cad(path).shapes] == [
        shape.measure for shape in read_cad(STRIP).shapes
    ]
