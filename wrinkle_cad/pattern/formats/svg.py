"""Pattern pieces as SVG, 1:1 in millimetres, one group per layer, with a scale bar.

Texts keep their letters (SVG is UTF-8); what XML does not allow is left out, everything else is
escaped. y runs down in SVG, so the drawing is turned over once, here, and nowhere mirrored.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from ezdxf.colors import aci2rgb

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding, InputError
from wrinkle_cad.files.atomic import write_export
from wrinkle_cad.files.names import one_line
from wrinkle_cad.pattern.piece.piece import Floats, PatternPiece
from wrinkle_cad.pattern.piece.stacking import laid_out

from .drawing import Label, Spot, Stroke, draw, text_box
from .layers import LINE_TYPES, LayerStyle, Profile, profile_from
from .pens import pen_of
from .plain_text import text_changed

_MARGIN: Final = 10.0
"""mm around everything."""
_BAR: Final = settings.TEST_SQUARE
_LINE_WIDTH: Final = 0.25


def svg_bytes(
    pieces: Sequence[PatternPiece], *, profile: str | Path | Profile = settings.DXF_PROFILE
) -> bytes:
    """Returns an SVG file of all pieces, laid out as in the DXF, in UTF-8.

    Args:
        pieces: at least one.
        profile: whose layers and colors are used; block profiles are drawn as plain lines.

    Raises:
        InputError: no pieces, or an unknown profile.
    """
    if not pieces:
        raise InputError("There are no pieces to write as SVG. Make a pattern first.")
    chosen = profile if isinstance(profile, Profile) else profile_from(profile)
    placed = laid_out(pieces, reach=text_box)
    corners = np.vstack([piece.cut_line for piece in placed])
    corners = np.vstack((corners, *(text_box(piece) for piece in placed)))
    low, high = corners.min(axis=0), corners.max(axis=0)
    high[0] = max(high[0], low[0] + _BAR)
    low[1] -= 2.0 * _MARGIN
    left, top = low[0] - _MARGIN, high[1] + _MARGIN
    width, height = high - low + 2.0 * _MARGIN
    body = [*_layers(placed, chosen, left, top), *_scale_bar(low - (left, top), _MARGIN)]
    head = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_number(width)}mm" '
        f'height="{_number(height)}mm" viewBox="0 0 {_number(width)} {_number(height)}">\n'
        f"<title>{_escaped(', '.join(piece.name for piece in placed))}</title>\n"
    )
    return (head + "\n".join(body) + "\n</svg>\n").encode("utf-8")


def drawing_of(pieces: Sequence[PatternPiece]) -> str:
    """Returns all pieces as an ``<svg>`` element to stand inside HTML.

    Args:
        pieces: at least one.
    """
    return svg_bytes(pieces).decode("utf-8").partition("?>")[2]


def write_svg(
    path: Path,
    pieces: Sequence[PatternPiece],
    *,
    profile: str | Path | Profile = settings.DXF_PROFILE,
) -> tuple[Finding, ...]:
    """Writes an SVG file, whole or not at all, and returns which texts had to be changed.

    The other arguments are those of ``svg_bytes``.

    Raises:
        InputError: as ``svg_bytes``.
        ExportError: the file cannot be written.
    """
    content = svg_bytes(pieces, profile=profile)
    write_export(path, "SVG", content)
    texts = [text for piece in pieces for text in piece.texts]
    return tuple(
        finding for text in texts for finding in text_changed("text in the SVG", text, _plain(text))
    )


def color_of(style: LayerStyle) -> str:
    """Returns a style's color as ``#rrggbb``; white on black is black on white here."""
    if style.color == 7:
        return "#000000"
    red, green, blue = aci2rgb(style.color)
    return f"#{red:02x}{green:02x}{blue:02x}"


def _layers(pieces: Sequence[PatternPiece], profile: Profile, left: float, top: float) -> list[str]:
    groups: dict[str, list[str]] = {}
    for piece in pieces:
        drawing = draw(piece)
        items: tuple[Stroke | Spot | Label, ...]
        items = (*drawing.strokes, *drawing.spots, *drawing.labels)
        for item in items:
            style = profile.styles.get(item.role)
            if style is not None:
                groups.setdefault(style.layer, []).append(_element(item, style, left, top))
    lines = []
    for layer, elements in groups.items():
        lines.append(f'<g id={quoteattr("layer-" + layer)} fill="none">')
        lines += elements
        lines.append("</g>")
    return lines


def _element(item: Stroke | Spot | Label, style: LayerStyle, left: float, top: float) -> str:
    color = color_of(style)
    if isinstance(item, Label):
        x, y = item.position[0] - left, top - item.position[1]
        # Letters are 0.73 of the font size high.
        turn = f"rotate({_number(-np.degrees(item.angle))} {_number(x)} {_number(y)})"
        turned = f' transform="{turn}"' if item.angle else ""
        return (
            f'<text x="{_number(x)}" y="{_number(y)}"{turned} '
            f'font-size="{_number(item.height / 0.73)}" '
            f'font-family="sans-serif" fill="{color}">{_escaped(item.text)}</text>'
        )
    pen = f'stroke="{color}" stroke-width="{_LINE_WIDTH}"'
    if isinstance(item, Spot):
        x, y = item.position[0] - left, top - item.position[1]
        return f'<circle cx="{_number(x)}" cy="{_number(y)}" r="0.5" {pen}/>'
    dashes = LINE_TYPES[style.line_type][1][1:] or pen_of(item.role).dashes
    if dashes:
        pattern = " ".join(_number(abs(dash) or _LINE_WIDTH) for dash in dashes)
        pen += f' stroke-dasharray="{pattern}"'
    shifted = np.column_stack((item.points[:, 0] - left, top - item.points[:, 1]))
    tag = "polygon" if item.is_closed else "polyline"
    return f'<{tag} points="{_points(shifted)}" {pen}/>'


def _scale_bar(corner: Floats, margin: float) -> list[str]:
    """Returns a bar of 100 mm with ticks every 10, its left end below ``corner``."""
    x, y = corner[0], -corner[1] + 0.5 * margin
    ticks = [
        f"M{_number(x + 10.0 * i)} {_number(y)}v{-4 if i in (0, 5, 10) else -2}" for i in range(11)
    ]
    return [
        '<g id="scale-bar" fill="none" stroke="#000000" stroke-width="0.25">',
        f'<path d="M{_number(x)} {_number(y)}h{_number(_BAR)}{"".join(ticks)}"/>',
        f'<text x="{_number(x + _BAR + 2.0)}" y="{_number(y)}" font-size="4" stroke="none" '
        f'fill="#000000" font-family="sans-serif">{_BAR:g} mm</text>',
        "</g>",
    ]


def _points(points: Floats) -> str:
    return " ".join(f"{_number(x)},{_number(y)}" for x, y in points)


def _number(value: float) -> str:
    return f"{value + 0.0:.{settings.DXF_DECIMALS}f}".rstrip("0").rstrip(".")


def _escaped(text: str) -> str:
    return escape(_plain(text))


def _plain(text: str) -> str:
    """Returns a text on one line; what is left of it XML allows."""
    return " ".join(one_line(text).split())
