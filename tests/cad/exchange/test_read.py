"""STEP, BREP and IGES files become named shapes in mm, or one line says exactly why not."""

from __future__ import annotations

import gzip
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from OCP.gp import gp_Trsf, gp_Vec
from OCP.IGESControl import IGESControl_Writer
from OCP.TopLoc import TopLoc_Location

from tests.cad.makers import (
    HEAD,
    PRODUCT,
    TAIL,
    UNITS,
    arc,
    box,
    brep_bytes,
    curves_text,
    line,
    polyline,
)
from tests.cad.measuring import bounding_box
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.shapes import CadFile, Part
from wrinkle_cad.cad.exchange.write import write_step
from wrinkle_cad.cad.kernel.topology import (
    faces_of,
    make_compound,
    make_vertex,
    shells_of,
)
from wrinkle_cad.errors import InputError

MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4, "ft": 304.8}


def read_text(folder: Path, text: str | bytes, name: str = "a.step", **options: str) -> CadFile:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_cad(path, **options)


def lengths(cad_file: CadFile) -> list[float]:
    return [shape.measure for shape in cad_file.shapes]


@pytest.mark.parametrize("unit", UNITS)
def test_lengths_come_in_mm_from_every_unit(tmp_path: Path, unit: str) -> None:
    found = read_text(tmp_path, curves_text(unit))
    assert found.unit == unit
    assert lengths(found) == pytest.approx([2.0 * MM[unit], 3.0 * MM[unit]], rel=1e-12)


def test_the_unit_of_the_geometry_counts_not_the_first_in_the_file(tmp_path: Path) -> None:
    unused = "#900=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n"
    found = read_text(tmp_path, curves_text("mm").replace("DATA;\n", "DATA;\n" + unused))
    assert lengths(found) == pytest.approx([2.0, 3.0])


def test_each_product_is_converted_from_its_own_unit(tmp_path: Path) -> None:
    """Two products in one file, the second in inches."""
    second = curves_text("inch")
    start, end = second.index("DATA;\n") + 6, second.index("ENDSEC;\nEND-ISO")
    shifted = second[start:end].replace("#", "#5000")
    mixed = curves_text("mm").replace(TAIL, shifted + TAIL)
    found = read_text(tmp_path, mixed)
    assert found.unit == "mm and inch"
    assert lengths(found) == pytest.approx([2.0, 3.0, 50.8, 76.2])


def test_a_file_without_a_unit_takes_the_given_one_or_mm(tmp_path: Path) -> None:
    text = curves_text(None)
    assert lengths(read_text(tmp_path, text)) == pytest.approx([2.0, 3.0])
    for unit, factor in MM.items():
        found = read_text(tmp_path, text, unit=unit)
        assert lengths(found) == pytest.approx([2.0 * factor, 3.0 * factor])
        assert unit in found.unit


def test_a_unit_that_contradicts_the_file_is_refused(tmp_path: Path) -> None:
    assert read_text(tmp_path, curves_text("inch"), unit="inch").unit == "inch"
    with pytest.raises(InputError, match="declares its unit as inch, mm was given"):
        read_text(tmp_path, curves_text("inch"), unit="mm")
    with pytest.raises(InputError, match="one of mm, cm, m, inch, ft"):
        read_text(tmp_path, curves_text(None), unit="yard")


@pytest.mark.parametrize(
    "change",
    [
        lambda text: b"\xef\xbb\xbf" + text,
        lambda text: text.replace(b"\n", b"\r\n"),
        lambda text: text.replace(b"\n", b"\r"),
        lambda text: text.decode().encode("utf-16"),
        gzip.compress,
        lambda text: text.replace(b"\n", b" "),
    ],
    ids=["byte order mark", "CRLF", "CR", "UTF-16", "gzip", "one line"],
)
def test_the_packing_of_the_text_does_not_matter(tmp_path: Path, change) -> None:
    text = curves_text(names=("P", "Q")).encode()
    found = read_text(tmp_path, change(text))
    assert [shape.name for shape in found.shapes] == ["P", "Q"]
    assert lengths(found) == pytest.approx([2.0, 3.0])


def test_names_in_any_alphabet_come_back(tmp_path: Path) -> None:
    names = ["toe cap.(v2):P", "Ferse ä'\"\\:Q", "靴の甲", "👞 Ж", "a/b\\X2\\c", "%s {0} #1"]
    parts = [Part(arc(10.0 * i), name) for i, name in enumerate(names)]
    write_step(tmp_path / "a.step", parts)
    assert [shape.name for shape in read_cad(tmp_path / "a.step").shapes] == names


