"""One file per defect: the check must name it, and name nothing in the file without it."""

from __future__ import annotations

import re
from pathlib import Path

import ezdxf
import pytest

from tests.pattern import strips
from tests.pattern.strips import dxf_bytes, make_pieces
from wrinkle_cad.pattern.check.judging import judge_dxf
from wrinkle_cad.pattern.piece.options import NotchRule, PieceSettings

CASES = Path(__file__).parent / "cases"
SQUARE = ((0, 0), (100, 0), (100, 50), (0, 50))


def drawing(release="R2000", *, outline=True):
    document = ezdxf.new(release, units=4)
    for name in ("CUT", "TEXT"):
        document.layers.add(name)
    space = document.modelspace()
    if outline:
        space.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "CUT"})
    space.add_text("PART 1, MM", height=4, dxfattribs={"layer": "TEXT"})
    return document


def judged(document, tmp_path):
    path = tmp_path / "made.dxf"
    document.saveas(path)
    return judge_dxf(path)


def codes(report):
    return [finding.code for finding in report.findings]


def severities(report):
    return [finding.severity for finding in report.findings]


def on_cut(document):
    return document.modelspace(), {"layer": "CUT"}


def test_a_sound_drawing_has_no_findings(tmp_path):
    for release in ("R12", "R2000", "R2010", "R2018"):
        document = drawing("R2000" if release == "R12" else release)
        if release == "R12":
            from ezdxf.addons import r12export

            with (tmp_path / "made.dxf").open("w") as stream:
                r12export.write(document, stream)
            report = judge_dxf(tmp_path / "made.dxf")
        else:
            report = judged(document, tmp_path)
        assert codes(report) == []
        assert report.is_clean
        assert report.cut_layers == ("CUT",)
        assert report.contour_count == 1
        assert report.release == release


def open_contour(document):
    space, layer = on_cut(document)
    space.add_lwpolyline(((200, 0), (260, 0), (260, 40)), dxfattribs=layer)


def near_miss_gap(document):
    space, layer = on_cut(document)
    points = ((200, 0), (260, 0), (260, 40), (200, 0.02))
    space.add_lwpolyline(points, dxfattribs=layer)


def near_miss_between_lines(document):
    space, layer = on_cut(document)
    for start, end in (((200, 0), (260, 0)), ((260, 0.3), (230, 40)), ((230, 40), (200, 0))):
        space.add_line(start, end, dxfattribs=layer)


def duplicate(document):
    space, layer = on_cut(document)
    turned = (SQUARE[2], SQUARE[1], SQUARE[0], SQUARE[3])
    space.add_lwpolyline(turned, close=True, dxfattribs=layer)


def overlap(document):
    space, layer = on_cut(document)
    space.add_lwpolyline(((100, 10), (150, 10), (150, 40), (100, 40)), close=True, dxfattribs=layer)


def self_intersection(document):
    space, layer = on_cut(document)
    bow = ((200, 0), (260, 40), (260, 0), (200, 40))
    space.add_lwpolyline(bow, close=True, dxfattribs=layer)


def crossing_contours(document):
    space, layer = on_cut(document)
    space.add_lwpolyline(((50, 25), (150, 25), (150, 90), (50, 90)), close=True, dxfattribs=layer)


def zero_length(document):
    space, layer = on_cut(document)
    points = ((200, 0), (260, 0), (260, 0), (230, 40))
    space.add_lwpolyline(points, close=True, dxfattribs=layer)


def repeated_last_vertex(document):
    space, layer = on_cut(document)
    points = ((200, 0), (260, 0), (230, 40), (200, 0))
    space.add_lwpolyline(points, close=True, dxfattribs=layer)


def units_missing(document):
    document.header["$INSUNITS"] = 0


def units_inch(document):
    document.header["$INSUNITS"] = 1


def units_contradict(document):
    document.header["$MEASUREMENT"] = 0


def too_small(document):
    space, layer = on_cut(document)
    space.delete_all_entities()
    space.add_lwpolyline([(0.01 * x, 0.01 * y) for x, y in SQUARE], close=True, dxfattribs=layer)
    space.add_point((0.1, 0.1), dxfattribs={"layer": "TEXT"})


