"""Where a strip asks something of a sheet, and what was tried there: tables of the page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from .markup import Child, Element, node
from .numbers import Numbers
from .table import card, cell, strip_name, table

Row = Callable[[Numbers, int, int, Mapping[str, Any]], Element]
"""Makes a row of a table: of which strip, which of its items, and the item."""


def _card(
    numbers: Numbers,
    key: str,
    title: str,
    columns: Sequence[tuple[str, bool]],
    row: Row,
    note: str,
    *,
    is_printed: bool = True,
    is_clickable: bool = True,
) -> Element | None:
    """A card with a row for each item under a key of each strip; None without any."""
    rows = [
        row(numbers, at, number, item)
        for at, entry in enumerate(numbers.get("/strips"))
        for number, item in enumerate(entry[key])
    ]
    if not rows:
        return None
    hint = node("span", " Click a row to see its middle.", class_="screen-only")
    shown = table(columns, rows), node("p", note, hint if is_clickable else None, class_="note")
    return card(title, *shown, is_printed=is_printed)


def gaps_card(numbers: Numbers) -> Element | None:
    """Where a flat sheet must give, and which rail to turn; None without gaps."""
    columns = (
        ("Strip", False),
        ("Along P", True),
        ("Along Q", True),
        ("Strain", True),
        ("Twist", True),
        ("What to do", False),
    )
    note = (
        "Stretches whose rulings twist: no developable surface lies there. Twist is positive if"
        " clockwise as seen from P to Q."
    )
    return _card(numbers, "gaps", "Where a sheet must give", columns, _gap_row, note)


def _gap_row(numbers: Numbers, at: int, number: int, gap: Mapping[str, Any]) -> Element:
    path = f"/strips/{at}/gaps/{number}"
    return node(
        "tr",
        cell(strip_name(numbers, at), kind="name"),
        *(
            cell(
                numbers.show(f"{path}/{rail}_from_mm", "", 1),
                " to ",
                numbers.show(f"{path}/{rail}_to_mm", "mm", 1),
                right=True,
            )
            for rail in "pq"
        ),
        cell(numbers.show(f"{path}/max_strain_percent", "%", 3), right=True),
        cell(numbers.show(f"{path}/twist_deg", "°", 2), right=True),
        cell(gap["advice"], kind="text"),
        **_bridges(at, gap),
    )


def trials_card(numbers: Numbers) -> Element | None:
    """What was tried on strips that want help; None where nothing was."""
    columns = (
        ("Strip", False),
        ("Tried", False),
        ("State", False),
        ("Strain", True),
        ("Crease", True),
        ("Bend radius", True),
        ("Twist", True),
        ("Piece longer", True),
    )
    note = (
        "Each change by itself, on this file; every other setting as it is. Piece longer: along the"
        " rulings of the surface that is judged."
    )
    return _card(numbers, "trials", "What was tried", columns, _trial_row, note, is_clickable=False)


def _trial_row(numbers: Numbers, at: int, number: int, trial: Mapping[str, Any]) -> Element:
    path = f"/strips/{at}/trials/{number}"
    name, change = cell(strip_name(numbers, at), kind="name"), cell(trial["change"], kind="word")
    if "failed" in trial:
        failed = node("td", trial["failed"], colspan="6", class_="text")
        return node("tr", name, change, failed)
    words = {True: "PASS, ", False: "FAIL, ", None: ""}[trial["passed"]] + trial["state"]
    return node(
        "tr",
        name,
        change,
        cell(words, kind="word"),
        cell(numbers.show(f"{path}/max_strain_percent", "%", 3), right=True),
        cell(numbers.show(f"{path}/max_crease_deg", "°", 1), right=True),
        cell(numbers.show(f"{path}/inner_bend_radius_mm", "mm", 2), right=True),
        cell(numbers.show(f"{path}/max_twist_deg", "°", 2), right=True),
        cell(numbers.show(f"{path}/cut_longer_percent", "%", 1), right=True),
    )


def runs_card(numbers: Numbers) -> Element | None:
    """Runs of bridges that are not locally convex: figures of the search; None without any."""
    columns = (
        ("Strip", False),
        ("Kind", False),
        ("Bridges", True),
        ("Along P", True),
        ("Along Q", True),
        ("Angle defect", True),
        ("Twist", True),
    )
    note = (
        "Runs of bridges at which the triangles are not those of a developable surface: figures of"
        " the search, which change with the tolerance."
    )
    title = "Bridges that are not locally convex"
    return _card(numbers, "invalid_runs", title, columns, _run_row, note, is_printed=False)


def _run_row(numbers: Numbers, at: int, number: int, run: Mapping[str, Any]) -> Element:
    path = f"/strips/{at}/invalid_runs/{number}"
    span: list[Child] = [numbers.show(f"{path}/first_bridge")]
    if run["last_bridge"] != run["first_bridge"]:
        span += [" to ", numbers.show(f"{path}/last_bridge")]
    return node(
        "tr",
        cell(strip_name(numbers, at), kind="name"),
        cell(run["kind"], kind="word"),
        cell(*span, right=True),
        cell(numbers.show(f"{path}/p_length_mm", "mm", 2), right=True),
        cell(numbers.show(f"{path}/q_length_mm", "mm", 2), right=True),
        cell(numbers.show(f"{path}/angle_defect_deg", "°", 2), right=True),
        cell(numbers.show(f"{path}/twist_deg", "°", 2), right=True),
        **_bridges(at, run),
    )


def _bridges(at: int, stretch: Mapping[str, Any]) -> dict[str, str]:
    """What a click on a row shows."""
    return {
        "data_gap_strip": str(at),
        "data_first": str(stretch["first_bridge"]),
        "data_last": str(stretch["last_bridge"]),
    }
