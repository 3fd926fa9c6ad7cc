"""The anatomy of AAMA-292 and ASTM D6673 files, by the reader without ezdxf."""

from __future__ import annotations

import math
from collections import Counter
from datetime import datetime

import pytest

from tests.pattern import strips
from tests.pattern.group_codes import area_of, read_group_codes
from tests.pattern.strips import dxf_bytes, make_pieces
from wrinkle_cad.pattern.formats.dxf import write_dxf
from wrinkle_cad.pattern.piece.options import NotchRule, PieceSettings

STYLE_KEYS = {
    "Style Name": "Jazz 84",
    "Creation Date": "29-02-2024",
    "Creation Time": "13:05",
    "Author": "wrinkle-cad",
    "Sample Size": "38",
    "Units": "METRIC",
    "Curve Tolerance": "0.05",
    "ASTM/D13Proposal 1 Version": "D 6673-10",
}


def full(kind="v"):
    return PieceSettings(
        rulings=True,
        seam_allowance=(5.0, 8.0, 10.0, 0.0),
        notches_p=NotchRule(count=4),
        notches_q=NotchRule(count=2),
        notch_kind=kind,
        drill_holes=((0.3, 0.5), (0.6, 0.4)),
        material="Calf",
        stretch="across",
        size="38",
        quantity=2,
    )


def two_pieces(kind="v"):
    return (
        *make_pieces(*strips.random_strip(1), name="vamp", settings=full(kind)),
        *make_pieces(*strips.kinked(), name="tongue", settings=full(kind)),
    )


@pytest.fixture(params=["aama", "astm"])
def dxf(request):
    content = dxf_bytes(
        two_pieces(), profile=request.param, style="Jazz 84", timestamp=datetime(2024, 2, 29, 13, 5)
    )
    return read_group_codes(content)


def keys(entities):
    texts = [e.text(1) for e in entities if e.kind == "TEXT" and e.layer == "1"]
    return dict(text.split(": ", 1) for text in texts)


def test_the_sections_are_header_blocks_and_entities(dxf):
    assert dxf.sections == ["HEADER", "BLOCKS", "ENTITIES"]
    assert dxf.header == {}


def test_there_is_one_block_per_piece_and_size_and_no_other(dxf):
    assert list(dxf.blocks) == ["VAMP_38", "TONGUE_38"]
    inserts = [e for e in dxf.entities if e.kind == "INSERT"]
    assert [e.text(2) for e in inserts] == list(dxf.blocks)
    for insert in inserts:
        assert insert.layer == "1"
        assert (insert.number(10), insert.number(20), insert.number(30)) == (0.0, 0.0, 0.0)
        assert not {41, 42, 43, 50} & {code for code, _ in insert.tags}


def test_contours_are_old_closed_polylines(dxf):
    for block, entities in dxf.blocks.items():
        assert {e.kind for e in entities} <= {"POLYLINE", "POINT", "LINE", "TEXT"}
        for layer in ("1", "14"):
            (contour,) = dxf.on(layer, "POLYLINE", block)
            assert contour.is_closed
            assert contour.vertices[0] != contour.vertices[-1]
            assert area_of(contour.vertices) > 0.0


def test_turn_and_curve_points_are_the_vertices_of_all_lines(dxf):
    for block in dxf.blocks:
        lines = [e for layer in ("1", "8", "11", "14") for e in dxf.on(layer, "POLYLINE", block)]
        vertices = Counter(vertex for line in lines for vertex in line.vertices)
        points = [e for layer in ("2", "3") for e in dxf.on(layer, "POINT", block)]
        assert len(points) == vertices.total()
        assert Counter((e.number(10), e.number(20)) for e in points) == vertices
        assert dxf.on("2", "POINT", block)


def test_curved_outlines_have_curve_points_and_straight_ones_none():
    curved = read_group_codes(dxf_bytes(two_pieces()[:1], profile="aama"))
    straight = make_pieces(*strips.rectangle(), name="square")
    plain = read_group_codes(dxf_bytes(straight, profile="aama"))
    assert curved.on("3", "POINT", "VAMP_38")
    assert not plain.on("3", "POINT", "SQUARE_M")
    assert len(plain.on("2", "POINT", "SQUARE_M")) == 4


def test_validation_curves_are_at_least_as_dense_and_the_same_shape(dxf):
    for block in dxf.blocks:
        for layer, copy in (("1", "84"), ("8", "85"), ("14", "87")):
            lines, copies = dxf.on(layer, "POLYLINE", block), dxf.on(copy, "POLYLINE", block)
            assert len(lines) == len(copies)
            for line, dense in zip(lines, copies, strict=True):
                assert len(dense.vertices) >= len(line.vertices)
                assert set(line.vertices) <= set(dense.vertices)
                assert area_of(dense.vertices) == pytest.approx(area_of(line.vertices), abs=1e-3)