def text_not_ascii(document):
    document.modelspace().add_text("Größe 38", dxfattribs={"layer": "TEXT"})


def layer_not_ascii(document):
    document.layers.add("Löcher")
    document.modelspace().add_point((9, 9), dxfattribs={"layer": "Löcher"})


def empty_layer(document):
    document.layers.add("NOTHING")


def text_on_cut(document):
    space, layer = on_cut(document)
    space.add_text("LEFT", dxfattribs=layer)


def mark_on_cut(document):
    space, layer = on_cut(document)
    space.add_point((50, 25), dxfattribs=layer)


def not_flat(document):
    space, layer = on_cut(document)
    points = ((200, 0, 0), (260, 0, 5), (230, 40, 0))
    space.add_polyline3d(points, close=True, dxfattribs=layer)


def nothing_to_cut(document):
    document.modelspace().delete_all_entities()
    document.layers.remove("CUT")
    document.modelspace().add_text("MM", dxfattribs={"layer": "TEXT"})


DEFECTS = {
    open_contour: ["open-contour"],
    near_miss_gap: ["near-miss-gap"],
    near_miss_between_lines: ["near-miss-gap"],
    duplicate: ["duplicate", "overlap"],
    overlap: ["contours-touch", "overlap"],
    self_intersection: ["self-intersection"],
    crossing_contours: ["contours-touch"],
    zero_length: ["zero-length"],
    repeated_last_vertex: ["zero-length"],
    units_missing: ["units-unsaid"],
    units_inch: ["units-not-mm"],
    units_contradict: ["units-contradict"],
    too_small: ["scale"],
    text_not_ascii: ["non-ascii"],
    layer_not_ascii: ["non-ascii"],
    empty_layer: ["empty-layer"],
    text_on_cut: ["text-on-cut"],
    mark_on_cut: ["mark-on-cut"],
    not_flat: ["not-flat"],
    nothing_to_cut: ["nothing-to-cut"],
}


@pytest.mark.parametrize("spoil", DEFECTS, ids=lambda spoil: spoil.__name__)
def test_every_defect_of_a_drawing_is_named_and_nothing_else(spoil, tmp_path):
    document = drawing()
    spoil(document)
    report = judged(document, tmp_path)
    assert codes(report) == DEFECTS[spoil], report.findings
    assert not report.is_clean
    for finding in report.findings:
        assert "\n" not in finding.message
        assert finding.message.endswith(".")
        assert " - " not in finding.message


def test_a_duplicate_ruling_is_found_on_its_layer_too(tmp_path):
    document = drawing()
    for ends in (((10, 10), (20, 20)), ((20, 20), (10, 10))):
        document.modelspace().add_line(*ends, dxfattribs={"layer": "TEXT"})
    assert codes(judged(document, tmp_path)) == ["duplicate"]


def test_loose_lines_and_arcs_that_meet_are_one_contour(tmp_path):
    document = drawing()
    space, layer = on_cut(document)
    space.add_line((200, 0), (260, 0), dxfattribs=layer)
    space.add_arc((230, 0), 30, 0, 180, dxfattribs=layer)
    assert codes(judged(document, tmp_path)) == []


def test_contours_inside_blocks_are_looked_at_where_they_are_inserted(tmp_path):
    document = drawing(outline=False)
    block = document.blocks.new("PART")
    block.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "CUT"})
    for x in (0, 50):
        document.modelspace().add_blockref("PART", (x, 0), dxfattribs={"layer": "CUT"})
    report = judged(document, tmp_path)
    assert report.contour_count == 2
    assert codes(report) == ["contours-touch", "overlap"]


def test_a_spline_is_told_but_is_no_fault(tmp_path):
    document = drawing()
    space, layer = on_cut(document)
    points = [(250, 0, 0), (300, 50, 0), (250, 100, 0), (200, 50, 0)]
    space.add_spline(dxfattribs=layer).set_closed(points, degree=3)
    report = judged(document, tmp_path)
    assert codes(report) == ["spline"]
    assert report.is_clean


