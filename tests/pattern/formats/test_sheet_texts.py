"""Narrow pieces on a sheet are named in the waste near them, or it is said that they are not."""

from __future__ import annotations

import io
from dataclasses import replace

import ezdxf
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.piece.test_lettering import line_shape, text_shape
from tests.pattern.strips import make_pieces
from tests.seeds import seeds
from wrinkle_cad.pattern.formats.dxf import dxf_file
from wrinkle_cad.pattern.piece.nesting import nested


def laces(count, width=4.0):
    return [make_pieces(*strips.rectangle(120.0, width), name=f"lace {i}")[0] for i in range(count)]


def test_a_piece_too_narrow_for_its_name_has_it_in_the_waste_with_a_leader():
    (sheet,) = nested(laces(3), sheet=(300.0, 60.0))
    made = dxf_file(sheet.pieces, sheet=sheet.size)
    assert made.findings == ()
    check_names(made, 3, sheet.size)


def test_a_sheet_without_waste_says_which_names_are_missing():
    (sheet,) = nested(laces(3), sheet=(123.0, 21.0))
    made = dxf_file(sheet.pieces, sheet=sheet.size)
    assert [finding.code for finding in made.findings] == ["name-left-out"] * 3
    assert "lace" in made.findings[0].message


@pytest.mark.parametrize("seed", seeds(20, 3))
def test_names_lie_across_no_line_and_leaders_cross_no_other_piece(seed):
    pieces = [
        replace(piece, name=f"{piece.name} {seed}")
        for k in range(4)
        for piece in make_pieces(*strips.random_strip(4 * seed + k), name="s")
    ]
    (sheet,) = nested([*pieces, *laces(4, 3.0)], sheet=(900.0, 400.0))
    made = dxf_file(sheet.pieces, sheet=sheet.size)
    check_names(made, 4, sheet.size)


def check_names(made, narrow_count, size):
    space = ezdxf.read(io.StringIO(made.content.decode())).modelspace()
    regions = [shapely.Polygon(line_shape(e).coords) for e in space.query("*[layer=='CUT']")]
    lines = [line_shape(e) for e in space if e.dxftype() != "TEXT"]
    leaders = [line_shape(e) for e in space.query("LINE[layer=='TEXT']")]
    boxes = [text_shape(text) for text in space.query("TEXT")]
    outside = [box for box in boxes if not any(region.contains(box) for region in regions)]
    named = sum(any(region.contains(box) for box in boxes) for region in regions)
    assert len(outside) == len(leaders)
    assert len(leaders) + len(made.findings) == len(regions) - named >= narrow_count
    for box in boxes:
        assert shapely.box(0.0, 0.0, *size).contains(box)
        assert not any(line.intersects(box) for line in lines)
    for leader in leaders:
        touched = [region for region in regions if region.distance(leader) < 1e-5]
        assert len(touched) == 1
        assert touched[0].intersection(leader).length < 1e-5
