"""Faces keep names and colors of their own in STEP, and a stitched upper shows what is what."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from OCP.gp import gp_Trsf, gp_Vec
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

from tests.cad.makers import box
from tests.cad.measuring import area_of, bounding_box
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.shapes import FaceStyle, NamedShape, Part
from wrinkle_cad.cad.exchange.step.bytes import Header
from wrinkle_cad.cad.exchange.write import step_bytes, write_step
from wrinkle_cad.cad.exchange.xde import new_document, set_name, set_parameter
from wrinkle_cad.cad.kernel.measures import is_valid
from wrinkle_cad.cad.kernel.topology import (
    faces_of,
    make_compound,
    shells_of,
)
from wrinkle_cad.cad.kernel.versions import LabelList
from wrinkle_cad.errors import CadError

RED, BLUE, GREY = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.5, 0.5, 0.5)
LOOKS = ((0, "Kappe ä", RED), (3, "靴", None), (4, "", BLUE), (5, "it's ') ,", RED))
SHAPES = {
    "shell": lambda: shells_of(box())[0],
    "solid": box,
    "compound": lambda: make_compound([shells_of(box())[0], shells_of(box(30.0))[0]]),
    "loose faces": lambda: make_compound(faces_of(box())),
}


def styled(shape: TopoDS_Shape, looks: Sequence[tuple[int, str, object]] = LOOKS) -> Part:
    faces = faces_of(shape)
    return Part(shape, "toe", GREY, [FaceStyle(faces[i], name, color) for i, name, color in looks])


def middle(shape: TopoDS_Shape) -> tuple[float, ...]:
    return tuple(np.round(bounding_box(shape).mean(axis=0), 5) + 0.0)


def looks_of(found: NamedShape | Part) -> dict[tuple[float, ...], tuple[str, object]]:
    """Name and color by where the face is."""
    return {
        middle(style.face): (style.name, None if style.color is None else tuple(style.color))
        for style in found.faces
    }


def reread(path: Path, *parts: Part, schema: str = "AP214") -> tuple[NamedShape, ...]:
    write_step(path, parts, schema=schema)
    return read_cad(path).shapes


@pytest.mark.parametrize("schema", ["AP214", "AP242"])
@pytest.mark.parametrize("kind", SHAPES)
def test_faces_keep_names_and_colors_and_the_shape_stays_one(
    tmp_path: Path, kind: str, schema: str
) -> None:
    part = styled(SHAPES[kind]())
    found, *others = reread(tmp_path / "a.step", part, schema=schema)
    assert found.name == "toe"
    assert found.color == pytest.approx(GREY, abs=2e-6)
    assert looks_of(found) == looks_of(part)
    assert len(faces_of(found.shape)) == len(faces_of(part.shape))
    assert area_of(found.shape) == pytest.approx(area_of(part.shape), rel=1e-12)
    assert is_valid(found.shape)
    own = faces_of(found.shape)
    assert all(any(style.face.IsSame(face) for face in own) for style in found.faces)
    if kind == "solid":
        assert {shape.name for shape in others} == {"Kappe ä", "靴", "it's ') ,"}
        colors = {shape.name: shape.color for shape in others}
        assert colors["Kappe ä"] == RED
        assert colors["靴"] == pytest.approx(GREY, abs=2e-6)
    else:
        assert others == []


def colors_seen(path: Path) -> list[Counter[object]]:
    """Per shape how many faces have which color, as the kernel's reader of documents says."""
    document = new_document()
    reader = STEPCAFControl_Reader()
    reader.SetColorMode(True)
    reader.ReadFile(str(path))
    reader.Transfer(document)
    labels = LabelList()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    shapes.GetFreeShapes(labels)

    def color(shape: TopoDS_Shape) -> object:
        found = Quantity_Color()
        if not colors.GetColor(shape, XCAFDoc_ColorSurf, found):
            return None
        return tuple(round(value, 4) for value in found.Values(Quantity_TOC_sRGB))

    seen = []
    for i in range(1, labels.Length() + 1):
        shape = shapes.GetShape_s(labels.Value(i))
        seen.append(Counter([color(face) for face in faces_of(shape)] + [color(shape)]))
    return seen


@pytest.mark.parametrize("schema", ["AP214", "AP242"])
def test_another_reader_finds_the_colors_on_the_faces(tmp_path: Path, schema: str) -> None:
    plain = Part(shells_of(box(20.0))[0], "plain", BLUE)
    write_step(tmp_path / "a.step", [styled(shells_of(box())[0]), plain], schema=schema)
    first, second = colors_seen(tmp_path / "a.step")
    assert first == {RED: 2, BLUE: 1, GREY: 1, None: 3}
    assert second == {BLUE: 1, None: 6}


def test_build123d_reads_one_shell_with_its_own_color(tmp_path: Path) -> None:
    b123d = pytest.importorskip("build123d")
    write_step(tmp_path / "a.step", [styled(shells_of(box())[0])])
    found = b123d.import_step(str(tmp_path / "a.step"))
    assert isinstance(found, b123d.Shell)
    assert (found.label, len(found.faces())) == ("toe", 6)
    assert tuple(found.color)[:3] == pytest.approx(GREY, abs=1e-5)