def test_r12_must_say_mm_in_a_text(tmp_path):
    pieces = make_pieces(*strips.rectangle(), name="part")
    content = dxf_bytes(pieces, version="R12")
    path = tmp_path / "made.dxf"
    path.write_bytes(content.replace(b" MM", b""))
    assert codes(judge_dxf(path)) == ["units-unsaid"]


def test_the_cut_layers_can_be_named(tmp_path):
    document = drawing()
    document.layers.add("RED")
    document.modelspace().add_lwpolyline(((0, 80), (50, 90)), dxfattribs={"layer": "RED"})
    path = tmp_path / "made.dxf"
    document.saveas(path)
    assert codes(judge_dxf(path)) == []
    assert codes(judge_dxf(path, cut_layers=("RED",))) == ["open-contour"]


FULL = PieceSettings(
    seam_allowance=(5.0,) * 4,
    notches_p=NotchRule(count=2),
    drill_holes=((0.5, 0.5),),
    ruling_spacing=10.0,
)


@pytest.fixture(scope="module")
def astm():
    pieces = make_pieces(*strips.random_strip(1), name="vamp", settings=FULL)
    return dxf_bytes(pieces, profile="astm").decode("ascii")


def without_entity(text, kind, layer):
    """The file without its first entity of a kind on a layer, vertices and all."""
    pattern = rf"  0\n{kind}\n(?:  ?\d+\n[^\n]*\n)*?  8\n{layer}\n(?: +[1-9]\d*\n[^\n]*\n)*"
    if kind == "POLYLINE":
        pattern += r"(?:  0\n(?:VERTEX|SEQEND)\n(?: +[1-9]\d*\n[^\n]*\n)*)*"
    made, count = re.subn(pattern, "", text, count=1)
    assert count == 1
    return made


BLOCK_DEFECTS = {
    "piece name": (lambda t: t.replace("Piece Name:", "Peace Name:"), ["missing-key"]),
    "size": (lambda t: t.replace("\nSize: M", "\nSighs: M"), ["missing-key"]),
    "quantity": (lambda t: t.replace("Quantity:", "Quality:"), ["missing-key"]),
    "style name": (lambda t: t.replace("Style Name:", "Stile Name:"), ["missing-key"]),
    "creation date": (lambda t: t.replace("Creation Date:", "Date:"), ["missing-key"]),
    "creation time": (lambda t: t.replace("Creation Time:", "Time:"), ["missing-key"]),
    "author": (lambda t: t.replace("Author:", "By:"), ["missing-key"]),
    "sample size": (lambda t: t.replace("Sample Size:", "Sample:"), ["missing-key"]),
    "curve tolerance": (lambda t: t.replace("Curve Tolerance:", "Curves:"), ["missing-key"]),
    "version": (lambda t: t.replace("ASTM/D13Proposal", "ASTM"), ["missing-key"]),
    "units": (lambda t: t.replace("Units: METRIC", "-"), ["missing-key"]),
    "inches": (
        lambda t: t.replace("Units: METRIC", "Units: ENGLISH"),
        ["units-not-mm"],
    ),
    "curve point": (lambda t: without_entity(t, "POINT", "3"), ["point-count"]),
    "turn point": (lambda t: without_entity(t, "POINT", "2"), ["point-count"]),
    "boundary": (
        lambda t: without_entity(t, "POLYLINE", "1"),
        ["no-boundary", "point-count", "nothing-to-cut"],
    ),
    "moved point": (
        lambda t: re.sub(r"(POINT\n  8\n3\n 10\n)[-\d.]+", r"\g<1>7777.0", t, count=1),
        ["point-place"],
    ),
    "insert moved": (
        lambda t: re.sub(r"(INSERT\n(?: +\d+\n\S+\n)*? 10\n)0\.0", r"\g<1>5.0", t),
        ["insert"],
    ),
    "insert on layer 0": (
        lambda t: t.replace("INSERT\n  8\n1\n", "INSERT\n  8\n0\n"),
        ["insert-layer"],
    ),
    "lines on layer 0": (lambda t: t.replace("LINE\n  8\n7\n", "LINE\n  8\n0\n"), ["layer-0"]),
    "open boundary": (
        lambda t: re.sub(r"(POLYLINE\n  8\n1\n(?: +\d+\n\S+\n)*? 70\n)1", r"\g<1>0", t, count=1),
        ["open-contour", "no-boundary"],
    ),
}


