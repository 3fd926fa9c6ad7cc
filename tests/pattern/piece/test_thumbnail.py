"""A piece's outline with few points."""

from __future__ import annotations

import numpy as np
import pytest
from shapely.geometry import Polygon

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from wrinkle_cad.pattern.piece.options import PieceSettings
from wrinkle_cad.pattern.piece.thumbnail import MOST_POINTS, thumbnail


@pytest.mark.parametrize("seed", range(8))
def test_a_small_picture_of_a_piece_is_as_the_piece(seed: int) -> None:
    settings = PieceSettings(seam_allowance=(4.0,) * 4)
    (piece, *_) = make_pieces(*strips.random_strip(seed), name="piece", settings=settings)
    points = np.array(thumbnail(piece))
    assert 3 <= len(points) <= MOST_POINTS
    assert points.min() == 0.0
    whole = np.asarray(piece.cut_line) - np.asarray(piece.cut_line).min(axis=0)
    size = np.ptp(whole, axis=0).max()
    apart = Polygon(points).symmetric_difference(Polygon(whole)).area
    assert apart < 0.012 * size * Polygon(whole).length
