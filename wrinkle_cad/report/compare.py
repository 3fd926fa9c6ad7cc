"""The methods of the paper on one strip, side by side (Wang and Tang, section 7)."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from wrinkle_cad import settings
from wrinkle_cad.strip.triangulation import Triangulation, triangulate

from .markup import Element, node
from .numbers import Numbers
from .page import page_of
from .table import cell, table

METHODS: Final[tuple[tuple[str, settings.Search, tuple[settings.Criterion, ...], str], ...]] = (
    ("LODT+LMBT", "local", ("invalid", "bending"), "most valid bridges, looking one step ahead"),
    ("GODT+GMBT", "global", ("invalid", "bending"), "most valid bridges, then least bending"),
    ("LMBT", "local", ("bending",), "least bending, looking one step ahead"),
    ("GMBT", "global", ("bending",), "least bending of all"),
    ("GMAT", "global", ("area",), "least area of all"),
)
"""Name as in the paper, search, criteria and meaning."""


_FIGURES: Final[tuple[tuple[str, str, str, int | None], ...]] = (
    ("Valid bridges", "valid_bridges", "", None),
    ("of", "bridges", "", None),
    ("Bending energy", "bending", "", None),
    ("Area", "area_mm2", "mm²", 2),
    ("Largest fold", "max_fold_deg", "°", 2),
    ("Time", "seconds", "s", 4),
)
_COLUMNS: Final = (
    ("Method", False),
    ("Looks for", False),
    *((title, True) for title, *_ in _FIGURES),
)
_BEST: Final[tuple[tuple[str, Callable[..., Any]], ...]] = (
    ("valid_bridges", max),
    ("bending", min),
    ("area_mm2", min),
    ("max_fold_deg", min),
)


@dataclass(frozen=True, slots=True)
class Comparison:
    """What one method makes of a strip.

    Example:
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> best = compare(p, q)[1]
        >>> best.valid_bridges, best.bridges
        (3, 3)
    """

    method: str
    """The paper's name of it."""
    meaning: str
    """What it looks for."""
    bridges: int
    """Interior bridges."""
    valid_bridges: int
    """Interior bridges that are locally convex."""
    bending: float
    """Bending energy."""
    area_mm2: float
    """Area."""
    max_fold_deg: float
    """Largest fold angle."""
    seconds: float
    """Wall-clock time of the search."""

    def as_json(self) -> dict[str, Any]:
        """The row as plain values."""
        return asdict(self)


def compare(
    p: ArrayLike,
    q: ArrayLike,
    *,
    energy: settings.Energy = settings.ENERGY,
    planarity: float | None = None,
) -> tuple[Comparison, ...]:
    """Runs every method of the paper on the same samples; validity has no price there.

    Args:
        p: (m, 3) float, mm; samples of directrix P.
        q: (n, 3) float, mm; samples of directrix Q in the same direction.
        energy: ``hinge`` or ``paper``.
        planarity: mm; slack of the convexity test; derived from the samples when None.

    Returns:
        One row for each of ``METHODS``. Times are those of a second run, when all is compiled.

    Raises:
        InputError: a rail or an option cannot be used.

    Example:
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> [row.method for row in compare(p, q)]
        ['LODT+LMBT', 'GODT+GMBT', 'LMBT', 'GMBT', 'GMAT']
    """
    return tuple(
        _row(name, meaning, *_timed(p, q, search, criteria, energy, planarity))
        for name, search, criteria, meaning in METHODS
    )


def _timed(
    p: ArrayLike,
    q: ArrayLike,
    search: settings.Search,
    criteria: tuple[settings.Criterion, ...],
    energy: settings.Energy,
    planarity: float | None,
) -> tuple[Triangulation, float]:
    def run() -> Triangulation:
        return triangulate(
            p, q, criteria=criteria, search=search, energy=energy, planarity=planarity, price=None
        )

    run()
    start = time.perf_counter()
    return run(), time.perf_counter() - start


def _row(name: str, meaning: str, strip: Triangulation, seconds: float) -> Comparison:
    return Comparison(
        method=name,
        meaning=meaning,
        bridges=strip.interior_count,
        valid_bridges=strip.interior_count - strip.invalid_count,
        bending=strip.bending,
        area_mm2=strip.area,
        max_fold_deg=math.degrees(float(np.abs(strip.fold).max(initial=0.0))),
        seconds=seconds,
    )


def comparison_summary(
    rows_by_strip: Mapping[str, Sequence[Comparison]], *, file: str
) -> dict[str, Any]:
    """The comparison as plain values for a JSON file.

    Args:
        rows_by_strip: rows by the name of the strip.
        file: name of the input.
    """
    return {
        "schema": "wrinkle_cad/comparison",
        "schema_version": 1,
        "input": {"file": file},
        "strips": [
            {"name": name, "methods": [row.as_json() for row in rows]}
            for name, rows in rows_by_strip.items()
        ],
    }


def write_comparison_page(summary: Mapping[str, Any]) -> str:
    """Writes the page of a comparison.

    Args:
        summary: as ``comparison_summary`` gives it.

    Returns:
        The whole page; it needs no scripts.
    """
    numbers = Numbers(summary)
    file = str(summary["input"]["file"])
    main = node(
        "main",
        node("header", node("p", "Methods compared", class_="eyebrow"), node("h1", file)),
        *(_strip_card(numbers, at) for at in range(len(summary["strips"]))),
    )
    return page_of(file, main, [])


def _strip_card(numbers: Numbers, at: int) -> Element:
    strip = numbers.get(f"/strips/{at}")
    best = {key: pick(row[key] for row in strip["methods"]) for key, pick in _BEST}
    rows = [
        node(
            "tr",
            cell(method["method"], kind="word"),
            cell(method["meaning"], kind="text"),
            *_figure_cells(numbers, f"/strips/{at}/methods/{number}", best),
        )
        for number, method in enumerate(strip["methods"])
    ]
    note = (
        "Methods of Wang and Tang, Developable Triangulations of a Strip; the best of each column"
        " is bold. Bending energies compare only within one strip and one kind of energy."
    )
    return node(
        "section",
        node("h2", strip["name"], class_="head"),
        table(_COLUMNS, rows),
        node("p", note, class_="note"),
        class_="card",
    )


def _figure_cells(numbers: Numbers, row: str, best: Mapping[str, float]) -> list[Element]:
    cells = []
    for _, key, unit, digits in _FIGURES:
        shown = numbers.show(f"{row}/{key}", unit, digits)
        is_best = key in best and numbers.get(f"{row}/{key}") == best[key]
        cells.append(cell(node("b", shown) if is_best else shown, right=True))
    return cells
