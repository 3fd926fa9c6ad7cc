"""What a notebook shows of a result: a few figures and a drawing, as a piece of HTML."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape


def figures_with_drawing(title: str, figures: Mapping[str, str], drawing: str) -> str:
    """Returns a table of figures beside a drawing.

    Args:
        title: of both; any text.
        figures: what is measured and its value with the unit; any texts.
        drawing: an ``<svg>`` element.

    Example:
        >>> figures_with_drawing("tent", {"area": "3000.00 mm2"}, "<svg></svg>").count("<td>")
        2
    """
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{escape(value)}</td></tr>"
        for name, value in figures.items()
    )
    table = f"<table><caption>{escape(title)}</caption>{rows}</table>"
    return f"<div>{table if figures else ''}{drawing}</div>"