def test_style_and_piece_texts_are_complete(dxf):
    assert keys(dxf.entities) == STYLE_KEYS
    assert keys(dxf.blocks["VAMP_38"]) == {
        "Piece Name": "vamp",
        "Size": "38",
        "Quantity": "2,0",
        "Material": "Calf",
    }
    assert keys(dxf.blocks["TONGUE_38"])["Piece Name"] == "tongue"


def test_layer_0_holds_nothing(dxf):
    for entities in (dxf.entities, *dxf.blocks.values()):
        assert "0" not in {e.layer for e in entities}


def test_notches_are_points_with_depth_width_and_angle(dxf):
    for piece, block in zip(two_pieces(), dxf.blocks, strict=True):
        points = dxf.on("4", "POINT", block)
        assert len(points) == len(piece.notches) > 0
        (contour,) = dxf.on("1", "POLYLINE", block)
        for point, notch in zip(points, piece.notches, strict=True):
            assert point.number(30) == pytest.approx(notch.depth, abs=1e-6)
            assert point.number(39) == pytest.approx(notch.width, abs=1e-6)
            angle = math.radians(point.number(50))
            assert (math.cos(angle), math.sin(angle)) == pytest.approx(
                tuple(notch.direction), abs=1e-6
            )
            place = (point.number(10), point.number(20))
            assert distance_to(contour.vertices, place) < 1e-5


def distance_to(vertices, place):
    def to_segment(a, b):
        run = (b[0] - a[0], b[1] - a[1])
        square = run[0] ** 2 + run[1] ** 2
        share = ((place[0] - a[0]) * run[0] + (place[1] - a[1]) * run[1]) / square
        share = min(1.0, max(0.0, share))
        return math.dist(place, (a[0] + share * run[0], a[1] + share * run[1]))

    after = vertices[1:] + vertices[:1]
    return min(to_segment(a, b) for a, b in zip(vertices, after, strict=True))


@pytest.mark.parametrize(
    ("kind", "layer"),
    [("slit", "4"), ("v", "4"), ("t", "80"), ("castle", "81"), ("check", "82"), ("u", "83")],
)
def test_forms_of_notches_have_their_layers_in_astm_and_one_in_aama(kind, layer):
    for profile, expected in (("astm", layer), ("aama", "4")):
        dxf = read_group_codes(dxf_bytes(two_pieces(kind), profile=profile))
        used = {e.layer for e in dxf.blocks["VAMP_38"] if e.kind == "POINT"}
        assert used - {"2", "3", "13"} == {expected}


def test_marks_stand_on_their_layers(dxf):
    for block in dxf.blocks:
        assert len(dxf.on("7", "LINE", block)) == 1
        assert len(dxf.on("33", "LINE", block)) == 1
        assert len(dxf.on("13", "POINT", block)) == 2
        assert dxf.on("15", "TEXT", block)


def test_mountains_and_valleys_differ_in_color_and_a_text_says_so(dxf):
    colors = {e.text(62) for e in dxf.on("8", "POLYLINE", "VAMP_38")}
    assert colors == {"1", "5"}
    notes = [e.text(1) for e in dxf.on("15", "TEXT", "VAMP_38")]
    assert "RULINGS: COLOR 1 MOUNTAIN, 5 VALLEY" in notes


def test_cut_outs_are_lines_on_layer_11_with_points_and_copies():
    from dataclasses import replace

    import numpy as np

    (piece,) = make_pieces(*strips.rectangle(), name="ring")
    hole = np.array(((40.0, 10.0), (60.0, 10.0), (60.0, 30.0), (40.0, 30.0)))
    dxf = read_group_codes(dxf_bytes([replace(piece, cut_outs=(hole,))], profile="astm"))
    (line,) = dxf.on("11", "POLYLINE", "RING_M")
    assert area_of(line.vertices) == pytest.approx(400.0)
    assert len(dxf.on("2", "POINT", "RING_M")) == 8
    assert len(dxf.on("86", "POLYLINE", "RING_M")) == 1


def test_equal_names_give_different_blocks():
    pieces = [*make_pieces(*strips.rectangle(), name="a b")] * 2
    dxf = read_group_codes(dxf_bytes(pieces, profile="aama"))
    assert list(dxf.blocks) == ["A_B_M", "A_B-2_M"]


def test_each_hand_is_ordered_by_itself_and_no_mirrored_copy_with_it():
    settings = PieceSettings(hand="left", quantity=2)
    dxf = read_group_codes(
        dxf_bytes(make_pieces(*strips.rectangle(), name="a", settings=settings), profile="aama")
    )
    ordered = {keys(e)["Piece Name"]: keys(e)["Quantity"] for e in dxf.blocks.values()}
    assert ordered == {"a LEFT": "2,0", "a RIGHT": "2,0"}


def test_the_style_is_named_after_the_file_where_nobody_named_it(tmp_path):
    write_dxf(tmp_path / "Jazz 84.dxf", two_pieces(), profile="aama")
    dxf = read_group_codes((tmp_path / "Jazz 84.dxf").read_bytes())
    assert keys(dxf.entities)["Style Name"] == "Jazz 84"