HABITS = {
    "quantity", "style name", "creation date", "creation time", "author", "sample size",
    "curve tolerance", "version", "units", "insert on layer 0", "lines on layer 0",
}  # fmt: skip
"""What other programs leave out or do in their own way, and every reader can live with."""


def test_the_unspoilt_file_of_pieces_has_no_findings(astm, tmp_path):
    (tmp_path / "made.dxf").write_text(astm)
    assert judge_dxf(tmp_path / "made.dxf").findings == ()


@pytest.mark.parametrize("defect", BLOCK_DEFECTS)
def test_every_defect_of_a_file_of_pieces_is_named(defect, astm, tmp_path):
    spoil, expected = BLOCK_DEFECTS[defect]
    spoilt = spoil(astm)
    assert spoilt != astm
    (tmp_path / "made.dxf").write_text(spoilt)
    report = judge_dxf(tmp_path / "made.dxf")
    assert codes(report) == expected, report.findings
    assert report.is_clean == (defect in HABITS)


def test_a_thin_validation_curve_is_found(astm, tmp_path):
    vertex = r"  0\nVERTEX\n  8\n84\n(?: +\d+\n\S+\n)*?(?=  0\n)"
    spoilt = re.sub(vertex, "", astm, count=len(re.findall(vertex, astm)) - 5)
    (tmp_path / "made.dxf").write_text(spoilt)
    assert codes(judge_dxf(tmp_path / "made.dxf")) == ["validation-curve"]


def test_light_polylines_are_no_polylines_to_pattern_cad(tmp_path):
    document = ezdxf.new("R2000", units=4)
    block = document.blocks.new("PART_M")
    block.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "1"})
    block.add_text("Quantity: 1,0", dxfattribs={"layer": "1"})
    document.modelspace().add_blockref("PART_M", (0, 0), dxfattribs={"layer": "1"})
    report = judged(document, tmp_path)
    found = {
        (finding.code, finding.severity): count
        for finding, count in zip(report.findings, report.counts, strict=True)
    }
    assert found["not-polyline", "error"] == 1
    assert found["missing-key", "error"] == 2
    assert found["missing-key", "info"] == 8


@pytest.mark.parametrize("name", ["aama_split", "engrave", "execution", "binary"])
def test_what_other_programs_write_is_clean(name):
    report = judge_dxf(CASES / f"{name}.dxf")
    assert report.is_clean, report.findings
    assert report.contour_count > 0


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("near_dup", "doubled-contour"),
        ("off", "layer-off"),
        ("paper", "paper-space"),
        ("extrusion", "extrusion"),
    ],
)
def test_what_a_cutter_would_not_see_as_drawn_is_named(name, code):
    report = judge_dxf(CASES / f"{name}.dxf")
    assert code == codes(report)[0]
    assert not report.is_clean


def test_a_kind_of_finding_is_told_once_with_its_count_and_faults_come_first(tmp_path):
    document = drawing()
    space, layer = on_cut(document)
    document.layers.add("NOTHING")
    spline = [(250, 0, 0), (300, 50, 0), (250, 100, 0), (200, 50, 0)]
    space.add_spline(dxfattribs=layer).set_closed(spline, degree=3)
    for i in range(300):
        space.add_lwpolyline(((400 + 9 * i, 0), (405 + 9 * i, 7)), dxfattribs=layer)
    report = judged(document, tmp_path)
    assert codes(report) == ["open-contour", "empty-layer", "spline"]
    assert severities(report) == ["error", "warning", "info"]
    assert report.counts == (600, 1, 1)
    assert "There are 599 more like it." in report.findings[0].message


def test_a_frame_on_layer_1_makes_no_file_of_pieces(tmp_path):
    document = drawing()
    frame = document.blocks.new("FRAME")
    frame.add_lwpolyline(
        ((-9, -9), (297, -9), (297, 200), (-9, 200)), close=True, dxfattribs={"layer": "1"}
    )
    document.modelspace().add_blockref("FRAME", (0, 0), dxfattribs={"layer": "1"})
    report = judged(document, tmp_path)
    assert report.format == "drawing"
    assert codes(report) == []


