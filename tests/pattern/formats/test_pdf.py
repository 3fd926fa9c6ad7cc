from __future__ import annotations

import re
import zlib
from itertools import combinations

import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from wrinkle_cad.errors import ExportError, InputError
from wrinkle_cad.pattern.formats.paper import on_paper
from wrinkle_cad.pattern.formats.pdf import pdf_file, write_pdf
from wrinkle_cad.pattern.piece.options import PieceSettings

from .test_dxf import FULL

POINTS_PER_MM = 72.0 / 25.4


def page_boxes(content):
    boxes = re.findall(rb"/MediaBox \[([^\]]+)\]", content)
    return [np.array(box.split(), float)[2:] / POINTS_PER_MM for box in boxes]


def streams(content):
    """The drawing commands of every page, in order."""
    found = re.findall(rb"/FlateDecode[^>]*>>\s*stream\r?\n(.*?)\r?\nendstream", content, re.S)
    texts = [zlib.decompress(part) for part in found]
    return [text.decode("latin-1") for text in texts if b" m\n" in text and b"BT" in text]


def test_a_small_piece_is_one_sheet_of_a4():
    made = pdf_file(make_pieces(*strips.rectangle(), name="part"))
    assert made.page_count == 1
    (box,) = page_boxes(made.content)
    assert sorted(box) == pytest.approx([210.0, 297.0], abs=0.01)


def test_a_large_piece_takes_as_many_pages_as_its_windows_need():
    # Windows of 186 x 273 mm share 10 mm: 176 and 263 mm of progress.
    made = pdf_file(make_pieces(*strips.rectangle(600.0, 100.0), name="part"))
    # With the picture of all pages first.
    assert made.page_count == 1 + 3
    assert all(box[0] > box[1] for box in page_boxes(made.content)[1:])
    tall = pdf_file(make_pieces(*strips.rectangle(350.0, 345.0), name="part"))
    assert tall.page_count == 1 + 4
    assert all(box[0] < box[1] for box in page_boxes(tall.content))


def test_lengths_on_paper_are_those_of_the_piece():
    content = pdf_file(make_pieces(*strips.rectangle(120.0, 40.0), name="part")).content
    (page,) = streams(content)
    lines = re.findall(r"((?:[-\d.]+ [-\d.]+ [ml]\n)+)", page)
    sizes = []
    for line in lines:
        points = np.array(re.findall(r"([-\d.]+) ([-\d.]+) [ml]", line), float) / POINTS_PER_MM
        sizes.append(tuple(np.round(np.ptp(points, axis=0), 2)))
    assert (120.0, 40.0) in sizes
    assert (50.0, 0.0) in sizes


def test_every_page_says_where_it_belongs():
    import matplotlib as mpl

    with mpl.rc_context({"pdf.fonttype": 42, "pdf.use14corefonts": True}):
        made = pdf_file(make_pieces(*strips.rectangle(600.0, 100.0), name="part"))
    first, *pages = streams(made.content)
    assert "page 1 of 4: all pages" in first
    assert "HOW THE PAGES GO TOGETHER" in first
    for number, page in enumerate(pages, start=1):
        assert f"page {number + 1} of 4, row A, column {number}" in page
        assert "this bar is 50 mm" in page


def test_no_piece_that_fits_on_one_sheet_is_cut_by_an_edge_of_paper():
    pieces = [
        *make_pieces(*strips.rectangle(250.0, 60.0), name="a"),
        *make_pieces(*strips.rectangle(120.0, 150.0), name="b"),
        *make_pieces(*strips.rectangle(100.0, 230.0), name="c"),
        *make_pieces(*strips.rectangle(60.0, 30.0), name="d"),
        *make_pieces(*strips.rectangle(500.0, 60.0), name="large"),
    ]
    groups = on_paper(pieces)
    found = []
    for group in groups:
        frame = shapely.box(0.0, 0.0, *group.size)
        for piece in group.pieces:
            outline = shapely.Polygon(piece.cut_line)
            assert frame.contains(outline)
            found.append(piece.name)
            if piece.name == "large":
                windows = [
                    shapely.box(*group.corner(*page), *(group.corner(*page) + group.window))
                    for page in group.pages
                ]
                assert shapely.union_all(windows).covers(outline)
            else:
                assert len(group.pages) == 1
        cuts = [shapely.Polygon(piece.cut_line) for piece in group.pieces]
        assert all(not one.intersects(two) for one, two in combinations(cuts, 2))
    assert sorted(found) == ["a", "b", "c", "d", "large"]
    assert any(len(group.pieces) > 1 for group in groups)


def test_rows_and_columns_name_a_page():
    (group,) = on_paper(make_pieces(*strips.rectangle(400.0, 345.0), name="part"))
    names = [group.name_of(*page) for page in group.pages]
    assert names[0] == "row A, column 1"
    assert len(set(names)) == len(names) >= 4


def test_cut_sew_and_fold_lines_have_pens_of_their_own():
    settings = PieceSettings(seam_allowance=(6.0,) * 4, rulings=True)
    piece = make_pieces(*strips.random_strip(2), name="part", settings=settings)
    page = streams(pdf_file(piece).content)[-1]
    dashes = set(re.findall(r"(\[[^\]]*\]) [-\d.]+ d", page))
    assert len(dashes) >= 3
    assert re.search(r"\b1\.2 w\b", page)


def test_bends_have_a_pen_for_each_way_and_stand_for_the_rulings():
    wavy = strips.random_strip(2)
    folds = make_pieces(*wavy, name="part", settings=PieceSettings(rulings=True))
    assert {fold > 0.0 for piece in folds for fold in piece.ruling_fold} == {True, False}
    bends = make_pieces(*wavy, name="part", settings=PieceSettings(rulings=True, bend_table=True))
    patterns = []
    for pieces in (folds, bends):
        page = streams(pdf_file(pieces).content)[-1]
        patterns.append(set(re.findall(r"(\[[^\]]+\])\s[-\d.]+ d", page)))
    assert len(patterns[0]) == len(patterns[1]) == 2
    assert not patterns[0] & patterns[1]


def test_empty_pages_are_left_out():
    # A sickle: the box of its outline has corners without anything on them.
    angle = np.linspace(0.0, np.pi, 200)
    ring = np.column_stack((np.cos(angle), np.sin(angle), 0 * angle))
    made = strips.unrolled(400 * ring, 385 * ring, ("length",))
    pieces = make_pieces(*made, name="s", settings=PieceSettings(rulings=False))
    pdf = pdf_file(pieces)
    assert pdf.page_count < 10


def test_the_same_pieces_give_the_same_bytes():
    pieces = make_pieces(*strips.lens(), name="part", settings=FULL)
    first, second = pdf_file(pieces).content, pdf_file(pieces).content
    assert first == second
    assert b"CreationDate" not in first


def test_no_pieces_and_no_folder_are_refused(tmp_path):
    with pytest.raises(InputError, match="no pieces"):
        pdf_file([])
    with pytest.raises(ExportError, match=r"write PDF a\.pdf"):
        write_pdf(tmp_path / "none" / "a.pdf", make_pieces(*strips.rectangle(), name="part"))
