"""STEP and STL out: names and colors survive, bytes repeat, failures leave nothing."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from OCP.Interface import Interface_Static
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape

from tests.cad.makers import arc, box, brep_bytes, polyline
from tests.cad.measuring import area_of, bounding_box
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.shapes import FaceStyle, Part
from wrinkle_cad.cad.exchange.step.bytes import Header, encoded
from wrinkle_cad.cad.exchange.step.names import decoded
from wrinkle_cad.cad.exchange.write import step_bytes, stl_bytes, write_step, write_stl
from wrinkle_cad.cad.kernel.measures import is_valid
from wrinkle_cad.cad.kernel.topology import (
    edges_of,
    faces_of,
    make_compound,
    make_vertex,
    shells_of,
)
from wrinkle_cad.errors import CadError, ExportError

RED = (1.0, 0.0, 0.0)
LEATHER = (0.8, 0.52, 0.25)


def parts_of_every_kind() -> list[Part]:
    block = box()
    points = make_compound([make_vertex((float(i), 2.0, 3.0)) for i in range(3)])
    wire = polyline((0.0, -10.0, 0.0), (9.0, -10.0, 0.0), (20.0, -12.0, 0.0))
    return [
        Part(block, "block", LEATHER),
        Part(shells_of(block)[0], "shell", RED),
        Part(faces_of(block)[0], "face", (0.0, 1.0, 0.0)),
        Part(edges_of(block)[0], "edge", (0.0, 0.0, 1.0)),
        Part(wire, "wire", (0.25, 0.5, 0.75)),
        Part(make_vertex((7.0, 8.0, 9.0)), "notch", RED),
        Part(points, "notches"),
        Part(make_compound(faces_of(block)[:3]), "faces", (0.5, 0.5, 0.5)),
    ]


@pytest.mark.parametrize("schema", ["AP214", "AP242"])
def test_shapes_names_and_colors_survive_also_where_parts_share_edges(
    tmp_path: Path, schema: str
) -> None:
    parts = parts_of_every_kind()
    write_step(tmp_path / "a.step", parts, schema=schema)
    found = read_cad(tmp_path / "a.step").shapes
    assert [shape.name for shape in found] == [part.name for part in parts]
    for shape, part in zip(found, parts, strict=True):
        np.testing.assert_allclose(bounding_box(shape.shape), bounding_box(part.shape), atol=1e-6)
        assert area_of(shape.shape) == pytest.approx(area_of(part.shape), rel=1e-12)
        assert len(faces_of(shape.shape)) == len(faces_of(part.shape))
        if part.color is None:
            assert shape.color is None
        else:
            assert shape.color == pytest.approx(part.color, abs=2e-6)
    assert is_valid(found[1].shape)


def test_the_schema_is_in_the_file() -> None:
    parts = [Part(arc(0.0), "P")]
    assert b"AUTOMOTIVE_DESIGN" in step_bytes(parts, Header("a"), schema="AP214")
    assert b"AP242" in step_bytes(parts, Header("a"), schema="AP242").upper()
    with pytest.raises(CadError, match="one of AP214, AP242"):
        step_bytes(parts, Header("a"), schema="AP203")


def test_curves_come_back_to_the_last_digits() -> None:
    """Poles of a re-read curve differ by less than 1e-12 of its length."""
    content = step_bytes([Part(arc(1.0 / 3.0, height=1.0 / 7.0), "P")], Header("a"))
    assert b"0.333333333333" in content


def test_the_header_says_when_and_names_the_file() -> None:
    when = datetime(2031, 2, 3, 4, 5, 6, 789, tzinfo=UTC)
    header = Header("O'Neil Größe 42.step", when)
    head = step_bytes([Part(arc(0.0))], header).split(b"DATA;")[0].decode("ascii")
    assert "'2031-02-03T04:05:06'" in head
    assert r"O''Neil Gr\X2\00F600DF\X0\e 42.step" in head


HOSTILE = [
    "two\nlines",
    "it's \"quoted\"; #1=EVIL('x');",
    "') ' ,a', b'",
    "../../etc/passwd",
    "n" * 300,
    "nul\x00 bell\x07 escape\x1b[31m",
    "靴の甲 👞",
    "\\X2\\0041\\X0\\ \\S\\ \\N\\ \\",
    "wrinkle-part-000001",
    "\ud800 lone",
    "ENDSEC;\nEND-ISO-10303-21;",
    "/* no comment",
    "",
]


def test_hostile_names_break_no_file_and_none_is_lost(tmp_path: Path) -> None:
    parts = [Part(arc(10.0 * i), name, RED) for i, name in enumerate(HOSTILE)]
    write_step(tmp_path / "a.step", parts)
    found = read_cad(tmp_path / "a.step").shapes
    blanks = str.maketrans(dict.fromkeys("\n\x00\x07\x1b\ud800", " "))
    assert [shape.name for shape in found] == [name.translate(blanks).strip() for name in HOSTILE]
    assert {path.name for path in tmp_path.iterdir()} == {"a.step"}


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.text())
def test_any_text_is_encoded_in_ascii_without_an_end_and_decodes_to_itself(text: str) -> None:
    raw = encoded(text)
    assert raw.isascii()
    assert b"'" not in raw[1:-1].replace(b"''", b"")
    assert all(byte >= 0x20 for byte in raw)
    back = decoded(raw[1:-1])
    assert len(back) == len(text)
    assert all(new in (old, " ") for new, old in zip(back, text, strict=True))


def test_a_located_compound_is_written_in_world_coordinates_without_an_assembly() -> None:
    content = step_bytes(parts_of_every_kind(), Header("a"))
    assert b"NEXT_ASSEMBLY_USAGE_OCCURRENCE" not in content
    assert b"PCURVE" not in content


BYTES = """
import hashlib, sys
from tests.cad.exchange.test_write import parts_of_every_kind
from wrinkle_cad.cad.exchange.step.bytes import Header
from wrinkle_cad.cad.exchange.write import step_bytes, stl_bytes
from wrinkle_cad.cad.exchange.shapes import Part
from tests.cad.makers import arc, box
from tests.cad.exchange.test_face_styles import styled
orders = {"ab": "ab", "ba": "ba", "b": "b"}[sys.argv[1]]
ballast = [object() for _ in range(int(sys.argv[2]))]
other = lambda: [Part(box(3.0), "b", (1, 0, 0)), Part(arc(0.0), "Q"), styled(box())]
jobs = {"a": parts_of_every_kind, "b": other}
done = {job: step_bytes(jobs[job](), Header("a.step")) for job in orders}
print(hashlib.sha256(done["b"] + stl_bytes(box())).hexdigest())
print(hashlib.sha256(done.get("a", b"")).hexdigest())
"""


@pytest.mark.slow
def test_the_same_bytes_come_from_any_process_and_any_order_of_jobs() -> None:
    outputs = [
        subprocess.run(
            [sys.executable, "-c", BYTES, order, ballast],
            capture_output=True,
            check=True,
            text=True,
        ).stdout.splitlines()
        for order, ballast in (("ab", "0"), ("ba", "100000"), ("b", "77"), ("ab", "3333333"))
    ]
    assert len({lines[0] for lines in outputs}) == 1
    assert len({lines[1] for i, lines in enumerate(outputs) if i != 2}) == 1


def test_what_other_libraries_write_and_read_stays_as_it_was(tmp_path: Path) -> None:
    """The kernel's parameters are process-wide, and colors depend on some."""
    b123d = pytest.importorskip("build123d")
    colored = b123d.Box(1, 2, 3)
    colored.color = b123d.Color("red")
    both = b123d.Compound(label="x", children=[colored, b123d.Pos(9, 0, 0) * b123d.Sphere(1)])
    counts = []
    for name in ("before", "after"):
        b123d.export_step(both, str(tmp_path / name))
        counts.append((tmp_path / name).read_bytes().count(b"STYLED_ITEM"))
        names = ("write.step.assembly", "write.surfacecurve.mode", "read.stepcaf.subshapes.name")
        counts += [Interface_Static.IVal_s(parameter) for parameter in names]
        shell = shells_of(box())[0]
        style = FaceStyle(faces_of(shell)[0], "cap", RED)
        write_step(tmp_path / "own.step", [Part(shell, "toe", None, [style])], schema="AP242")
        read_cad(tmp_path / "own.step")
    assert counts[0] > 0
    assert counts[:4] == counts[4:]