def test_names_in_old_and_in_doubled_encodings_are_repaired(tmp_path: Path) -> None:
    for raw in ("Schäfte".encode("latin-1"), "Schäfte".encode().decode("latin-1").encode()):
        text = curves_text().encode().replace(b"'part'", b"'%s'" % raw)
        assert {shape.name for shape in read_text(tmp_path, text).shapes} == {"Schäfte"}


def test_names_that_programs_invent_are_no_names(tmp_path: Path) -> None:
    for name in ("NONE", "COMPOUND", "Open CASCADE STEP translator 7.6 1", "=>[0:1:1:2]"):
        text = curves_text().replace("'part'", f"'{name}'")
        assert {shape.name for shape in read_text(tmp_path, text).shapes} == {""}


def test_a_path_in_any_alphabet_is_read(tmp_path: Path) -> None:
    folder = tmp_path / "靴 ä"
    folder.mkdir()
    assert len(read_text(folder, curves_text(), "Größe 42 'x'.step").shapes) == 2


def test_the_loose_edges_of_a_named_wire_are_one_wire_again(tmp_path: Path) -> None:
    wire = polyline((0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (20.0, 5.0, 0.0), (20.0, 15.0, 0.0))
    write_step(tmp_path / "a.step", [Part(wire, "P"), Part(arc(30.0), "Q")])
    p, q = read_cad(tmp_path / "a.step").shapes
    assert (p.name, p.kind, q.name, q.kind) == ("P", "wire", "Q", "edge")
    assert p.measure == pytest.approx(20.0 + 125.0**0.5)


def test_two_unnamed_curves_that_meet_stay_two(tmp_path: Path) -> None:
    start, end = (0.0, 0.0, 0.0), (100.0, 0.0, 0.0)
    lens = make_compound([arc(0.0), line(start, end)])
    write_step(tmp_path / "a.step", [Part(lens, "lens")])
    found = read_cad(tmp_path / "a.step")
    assert [shape.kind for shape in found.shapes] == ["edge", "edge"]


def test_a_named_curve_in_pieces_that_do_not_meet_is_listed_in_pieces(tmp_path: Path) -> None:
    write_step(tmp_path / "a.step", [Part(make_compound([arc(0.0), arc(5.0)]), "P")])
    assert [shape.name for shape in read_cad(tmp_path / "a.step").shapes] == ["P", "P"]


def test_surfaces_of_one_product_are_one_item_and_solids_are_single(tmp_path: Path) -> None:
    faces = make_compound(faces_of(box())[:3])
    parts = [Part(faces, "upper"), Part(make_compound([box(), box(20.0)]), "blocks")]
    write_step(tmp_path / "a.step", parts)
    found = [
        (shape.name, shape.kind, shape.measure) for shape in read_cad(tmp_path / "a.step").shapes
    ]
    assert found == [
        ("upper", "compound", pytest.approx(300.0)),
        ("blocks", "solid", pytest.approx(600.0)),
        ("blocks", "solid", pytest.approx(2400.0)),
    ]


def test_placements_in_an_assembly_are_applied_and_ancestors_lend_their_names(
    tmp_path: Path,
) -> None:
    """The same unnamed product stands twice in an assembly, at x = 0 and at x = 500."""
    b123d = pytest.importorskip("build123d")
    upper = b123d.Shell(shells_of(box())[0])
    upper.label = "upper"
    far = b123d.Shell(shells_of(box())[0]).moved(b123d.Location((500, 0, 0)))
    far.label = "lining"
    pieces = [b123d.Line((0, 0, 0), (10, 0, 0)), b123d.Line((10, 0, 0), (10, 10, 0))]
    rail = b123d.Compound(label="toe:P", children=pieces)
    rail.location = b123d.Location((0, 0, 70))
    shoe = b123d.Compound(label="shoe", children=[upper, far, rail])
    b123d.export_step(shoe, str(tmp_path / "a.step"))
    found = {shape.name: shape for shape in read_cad(tmp_path / "a.step").shapes}
    assert set(found) == {"upper", "lining", "toe:P"}
    assert found["toe:P"].kind == "wire"
    np.testing.assert_allclose(bounding_box(found["toe:P"].shape)[:, 2], 70.0, atol=1e-6)
    np.testing.assert_allclose(bounding_box(found["lining"].shape)[:, 0], (500, 510), atol=1e-6)


def test_a_located_part_is_read_where_it_was_put(tmp_path: Path) -> None:
    shift = gp_Trsf()
    shift.SetTranslation(gp_Vec(0.0, 0.0, 33.0))
    moved = arc(0.0).Moved(TopLoc_Location(shift))
    write_step(tmp_path / "a.step", [Part(moved, "P")])
    (found,) = read_cad(tmp_path / "a.step").shapes
    assert bounding_box(found.shape)[0, 2] == pytest.approx(33.0, abs=1e-6)


def test_points_are_listed_with_their_name(tmp_path: Path) -> None:
    points = make_compound([make_vertex((1.0, 2.0, 3.0)), make_vertex((4.0, 5.0, 6.0))])
    parts = [
        Part(arc(0.0), "P"),
        Part(make_vertex((7.0, 8.0, 9.0)), "toe"),
        Part(points, "notches"),
    ]
    write_step(tmp_path / "a.step", parts)
    found = read_cad(tmp_path / "a.step").shapes
    assert [(shape.name, shape.kind) for shape in found[1:]] == [
        ("toe", "vertex"),
        ("notches", "compound"),
    ]
    np.testing.assert_allclose(bounding_box(found[2].shape), [(1, 2, 3), (4, 5, 6)], atol=1e-6)


def test_a_named_face_inside_a_solid_is_listed_but_not_free(tmp_path: Path) -> None:
    write_step(tmp_path / "a.step", [Part(box(), "block")])
    path = tmp_path / "a.step"
    path.write_text(path.read_text().replace("ADVANCED_FACE(''", "ADVANCED_FACE('top'", 1))
    block, top = read_cad(path).shapes
    assert (top.name, top.kind, top.measure) == ("top", "face", pytest.approx(100.0))
    assert block.is_free
    assert not top.is_free
    assert not top.is_surface


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        ("", "no geometry: no curve"),
        ("#1=DOCUMENT_FILE('a.stp','','',$,'',$);\n", "external references"),
        (
            "#1=TESSELLATED_SHAPE_REPRESENTATION('',(),$);\n",
            "only triangles",
        ),
    ],
)
def test_files_without_shapes_say_why(tmp_path: Path, data: str, cause: str) -> None:
    with pytest.raises(InputError, match=cause) as caught:
        read_text(tmp_path, HEAD + data + TAIL)
    assert "\n" not in str(caught.value)


