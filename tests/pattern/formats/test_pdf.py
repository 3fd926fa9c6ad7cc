from __future__ import annotations

import re
import zlib

import numpy as np
import pytest

from tests.pattern import strips
from wrinkle_cad.errors import ExportError, InputError
from wrinkle_cad.pattern.formats.pdf import pdf_file, write_pdf
from wrinkle_cad.pattern.piece.making import make_pieces
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
    assert made.page_count == 3
    assert all(box[0] > box[1] for box in page_boxes(made.content))
    tall = pdf_file(make_pieces(*strips.rectangle(350.0, 345.0), name="part"))
    assert tall.page_count == 4
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
    pages = streams(made.content)
    for number, page in enumerate(pages, start=1):
        assert f"page {number} of 3, column {number}, row 1" in page
        assert "this bar is 50 mm" in page


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