def test_different_shapes_give_different_bytes() -> None:
    """The comparison of the test above can fail."""
    digests = {
        hashlib.sha256(step_bytes([Part(arc(y), name, color)], Header("a"))).hexdigest()
        for y, name, color in ((0.0, "P", RED), (1e-9, "P", RED), (0.0, "Q", RED), (0.0, "P", None))
    }
    assert len(digests) == 4


def test_a_shape_that_the_kernel_cannot_write_is_an_error_that_names_it(tmp_path: Path) -> None:
    empty = make_compound([])
    with pytest.raises(ExportError, match="lining"):
        write_step(tmp_path / "a.step", [Part(arc(0.0), "P"), Part(empty, "lining")])
    for shape in (TopoDS_Shape(), TopoDS_Compound()):
        with pytest.raises(ExportError):
            write_step(tmp_path / "a.step", [Part(shape, "nothing")])
    with pytest.raises(ExportError, match="at least one"):
        write_step(tmp_path / "a.step", [])
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_does_not_exist_is_an_export_error(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match=r"write STEP a.step: No such file"):
        write_step(tmp_path / "no" / "a.step", [Part(arc(0.0))])
    with pytest.raises(ExportError, match=r"write STL a.stl: No such file"):
        write_stl(tmp_path / "no" / "a.stl", box())