def test_a_file_of_nonsense_inside_a_whole_frame_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError):
        read_text(tmp_path, HEAD + "#1=;(((#2;=)\n" + PRODUCT + TAIL)


def test_a_curve_far_out_is_refused(tmp_path: Path) -> None:
    for number in ("1.E+300", "1.E+12"):
        text = curves_text().replace("(2.0,0.0,0.)", f"({number},0.,0.)")
        with pytest.raises(InputError, match=r"damaged|no geometry"):
            read_text(tmp_path, text)


def test_brep_keeps_edges_and_wires_and_takes_the_given_unit(tmp_path: Path) -> None:
    wire = polyline((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 2.0, 0.0))
    shape = make_compound([line((0.0, 0.0, 0.0), (2.0, 0.0, 0.0)), wire, box(1.0)])
    found = read_text(tmp_path, brep_bytes(shape), "a.brep", unit="inch")
    assert [shape.kind for shape in found.shapes] == ["solid", "edge", "wire"]
    assert lengths(found) == pytest.approx([6 * 25.4**2, 2 * 25.4, 3 * 25.4])
    assert "assumed" in read_text(tmp_path, brep_bytes(shape), "a.brep").unit


def test_a_cut_brep_is_called_truncated(tmp_path: Path) -> None:
    content = brep_bytes(box())
    for share in (0.1, 0.3, 0.5, 0.7, 0.9, 0.99):
        with pytest.raises(InputError, match="truncated"):
            read_text(tmp_path, content[: int(share * len(content))], "a.brep")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"\nEd\n", b"\nEx\n", "begins with 'Ex', which is no kind of shape"),
        (b"\n0101101\n", b"\n01011x1\n", "has '01011x1' where its seven flags belong"),
        (b"\n1e-07\n", b"\nnan\n", "has 'nan' where a number of at most"),
        (b"\n1e-07\n", b"\n", "has"),
        (b"\n0 0\n", b"\n", r"has '\*' where a whole number"),
        (b"+47 0", b"+99 0", "consists of a shape that the file does not have"),
        (b"\nTShapes 47", b"\nTShapes 48", "shape 48 of 48 begins with"),
    ],
)
def test_a_brep_whose_shapes_are_damaged_says_which(
    tmp_path: Path, old: bytes, new: bytes, message: str
) -> None:
    wire = polyline((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 2.0, 0.0))
    content = brep_bytes(make_compound([arc(0.0), arc(30.0), box(), wire]))
    assert read_text(tmp_path, content, "a.brep").shapes
    assert old in content
    with pytest.raises(InputError, match=rf"damaged: (shape \d+ of 47 )?{message}"):
        read_text(tmp_path, content.replace(old, new, 1), "a.brep")


