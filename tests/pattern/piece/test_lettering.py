"""Texts measured by another program's fonts: inside their piece, or beside it, across no line."""

from __future__ import annotations

import io
from itertools import combinations

import ezdxf
import numpy as np
import pytest
import shapely
import shapely.affinity
from ezdxf.tools.text_size import text_size

from tests.pattern import strips
from tests.pattern.strips import dxf_bytes, make_pieces
from wrinkle_cad.pattern.piece.grain_place import arrow_lines
from wrinkle_cad.pattern.piece.lettering import lettering
from wrinkle_cad.pattern.piece.options import PieceSettings

SLOW = pytest.mark.slow


def random_job(seed):
    """One to nine pieces with everything on them that a user may ask for."""
    random = np.random.default_rng(seed)
    pieces = []
    for number in range(int(random.integers(1, 10))):
        allowance = float(random.choice((0.0, 4.0, 8.0)))
        settings = PieceSettings(
            seam_allowance=(allowance,) * 4,
            notches=int(random.integers(0, 6)),
            rulings=bool(random.integers(2)),
            ruling_spacing=float(random.choice((0.0, 10.0))),
            stretch="across" if random.integers(2) else None,
            drill_holes=((0.5, 0.5),) if random.integers(2) else (),
            material="Calf" if random.integers(2) else "",
        )
        strip = strips.random_strip(int(random.integers(1000)))
        pieces += make_pieces(*strip, name=f"piece {number}", settings=settings)
    return pieces


def text_shape(text):
    """The box of a TEXT by ezdxf's own fonts, from its base line up."""
    size = text_size(text)
    x, y = text.dxf.insert.x, text.dxf.insert.y
    box = shapely.box(0.0, 0.0, size.width, size.cap_height)
    turned = shapely.affinity.rotate(box, text.dxf.rotation, origin=(0.0, 0.0))
    return shapely.affinity.translate(turned, x, y)


def line_shape(entity):
    if entity.dxftype() == "LINE":
        rows = [tuple(entity.dxf.start)[:2], tuple(entity.dxf.end)[:2]]
        return shapely.LineString(rows)
    if entity.dxftype() == "POINT":
        return shapely.Point(tuple(entity.dxf.location)[:2])
    kind = entity.dxftype()
    points = (
        entity.get_points("xy") if kind == "LWPOLYLINE" else [tuple(p)[:2] for p in entity.points()]
    )
    return shapely.LinearRing(points) if entity.is_closed else shapely.LineString(points)


def check_texts(texts, lines, outlines):
    shapes = [text_shape(text) for text in texts]
    for text, shape in zip(texts, shapes, strict=True):
        assert text.dxf.height >= 2.0
        inside = [outline for outline in outlines if outline.contains(shape)]
        beside = not any(outline.intersects(shape) for outline in outlines)
        assert inside or beside, text.dxf.text
        assert not any(line.intersects(shape) for line in lines), text.dxf.text
    for one, other in combinations(shapes, 2):
        assert not one.intersects(other)


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(s, marks=SLOW) for s in range(3, 60))])
def test_texts_of_random_jobs_stand_inside_or_beside_and_cross_no_line(seed):
    pieces = random_job(seed)
    space = ezdxf.read(io.StringIO(dxf_bytes(pieces).decode())).modelspace()
    lines = [line_shape(e) for e in space if e.dxftype() != "TEXT"]
    outlines = [shapely.Polygon(line_shape(e).coords) for e in space.query("*[layer=='CUT']")]
    check_texts(list(space.query("TEXT")), lines, outlines)
    for profile in ("aama", "astm"):
        document = ezdxf.read(io.StringIO(dxf_bytes(pieces, profile=profile).decode()))
        shapes, texts, cuts = [], list(document.modelspace().query("TEXT")), []
        for block in (b for b in document.blocks if not b.is_any_layout):
            texts += block.query("TEXT")
            shapes += [line_shape(e) for e in block if e.dxftype() != "TEXT"]
            cuts += [
                shapely.Polygon(line_shape(e).coords) for e in block.query("POLYLINE[layer=='1']")
            ]
        check_texts(texts, shapes, cuts)


def test_a_roomy_piece_has_its_texts_inside_at_a_comfortable_size():
    (piece,) = make_pieces(*strips.rectangle(150.0, 80.0), name="part")
    made = lettering(piece, piece.texts)
    assert made.leader is None
    assert made.rows[0].height >= 3.0
    assert shapely.Polygon(piece.sew_line).contains(shapely.Polygon(made.box))