def triangles_of(content: bytes) -> np.ndarray:
    kind = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("spare", "<u2")])
    found = np.frombuffer(content[84:], kind)
    assert len(found) == int.from_bytes(content[80:84], "little")
    return found["points"].astype(float)


def test_an_stl_holds_the_faces_triangles() -> None:
    points = triangles_of(stl_bytes(box(2.0)))
    areas = np.linalg.norm(
        np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]), axis=1
    )
    assert len(points) == 12
    assert areas.sum() / 2.0 == pytest.approx(24.0)


def test_an_stl_follows_its_own_tolerance_and_leaves_the_shape_alone(tmp_path: Path) -> None:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere

    ball = BRepPrimAPI_MakeSphere(10.0).Shape()
    before = brep_bytes(ball)
    counts = []
    for tolerance in (1.0, 0.01, 1.0):
        write_stl(tmp_path / "a.stl", ball, tolerance=tolerance)
        points = triangles_of((tmp_path / "a.stl").read_bytes())
        sag = 10.0 - np.linalg.norm(points.mean(axis=1), axis=1).min()
        assert sag <= tolerance
        counts.append(len(points))
    assert counts[0] == counts[2] < 0.5 * counts[1]
    assert brep_bytes(ball) == before


def test_an_stl_of_a_curve_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="no faces"):
        write_stl(tmp_path / "a.stl", arc(0.0))
    assert list(tmp_path.iterdir()) == []


FREECAD = """
import FreeCAD, {module}
document = FreeCAD.newDocument()
{module}.insert({path!r}, document.Name)
for thing in document.Objects:
    shape = thing.Shape
    print("FOUND", thing.Label.encode().hex(), shape.isValid(), len(shape.Faces), shape.Area)
"""


def seen_by_freecad(program: str, module: str, path: Path) -> list[tuple[str, str, str, float]]:
    script = path.with_suffix(".py")
    script.write_text(FREECAD.format(module=module, path=str(path)))
    done = subprocess.run(
        [program, str(script)], capture_output=True, text=True, timeout=120, check=True
    )
    rows = [line.split() for line in done.stdout.splitlines() if line.startswith("FOUND")]
    return [
        (bytes.fromhex(label).decode(), valid, faces, float(area))
        for _, label, valid, faces, area in rows
    ]


@pytest.mark.freecad
def test_freecad_reads_the_name_of_a_shell(tmp_path: Path, freecadcmd: str) -> None:
    path = tmp_path / "a.step"
    write_step(path, [Part(shells_of(box())[0], "靴の甲 ä (v1.2)", LEATHER)])
    (found,) = seen_by_freecad(freecadcmd, "Import", path)
    assert found == ("靴の甲 ä (v1.2)", "True", "6", pytest.approx(600.0))


@pytest.mark.freecad
@pytest.mark.parametrize("module", ["Import", "Part"])
def test_freecad_reads_a_shell_with_named_and_colored_faces_as_one(
    tmp_path: Path, freecadcmd: str, module: str
) -> None:
    path = tmp_path / "a.step"
    shell = shells_of(box())[0]
    faces = [
        FaceStyle(faces_of(shell)[i], f"face {i}", color) for i, color in ((0, RED), (3, None))
    ]
    write_step(path, [Part(shell, "toe", LEATHER, faces)])
    (found,) = seen_by_freecad(freecadcmd, module, path)
    assert found[1:] == ("True", "6", pytest.approx(600.0))


@pytest.mark.freecad
def test_freecad_reads_every_shape_of_a_file(tmp_path: Path, freecadcmd: str) -> None:
    """Through ``Part``: 0.20's ``Import`` ends without a screen on any file of several shapes."""
    path = tmp_path / "a.step"
    # Of a compound of faces it makes one object for each face.
    write_step(path, [part for part in parts_of_every_kind() if part.name != "faces"])
    found = seen_by_freecad(freecadcmd, "Part", path)
    assert all(valid == "True" for _, valid, _, _ in found)
    assert sorted(area for *_, area in found if area > 0.0) == pytest.approx([100.0, 600.0, 600.0])
