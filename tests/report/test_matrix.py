"""The pictures of a validity matrix tell the truth about it at both levels."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from wrinkle_cad import settings
from wrinkle_cad.report.matrix import matrix_pictures

Bools = NDArray[np.bool_]


def opacity(picture: str) -> NDArray[np.uint8]:
    """(rows, columns) of a picture, its first row at the bottom as in the matrix."""
    image = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGBA")
    return np.asarray(image)[::-1, :, 3]


def random_matrix(m: int, n: int, share: float = 0.5, seed: int = 7) -> Bools:
    return np.random.default_rng(seed).random((m, n)) < share


def diagonal(m: int, n: int) -> NDArray[np.int64]:
    at = np.linspace(0.0, 1.0, m + n - 1)
    return np.column_stack((at * (m - 1), at * (n - 1))).astype(np.int64)


@pytest.mark.parametrize(("m", "n"), [(20, 20), (2, 300), (640, 33), (1, 1)])
def test_a_small_matrix_is_shown_bridge_by_bridge(m: int, n: int) -> None:
    valid = random_matrix(m, n)
    pictures = matrix_pictures(valid, diagonal(m, n))
    assert pictures["block"] == 1
    assert pictures["tiles"] is None
    assert np.array_equal(opacity(pictures["overview"]), np.where(valid, 255, 0))


def blocks(valid: Bools, block: int) -> list[list[Bools]]:
    m, n = valid.shape
    return [
        [valid[i : i + block, j : j + block] for j in range(0, n, block)]
        for i in range(0, m, block)
    ]


@pytest.mark.parametrize("share", [0.001, 0.5, 0.999])
def test_a_pixel_of_the_overview_never_hides_a_bridge(share: float) -> None:
    valid = random_matrix(1500, 1333, share)
    pictures = matrix_pictures(valid, diagonal(1500, 1333))
    shades = opacity(pictures["overview"])
    assert max(shades.shape) <= settings.MATRIX_OVERVIEW
    cut = blocks(valid, pictures["block"])
    assert shades.shape == (len(cut), len(cut[0]))
    for row, shade_row in zip(cut, shades, strict=True):
        for part, shade in zip(row, shade_row, strict=True):
            if part.all():
                assert shade == 255
            elif not part.any():
                assert shade == 0
            else:
                assert 80 < shade < 220


def test_more_valid_bridges_make_a_darker_pixel() -> None:
    valid = np.zeros((1280, 1280), dtype=bool)
    for column in range(5):
        valid[: 2 * column, 2 * column : 2 * column + 2] = True
    shades = opacity(matrix_pictures(valid, diagonal(1280, 1280))["overview"])
    assert shades[0, 0] == 0
    assert list(shades[0, 1:5]) == [255] * 4
    valid[0, 2] = False
    assert opacity(matrix_pictures(valid, diagonal(1280, 1280))["overview"])[0, 1] < 255


def reassembled(pictures: dict[str, object], shape: tuple[int, int]) -> tuple[Bools, Bools]:
    """The matrix that the tiles show, and where they show it."""
    tiles = pictures["tiles"]
    assert isinstance(tiles, dict)
    side, columns = tiles["side"], tiles["columns"]
    shown, known = np.zeros(shape, bool), np.zeros(shape, bool)
    for at, image in enumerate(tiles["images"]):
        i, j = (part * side for part in divmod(at, columns))
        here = np.s_[i : i + side, j : j + side]
        if image is None:
            continue
        known[here] = True
        shown[here] = bool(image) if isinstance(image, int) else opacity(image) > 127
    return shown, known


def test_the_tiles_hold_every_bridge() -> None:
    valid = random_matrix(1203, 740)
    valid[:500, :500] = True
    valid[500:1000, :500] = False
    pictures = matrix_pictures(valid, diagonal(1203, 740))
    assert pictures["tiles"]["images"][0] == 1
    assert pictures["tiles"]["images"][2] == 0
    shown, known = reassembled(pictures, valid.shape)
    assert known.all()
    assert np.array_equal(shown, valid)


def test_where_tiles_are_too_heavy_those_at_the_path_stay() -> None:
    valid = random_matrix(5000, 5000)
    bridges = diagonal(5000, 5000)
    pictures = matrix_pictures(valid, bridges)
    shown, known = reassembled(pictures, valid.shape)
    assert not known.all()
    assert known[bridges[:, 0], bridges[:, 1]].all()
    assert np.array_equal(shown[known], valid[known])
    kept = sum(len(image) for image in pictures["tiles"]["images"] if isinstance(image, str))
    assert kept < 2 * settings.MATRIX_TILE_BYTES