def test_a_slanted_piece_has_its_texts_along_it():
    """A band of 14 mm that rises at 45 degrees over 200 mm."""
    length, width = 200.0, 14.0
    rows = np.array([(0.0, 0.0, 0.0), (length, length, 0.0)]) / np.sqrt(2.0)
    across = width * np.array((-1.0, 1.0, 0.0)) / np.sqrt(2.0)
    from dataclasses import replace

    (piece,) = make_pieces(*strips.unrolled(rows, rows + across), name="band")
    # Turned by hand: a piece lies along x, and its frame turns with it.
    turn = np.array(((1.0, 1.0), (-1.0, 1.0))) / np.sqrt(2.0)
    from wrinkle_cad.pattern.piece.piece import make_outline

    sew = make_outline(piece.sew.points @ turn, piece.sew.sides, piece.sew.corners)
    slanted = replace(piece, sew=sew, cut=sew, grain_line=piece.grain_line @ turn)
    made = lettering(slanted, slanted.texts)
    assert made.leader is None
    assert abs(made.rows[0].angle) == pytest.approx(np.pi / 4)


def test_a_piece_too_narrow_for_letters_has_them_beside_it_with_a_leader():
    (piece,) = make_pieces(*strips.rectangle(120.0, 4.0), name="lace")
    made = lettering(piece, piece.texts)
    assert made.rows[0].height == 4.0
    assert not shapely.Polygon(made.box).intersects(shapely.Polygon(piece.cut_line))
    ring = shapely.LinearRing(piece.cut_line)
    assert ring.distance(shapely.Point(made.leader[-1])) < 1e-9
    leader = shapely.LineString(made.leader)
    assert not leader.crosses(ring)


def test_the_grain_line_is_clear_of_texts_and_rulings():
    settings = PieceSettings(rulings=True, seam_allowance=(6.0, 6.0, 6.0, 6.0))
    for seed in range(6):
        for piece in make_pieces(*strips.random_strip(seed), name="s", settings=settings):
            made = lettering(piece, piece.texts)
            grain = shapely.MultiLineString(arrow_lines(made.grain_line))
            assert not grain.intersects(shapely.Polygon(made.box))
            for outline in (piece.sew_line, piece.cut_line):
                assert grain.distance(shapely.LinearRing(outline)) > 0.4
            for line in made.rulings:
                assert grain.distance(shapely.LineString(line)) > 0.9


def test_on_a_piece_too_narrow_for_arrowheads_the_grain_line_stands_beside():
    (piece,) = make_pieces(*strips.rectangle(120.0, 2.5), name="lace")
    made = lettering(piece, piece.texts)
    assert shapely.LineString(made.grain_line).distance(shapely.Polygon(piece.cut_line)) > 2.0
    assert shapely.LineString(made.grain_leader).distance(shapely.LinearRing(piece.cut_line)) < 1e-9
    # The formats of cutting rooms have it in the piece.
    document = ezdxf.read(io.StringIO(dxf_bytes([piece], profile="aama").decode()))
    (line,) = [e for b in document.blocks for e in b.query("LINE[layer=='7']")]
    assert shapely.Polygon(piece.cut_line).contains(
        shapely.LineString([tuple(line.dxf.start)[:2], tuple(line.dxf.end)[:2]])
    )


def test_moving_a_piece_moves_its_texts_and_changes_nothing_else():
    (piece,) = make_pieces(*strips.random_strip(4), name="s")
    one = lettering(piece, piece.texts)
    other = lettering(piece.moved(np.array((123.4, -56.7))), piece.texts)
    assert np.allclose(other.box - one.box, (123.4, -56.7), atol=1e-9)
    assert [row.height for row in one.rows] == [row.height for row in other.rows]


def test_pieces_are_laid_out_with_room_for_the_texts_beside_them():
    pieces = [make_pieces(*strips.rectangle(60.0, 5.0), name=f"lace {i}")[0] for i in range(3)]
    space = ezdxf.read(io.StringIO(dxf_bytes(pieces).decode())).modelspace()
    lines = [line_shape(e) for e in space if e.dxftype() != "TEXT"]
    outlines = [shapely.Polygon(line_shape(e).coords) for e in space.query("*[layer=='CUT']")]
    check_texts(list(space.query("TEXT")), lines, outlines)