@pytest.mark.parametrize("unit", ["MM", "IN", "FT", "M"])
def test_iges_is_read_in_its_own_unit(tmp_path: Path, unit: str) -> None:
    writer = IGESControl_Writer(unit, 0)
    writer.AddShape(arc(0.0))
    assert writer.Write(str(tmp_path / "a.igs"))
    found = read_cad(tmp_path / "a.igs")
    assert found.format == "IGES"
    assert found.unit == {"MM": "mm", "IN": "inch", "FT": "ft", "M": "m"}[unit]
    np.testing.assert_allclose(bounding_box(found.shapes[0].shape)[:, 0], (0.0, 100.0), atol=1e-6)
    packed = gzip.compress((tmp_path / "a.igs").read_bytes())
    assert lengths(read_text(tmp_path, packed, "b.igs")) == lengths(found)


def test_a_cut_iges_is_called_truncated(tmp_path: Path) -> None:
    writer = IGESControl_Writer("MM", 0)
    writer.AddShape(arc(0.0))
    assert writer.Write(str(tmp_path / "a.igs"))
    lines = (tmp_path / "a.igs").read_bytes().splitlines(keepends=True)
    for kept in (lines[:-1], lines[: len(lines) // 2], [*lines[:-3], *lines[-2:]]):
        with pytest.raises(InputError, match="truncated"):
            read_text(tmp_path, b"".join(kept), "a.igs")


def test_the_kernel_keeps_off_standard_output(tmp_path: Path) -> None:
    (tmp_path / "a.step").write_text(curves_text())
    code = (
        "import sys; from pathlib import Path\n"
        "from wrinkle_cad.cad.exchange.read import read_cad\n"
        "assert 'OCP' not in sys.modules\n"
        "path = Path(sys.argv[1])\n"
        "shape = read_cad(path).shapes[0].shape\n"
        "from wrinkle_cad.cad.exchange.write import Part, write_step, write_stl\n"
        "write_step(path.with_name('b.step'), [Part(shape, 'P', (1, 0, 0))])\n"
        "assert 'build123d' not in sys.modules and 'numba' not in sys.modules\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "a.step")], capture_output=True, check=True
    )
    assert (done.stdout, done.stderr) == (b"", b"")


REAL_UNITS = {
    "bellyfairing_guides.brep": ("mm (assumed, the file has none)", [30.2022, 30.0755]),
    "nacelle_guides.brep": (
        "mm (assumed, the file has none)",
        [1366.59, 1607.31, 1939.36, 1275.49],
    ),
    "spiralwing_guides.brep": ("mm (assumed, the file has none)", [3.90811, 3.95443, 3.90811]),
    "face.stp": ("mm", [1e6]),
    "wigley_hull.step": ("m", [858291.0]),
    "machined_part_inch.step": ("inch", [34733.6]),
    "wing_with_guides.igs": ("mm", [1.32018e8]),
}


@pytest.mark.realdata
@pytest.mark.parametrize("name", REAL_UNITS)
def test_real_files_are_read_in_mm(realdata: Path, name: str) -> None:
    unit, measures = REAL_UNITS[name]
    found = read_cad(realdata / name)
    assert found.unit == unit
    assert lengths(found) == pytest.approx(measures, rel=1e-5)


REAL_CAUSES = {
    "Ad014.stp": "no geometry",
    "Gn002.stp": "3 weights for 4 control points",
    "N010.stp": "edge #40 is 5e-05 mm long, shorter than the accuracy",
    "empty_0byte.step": "the file is empty",
    "not_a_step_file.step": "not a STEP, BREP or IGES file",
    "wigley_lfs_pointer.step": "git-LFS pointer",
    "wigley_truncated60.step": "truncated",
}


@pytest.mark.realdata
def test_real_bad_files_each_have_their_own_cause(realdata: Path) -> None:
    messages = {}
    for name, cause in REAL_CAUSES.items():
        with pytest.raises(InputError, match=cause) as caught:
            read_cad(realdata / "bad" / name)
        messages[name] = str(caught.value).replace(name, "")
        assert "\n" not in messages[name]
    assert len(set(messages.values())) == len(REAL_CAUSES)
    assert read_cad(realdata / "bad" / "wigley_is_gzip.step").is_compressed
