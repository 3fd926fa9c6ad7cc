"""The validity matrix as pictures small enough for a page, from 20 x 20 to 5,000 x 5,000 bridges.

Two levels. The *overview* has at most ``MATRIX_OVERVIEW`` pixels on a side: each pixel stands for a
square block of bridges and its opacity for the share that is valid. A block that holds both kinds
never looks like one that holds a single kind, and a single valid bridge is seen. The *tiles* show
single bridges and are decoded by the page when it is zoomed in; a tile of one kind is a number, not
a picture. Where all tiles together would be too heavy, only those that the path crosses are kept.

Row 0 of a picture is the last bridge of P: P runs upwards and Q to the right, as in the paper.
"""

from __future__ import annotations

import base64
import io
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings

_VALID_COLOR: Final = (0x2F, 0x7F, 0xC4)
_SHADES: Final = 16
_MIXED_SHADES: Final = (6, 12)


def matrix_pictures(valid: NDArray[np.bool_], bridges: NDArray[np.int64]) -> dict[str, Any]:
    """Draws a validity matrix at both levels.

    Args:
        valid: (m, n) bool; the locally convex bridges.
        bridges: (k, 2) int; the chosen path, whose tiles are always kept.

    Returns:
        ``block`` (bridges per side of an overview pixel), ``overview`` (a PNG, base64) and
        ``tiles``: ``side`` (bridges), ``columns`` and ``images``, row by row from the first bridge
        of P and Q: a PNG, 1 (all valid), 0 (none valid) or null (left out).
    """
    block = -(-max(valid.shape) // settings.MATRIX_OVERVIEW)
    overview = _picture(_shades(valid, block), bits=4)
    tiles: dict[str, Any] | None = None
    if block > 1:
        tiles = _tiles(valid, bridges)
    return {"block": block, "overview": overview, "tiles": tiles}


def _shades(valid: NDArray[np.bool_], block: int) -> NDArray[np.uint8]:
    """(rows, columns) uint8 in 0.._SHADES-1; 0 and the last only for blocks of one kind."""
    m, n = valid.shape
    rows = np.arange(0, m, block)
    columns = np.arange(0, n, block)
    count = np.add.reduceat(valid, rows, axis=0, dtype=np.int32)
    count = np.add.reduceat(count, columns, axis=1)
    size = np.outer(np.diff(rows, append=m), np.diff(columns, append=n))
    share = count / size
    low, high = _MIXED_SHADES
    mixed = np.rint(low + share * (high - low))
    shade = np.where((count > 0) & (count < size), mixed, share * (_SHADES - 1))
    shades: NDArray[np.uint8] = shade.astype(np.uint8)
    return shades


def _tiles(valid: NDArray[np.bool_], bridges: NDArray[np.int64]) -> dict[str, Any]:
    side = settings.MATRIX_TILE
    m, n = valid.shape
    columns = -(-n // side)
    crossed = {(int(i) // side, int(j) // side) for i, j in bridges}
    images: list[str | int | None] = []
    for row in range(-(-m // side)):
        for column in range(columns):
            part = valid[row * side : (row + 1) * side, column * side : (column + 1) * side]
            images.append(_tile(part))
    if sum(len(image) for image in images if isinstance(image, str)) > settings.MATRIX_TILE_BYTES:
        images = [
            None if isinstance(image, str) and divmod(at, columns) not in crossed else image
            for at, image in enumerate(images)
        ]
    return {"side": side, "columns": columns, "images": images}


def _tile(part: NDArray[np.bool_]) -> str | int:
    if part.all():
        return 1
    if not part.any():
        return 0
    return _picture(part.astype(np.uint8) * (_SHADES - 1), bits=1)


def _picture(shades: NDArray[np.uint8], *, bits: int) -> str:
    """A palette PNG, base64: one color whose opacity is the shade, so that it suits any theme."""
    from PIL import Image

    top = _SHADES - 1
    if bits == 1:
        shades, opacities = (shades > 0).astype(np.uint8), bytes((0, 255))
    else:
        opacities = bytes(round(255 * shade / top) for shade in range(_SHADES))
    rows, columns = shades.shape
    image = Image.frombytes("P", (columns, rows), np.ascontiguousarray(shades[::-1]).tobytes())
    image.putpalette(list(_VALID_COLOR) * len(opacities))
    file = io.BytesIO()
    image.save(file, format="PNG", bits=bits, transparency=opacities, optimize=False)
    return base64.b64encode(file.getvalue()).decode("ascii")