def test_a_frame_among_pieces_is_told_to_be_none(astm, tmp_path):
    (tmp_path / "made.dxf").write_text(astm)
    document = ezdxf.readfile(tmp_path / "made.dxf")
    document.blocks.new("FRAME").add_line((0, 0), (9, 9), dxfattribs={"layer": "1"})
    report = judged(document, tmp_path)
    assert ("no-piece", "warning") in list(zip(codes(report), severities(report), strict=True))
    assert "no-boundary" not in codes(report)


def test_an_attribute_definition_is_a_form_and_no_text_on_the_cut_layer(tmp_path):
    document = drawing()
    space, layer = on_cut(document)
    block = document.blocks.new("PART")
    block.add_attdef("NAME", (0, 0), dxfattribs=layer)
    block.add_lwpolyline([(x + 300, y) for x, y in SQUARE], close=True, dxfattribs=layer)
    space.add_blockref("PART", (0, 0), dxfattribs=layer)
    assert codes(judged(document, tmp_path)) == []


def test_micro_segments_are_named(tmp_path):
    document = drawing()
    space, layer = on_cut(document)
    points = ((200, 0), (260, 0), (260.004, 0), (260, 40))
    space.add_lwpolyline(points, close=True, dxfattribs=layer)
    assert codes(judged(document, tmp_path)) == ["micro-segment"]


def test_three_lines_that_meet_are_a_branch(tmp_path):
    document = drawing()
    space, layer = on_cut(document)
    for end in ((300, 0), (300, 40), (250, 80)):
        space.add_line((250, 0), end, dxfattribs=layer)
    report = judged(document, tmp_path)
    assert dict(zip(codes(report), report.counts, strict=True)) == {
        "branching-contour": 1,
        "open-contour": 3,
    }


@pytest.mark.parametrize(
    "layer",
    ["CUT", "cut", "LASER_CUT", "Cut1", "outer-contour", "CutLine", "KISS CUT", "Schnitt"],
)
def test_a_word_for_cutting_makes_a_layer_one_to_be_cut(layer, tmp_path):
    document = drawing()
    space = document.modelspace()
    open_line = space.add_lwpolyline(((300, 0), (350, 9)), dxfattribs={"layer": layer})
    assert layer in judged(document, tmp_path).cut_layers
    open_line.dxf.layer = "ENGRAVE " + layer
    assert "ENGRAVE " + layer not in judged(document, tmp_path).cut_layers


@pytest.mark.parametrize("layer", ["EXECUTION", "SHORTCUTS", "Cutter notes", "UNCUT"])
def test_letters_inside_a_word_make_none(layer, tmp_path):
    document = drawing()
    document.modelspace().add_lwpolyline(((300, 0), (350, 9)), dxfattribs={"layer": layer})
    assert judged(document, tmp_path).cut_layers == ("CUT",)


@pytest.mark.parametrize("bulge", [1e-6, 2.18581666e-04, 1e-3, 0.3])
def test_flat_arcs_have_no_segment_without_length_and_repeated_vertices_have(bulge, tmp_path):
    """The second of these begins, taken apart by ezdxf, with two points 5e-12 mm apart."""
    document = ezdxf.new(units=4)
    rows = [(11.847211, 56.737098, 0.0), (0.0, 33.59142, bulge), (27.793207, 19.272829, 0.0)]
    document.modelspace().add_lwpolyline(rows, "xyb", close=True, dxfattribs={"layer": "CUT"})
    document.layers.add("CUT")
    assert judged(document, tmp_path).is_clean
    again = ezdxf.new(units=4)
    again.layers.add("CUT")
    twice = [rows[0], (0.0, 33.59142, 0.0), *rows[1:]]
    again.modelspace().add_lwpolyline(twice, "xyb", close=True, dxfattribs={"layer": "CUT"})
    assert "zero-length" in codes(judged(again, tmp_path))
