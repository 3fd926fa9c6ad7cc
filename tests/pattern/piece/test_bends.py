"""Bends for makers who fold: angles, radii, places and directions, all of them or k equal ones."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from wrinkle_cad.errors import ExportError
from wrinkle_cad.pattern.check.judging import judge_dxf
from wrinkle_cad.pattern.formats.bend_table import bend_table, write_bend_table
from wrinkle_cad.pattern.formats.drawing import draw
from wrinkle_cad.pattern.formats.dxf import write_dxf
from wrinkle_cad.pattern.piece.grain_place import arrow_lines
from wrinkle_cad.pattern.piece.lettering import lettering
from wrinkle_cad.pattern.piece.options import PieceSettings

RADIUS, ANGLE = 30.0, 2.0


def piece_of(made, *, turned_over=False, **options):
    settings = PieceSettings(**options)
    (piece,) = make_pieces(*made, name="tube", settings=settings, turned_over=turned_over)
    return piece


def test_every_ruling_of_a_cylinder_is_a_bend_of_its_radius():
    count = 60
    bends = piece_of(strips.cylinder(RADIUS, ANGLE, 25.0, count), bend_table=True).bends
    step = ANGLE / (count - 1)
    chord = 2.0 * RADIUS * math.sin(0.5 * step)
    # Only every other bridge is folded: the others are diagonals of flat quadrangles.
    assert bends.fold == pytest.approx(np.full(count - 2, step), rel=1e-6)
    assert np.all(np.abs(bends.arcs[:, 0] - bends.arcs[:, 1]) < 1e-9)
    assert bends.arcs[:, 0] == pytest.approx(chord * np.arange(1, count - 1), rel=1e-9)
    assert bends.deviation == 0.0
    assert np.allclose(bends.lines[:, 0, 0], bends.arcs[:, 0])


@pytest.mark.parametrize("count", [1, 2, 5, 9])
@pytest.mark.parametrize("inward", [False, True])
def test_k_equal_bends_leave_an_arc_by_what_geometry_says(count, inward):
    made = strips.cylinder(RADIUS, ANGLE, 25.0, 600, inward=inward)
    bends = piece_of(made, equal_bends=count).bends
    assert len(bends.fold) == count
    assert np.abs(bends.fold) == pytest.approx(np.full(count, ANGLE / count), rel=4e-3)
    assert np.all((bends.fold > 0.0) != inward)
    expected = RADIUS * (1.0 - math.cos(ANGLE / (2.0 * count)))
    assert bends.deviation == pytest.approx(expected, rel=2e-2)
    places = RADIUS * ANGLE * (np.arange(count) + 0.5) / count
    assert bends.arcs[:, 0] == pytest.approx(places, abs=0.2)


def test_a_strip_that_bends_both_ways_has_bends_both_ways_and_keeps_each_total():
    for seed in range(8):
        every = piece_of(strips.random_strip(seed), bend_table=True).bends
        few = piece_of(strips.random_strip(seed), equal_bends=6).bends
        for sign in (1.0, -1.0):
            totals = [np.sum(b.fold[b.fold * sign > 0.0]) for b in (every, few)]
            assert totals[0] == pytest.approx(totals[1], abs=1e-9)
        assert len(few.fold) <= max(6, len(every.fold))
        assert np.all(np.diff(few.arcs[:, 0]) >= -1e-9)


def test_what_is_down_from_one_side_is_up_from_the_other():
    made = strips.random_strip(3)
    front = piece_of(made, bend_table=True).bends
    back = piece_of(made, bend_table=True, turned_over=True).bends
    assert np.array_equal(back.fold, -front.fold)
    assert np.allclose(back.lines * (1.0, -1.0), front.lines)


def test_the_table_says_piece_direction_angle_radius_and_places():
    piece = piece_of(strips.cylinder(RADIUS, ANGLE, 25.0, 20), bend_table=True)
    rows = list(csv.DictReader(io.StringIO(bend_table([piece]))))
    assert len(rows) == 18
    assert {row["direction"] for row in rows} == {"DOWN"}
    assert float(rows[0]["angle_deg"]) == pytest.approx(math.degrees(ANGLE / 19), abs=1e-4)
    assert float(rows[5]["radius_mm"]) == pytest.approx(RADIUS, rel=2e-2)
    assert float(rows[5]["along_p_mm"]) == pytest.approx(piece.bends.arcs[5, 0], abs=1e-3)
    assert [row["bend"] for row in rows] == [str(i) for i in range(1, 19)]


def test_a_name_with_a_comma_stays_one_value():
    settings = PieceSettings(equal_bends=2)
    pieces = make_pieces(*strips.cylinder(), name='a, "b"', settings=settings)
    rows = list(csv.DictReader(io.StringIO(bend_table(pieces))))
    assert [row["piece"] for row in rows] == ['a, "b"'] * 2


def test_bends_stand_on_their_layers_and_the_file_is_clean(tmp_path):
    path = tmp_path / "made.dxf"
    for inward, layer in ((False, "BEND_DOWN"), (True, "BEND_UP")):
        piece = piece_of(strips.cylinder(inward=inward), equal_bends=4)
        write_dxf(path, [piece])
        lines = ezdxf.readfile(path).modelspace().query(f"LINE[layer=='{layer}']")
        assert len(lines) == 4
        assert judge_dxf(path).is_clean


def test_the_deviation_of_equal_bends_is_told_and_without_them_nothing_is():
    told = [f.code for f in piece_of(strips.cylinder(), equal_bends=4).findings]
    assert "bends-reduced" in told
    assert piece_of(strips.cylinder()).bends is None
    flat = piece_of(strips.rectangle(), equal_bends=4).bends
    assert len(flat.fold) == 0


def test_a_table_that_cannot_be_written_is_an_export_error(tmp_path):
    with pytest.raises(ExportError, match="CSV"):
        write_bend_table(tmp_path / "none" / "a.csv", [])


def test_what_was_noticed_is_told_once_for_both_feet():
    settings = PieceSettings(equal_bends=4, hand="left")
    pieces = make_pieces(*strips.cylinder(), name="tube", settings=settings)
    assert [len(piece.findings) for piece in pieces] == [1, 0]


def of_quarter(count):
    """A quarter of a tube with so many bends."""
    p = np.linspace(0.0, np.pi / 2, 41)
    arc = np.column_stack((80.0 * np.sin(p), np.zeros(41), 80.0 * np.cos(p)))
    made = strips.unrolled(arc, arc + np.array((0.0, 40.0, 0.0)))
    return piece_of(made, equal_bends=count)


def test_the_grain_line_stands_between_bends_where_it_has_room():
    piece = of_quarter(4)
    made = lettering(piece, piece.texts)
    grain = shapely.LineString(made.grain_line)
    assert made.grain_leader is None
    assert grain.length >= 8.0
    assert grain.distance(shapely.MultiLineString(list(piece.bends.lines))) > 1.0


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.0])
def test_between_close_bends_the_grain_line_stands_beside_the_piece_with_a_leader(turn):
    piece = of_quarter(60)
    way = np.array((math.cos(turn), math.sin(turn)))
    piece = replace(piece, grain_line=piece.cut_line.mean(axis=0) + np.outer((-30, 30), way))
    made = lettering(piece, piece.texts)
    outline = shapely.Polygon(piece.cut_line)
    arrow = shapely.MultiLineString(arrow_lines(made.grain_line))
    assert made.grain_line[1] - made.grain_line[0] == pytest.approx(60.0 * way)
    assert arrow.distance(outline) > 2.0
    assert arrow.distance(shapely.Polygon(made.box)) > 2.0
    assert shapely.LineString(made.grain_leader).distance(outline.exterior) < 1e-9
    assert not shapely.LineString(made.grain_leader).crosses(outline)
    low, high = made.extent.min(axis=0), made.extent.max(axis=0)
    assert shapely.box(*low, *high).covers(arrow)
    drawn = [stroke for stroke in draw(piece).strokes if stroke.role == "grain"]
    assert len(drawn) == 4
    assert not [stroke for stroke in draw(piece, texts=()).strokes if stroke.role == "grain"]
