"""Pieces on sheets: none on another, all inside, the grain kept, and how full the sheets are."""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from tests.seeds import seeds
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.check.judging import judge_dxf
from wrinkle_cad.pattern.formats.dxf import dxf_file, write_dxf
from wrinkle_cad.pattern.piece.compacting import compacted
from wrinkle_cad.pattern.piece.nesting import nested
from wrinkle_cad.pattern.piece.options import PieceSettings

SETTINGS = PieceSettings(seam_allowance=(5.0,) * 4)


def curved_strip(radius, width, length):
    angle = np.linspace(-0.5, 0.5, 25) * length / radius
    ring = np.column_stack((np.sin(angle), np.cos(angle), 0.0 * angle))
    return strips.unrolled(radius * ring, (radius + width) * ring, ("length",))


def strips_and_bands(count):
    random = np.random.default_rng(5)
    pieces = []
    for k in range(count // 2):
        strip = curved_strip(*(random.uniform(*span) for span in ((150, 500), (20, 40), (90, 180))))
        band = strips.lens(random.uniform(90.0, 180.0), random.uniform(10.0, 25.0))
        for made, name in ((strip, "strip"), (band, "band")):
            pieces += make_pieces(*made, name=f"{name} {k}", settings=SETTINGS)
    return pieces


def check_sheets(sheets, pieces, size, gap=1.5):
    for sheet in sheets:
        regions = [shapely.Polygon(piece.cut_line) for piece in sheet.pieces]
        frame = shapely.box(0.0, 0.0, *size)
        assert all(frame.contains(region) for region in regions)
        first, second = shapely.STRtree(regions).query(regions, "dwithin", distance=gap)
        assert np.array_equal(first, second)
        for piece in sheet.pieces:
            x, y = piece.grain_line[1] - piece.grain_line[0]
            assert abs(y) < 1e-9 * abs(x)
        assert not any(piece.is_mirrored for piece in sheet.pieces)
    found = Counter(i for sheet in sheets for i in sheet.index)
    assert found == {i: piece.quantity for i, piece in enumerate(pieces)}


def test_twenty_strips_and_bands_fill_two_thirds_of_what_they_use():
    pieces, size = strips_and_bands(20), (600.0, 300.0)
    began = time.process_time()
    sheets = nested(pieces, sheet=size)
    check_sheets(sheets, pieces, size)
    assert len(sheets) == 1
    # 68% in 2 s.
    assert sheets[0].utilisation >= 0.65
    assert time.process_time() - began < 60.0


def test_a_search_by_the_clock_never_makes_a_sheet_worse():
    pieces, size = strips_and_bands(6), (600.0, 100.0)
    (sheet,) = nested(pieces, sheet=size)
    closer = compacted(sheet, seconds=1)
    check_sheets([closer], pieces, size)
    assert closer.used_length <= sheet.used_length


def test_a_search_by_the_clock_without_its_package_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "spyrrow", None)
    (sheet,) = nested(strips_and_bands(4), sheet=(600.0, 100.0))
    with pytest.raises(InputError, match=r"pip install wrinkle-cad\[nesting\]"):
        compacted(sheet, seconds=1)


@pytest.mark.slow
def test_a_hundred_copies_and_more_come_on_full_sheets():
    pieces, size = [replace(piece, quantity=18) for piece in strips_and_bands(6)], (600.0, 300.0)
    sheets = nested(pieces, sheet=size)
    check_sheets(sheets, pieces, size)
    assert min(sheet.utilisation for sheet in sheets[:-1]) > 0.6


@pytest.mark.parametrize("size", [(123.0, 43.0), (123.0, 5000.0), (50_000.0, 43.0)])
def test_a_piece_that_just_fits_lies_on_the_sheet(size):
    """On the last of these sheets a cell is as wide as thirteen gaps."""
    (piece,) = make_pieces(*strips.rectangle(120.0, 40.0), name="strap")
    pieces = [replace(piece, quantity=3)]
    check_sheets(nested(pieces, sheet=size), pieces, size)


@pytest.mark.parametrize("seed", seeds(40, 1))
def test_random_pieces_on_random_sheets_lie_apart_and_inside(seed):
    random = np.random.default_rng(seed)
    pieces = [
        replace(piece, quantity=int(random.integers(1, 5)))
        for _ in range(int(random.integers(1, 7)))
        for piece in make_pieces(
            *strips.random_strip(int(random.integers(1000))),
            name="s",
            settings=PieceSettings(grain="across" if random.integers(2) else "along"),
        )
    ]
    needed = max(
        float(np.ptp(piece.with_grain_along_x().cut_line, axis=0).max()) for piece in pieces
    )
    size = tuple((needed + 3.0) * random.uniform(1.0, 6.0, 2))
    check_sheets(nested(pieces, sheet=size), pieces, size)


def test_what_one_sheet_cannot_hold_goes_on_the_next_ones():
    (piece,) = make_pieces(*strips.rectangle(120.0, 40.0), name="strap")
    pieces = [replace(piece, quantity=7)]
    sheets = nested(pieces, sheet=(250.0, 100.0))
    # Two beside each other in two rows on each.
    assert [len(sheet.pieces) for sheet in sheets] == [4, 3]
    check_sheets(sheets, pieces, (250.0, 100.0))


def test_the_grain_decides_how_a_piece_lies():
    settings = PieceSettings(grain="across")
    pieces = make_pieces(*strips.rectangle(120.0, 40.0), name="strap", settings=settings)
    (sheet,) = nested(pieces, sheet=(200.0, 200.0))
    assert np.ptp(sheet.pieces[0].cut_line, axis=0) == pytest.approx((40.0, 120.0))


def test_more_pieces_than_can_be_nested_in_time_are_refused_at_once():
    (piece,) = make_pieces(*strips.rectangle(120.0, 40.0), name="strap")
    with pytest.raises(InputError, match="1,000,000 pieces are to be nested"):
        nested([replace(piece, quantity=1_000_000)], sheet=(300.0, 100.0))


def test_a_piece_larger_than_the_sheet_is_refused():
    pieces = make_pieces(*strips.rectangle(120.0, 40.0), name="strap")
    with pytest.raises(InputError, match=r"strap is 120\.0 x 40\.0 mm"):
        nested(pieces, sheet=(100.0, 100.0))


def test_without_a_search_the_layout_is_the_same_every_time():
    pieces = strips_and_bands(6)
    one, other = (nested(pieces, sheet=(400.0, 200.0)) for _ in range(2))
    assert compacted(one[0], seconds=0) is one[0]
    for first, second in zip(one[0].pieces, other[0].pieces, strict=True):
        assert np.array_equal(first.cut_line, second.cut_line)


def test_a_sheets_file_has_the_pieces_where_they_lie(tmp_path):
    pieces = strips_and_bands(6)
    (sheet,) = nested(pieces, sheet=(400.0, 300.0))
    path = tmp_path / "sheet.dxf"
    write_dxf(path, sheet.pieces, sheet=(400.0, 300.0))
    assert judge_dxf(path).is_clean
    space = ezdxf.readfile(path).modelspace()
    for contour, piece in zip(space.query("*[layer=='CUT']"), sheet.pieces, strict=True):
        assert np.allclose(np.array(contour.get_points("xy")), piece.cut_line, atol=2e-6)
    with pytest.raises(InputError, match="Choose the profile cutter"):
        dxf_file(sheet.pieces, profile="aama", sheet=(400.0, 300.0))