def test_the_order_in_which_faces_are_given_does_not_change_the_bytes() -> None:
    shape = shells_of(box())[0]
    contents = {
        step_bytes([styled(shape, looks)], Header("a"))
        for looks in (LOOKS, LOOKS[::-1], ((5, "earlier", GREY), *LOOKS))
    }
    assert len(contents) == 1
    others = {
        step_bytes([styled(shape, looks)], Header("a"))
        for looks in (LOOKS, LOOKS[:3], (*LOOKS[:3], (5, "its", RED)), (*LOOKS[:3], (5, "", BLUE)))
    }
    assert len(others) == 4


def test_faces_without_styles_leave_the_file_as_it_was() -> None:
    shape = shells_of(box())[0]
    with_none = step_bytes([Part(shape, "toe", GREY, [])], Header("a"))
    assert with_none == step_bytes([Part(shape, "toe", GREY)], Header("a"))
    assert b"wrinkle-face" not in with_none
    assert with_none.count(b"STYLED_ITEM") == 1


def test_names_like_our_own_placeholders_are_names(tmp_path: Path) -> None:
    part = styled(shells_of(box())[0], [(0, "wrinkle-part-000000", RED), (1, "b", None)])
    part = Part(part.shape, "wrinkle-face-000000-000001", GREY, part.faces)
    (found,) = reread(tmp_path / "a.step", part)
    assert found.name == "wrinkle-face-000000-000001"
    assert looks_of(found) == looks_of(part)


def test_parts_that_share_their_faces_or_are_moved_keep_their_own_looks(tmp_path: Path) -> None:
    shift = gp_Trsf()
    shift.SetTranslation(gp_Vec(0.0, 0.0, 33.0))
    shell = shells_of(box())[0]
    parts = [
        styled(shell),
        styled(shell, [(1, "twin", BLUE)]),
        styled(shell.Moved(TopLoc_Location(shift)), [(2, "far", RED)]),
    ]
    found = reread(tmp_path / "a.step", *parts)
    assert [looks_of(shape) for shape in found] == [looks_of(part) for part in parts]


def test_a_scaled_shell_has_its_looks_where_its_faces_are(tmp_path: Path) -> None:
    """Without a unit in the file, its numbers are inches as asked for."""
    path = tmp_path / "a.step"
    write_step(path, [styled(shells_of(box())[0])])
    text, assigned = path.read_text(), re.compile(r"(UNIT_ASSIGNED_CONTEXT\s*\(\()#\d+,")
    path.write_text(assigned.sub(r"\1", text))
    (found,) = read_cad(path, unit="inch").shapes
    scaled = {
        tuple(round(25.4 * value, 3) for value in at): look
        for at, look in looks_of(styled(shells_of(box())[0])).items()
    }
    assert {
        tuple(round(value, 3) for value in at): look for at, look in looks_of(found).items()
    } == (scaled)


def test_a_shell_that_stands_twice_has_its_looks_in_both_places(tmp_path: Path) -> None:
    """Written by the kernel itself, as an assembly."""
    document = new_document()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    shell = shells_of(box())[0]
    product, assembly = shapes.AddShape(shell, False), shapes.NewShape()
    face = shapes.AddSubShape(product, faces_of(shell)[0])
    set_name(face, "cap")
    colors.SetColor(face, Quantity_Color(*RED, Quantity_TOC_sRGB), XCAFDoc_ColorSurf)
    for i, name in enumerate(("left", "right")):
        shift = gp_Trsf()
        shift.SetTranslation(gp_Vec(0.0, 100.0 * i, 0.0))
        set_name(shapes.AddComponent(assembly, product, TopLoc_Location(shift)), name)
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    set_parameter("write.stepcaf.subshapes.name", 1)
    writer.Transfer(document)
    writer.Write(str(tmp_path / "a.step"))
    at = np.array(middle(faces_of(shell)[0]))
    for i, found in enumerate(read_cad(tmp_path / "a.step").shapes):
        assert found.name == ("left", "right")[i]
        assert looks_of(found) == {tuple(at + np.array((0.0, 100.0 * i, 0.0))): ("cap", RED)}
        assert found.color is None
    assert i == 1


def test_a_shape_has_the_color_of_its_faces_only_if_all_have_it(tmp_path: Path) -> None:
    shell = shells_of(box())[0]
    for count, expected in ((5, None), (6, RED)):
        part = styled(shell, [(i, "", RED) for i in range(count)])
        (found,) = reread(tmp_path / "a.step", Part(shell, "toe", None, part.faces))
        assert found.color == expected
        assert len(found.faces) == count


def test_a_named_face_of_a_shell_is_listed_only_if_its_name_is_a_role(tmp_path: Path) -> None:
    part = styled(shells_of(box())[0], [(0, "upper", None), (1, "vamp", None)])
    toe, upper = reread(tmp_path / "a.step", part)
    assert (toe.name, len(toe.faces), upper.name, upper.kind) == ("toe", 2, "upper", "face")
    assert not upper.is_free


def test_faces_that_a_part_does_not_hold_are_refused() -> None:
    shell = shells_of(box())[0]
    stranger = FaceStyle(faces_of(box())[0], "x", RED)
    with pytest.raises(CadError, match="1 of 2 named or colored faces are not in part 'toe'"):
        step_bytes([Part(shell, "toe", None, [styled(shell).faces[0], stranger])], Header("a"))
    face: TopoDS_Face = faces_of(shell)[0]
    with pytest.raises(CadError, match="part 'toe' is one face"):
        step_bytes([Part(face, "toe", None, [FaceStyle(face, "x", RED)])], Header("a"))
