"""The parts of the page that hold words and numbers, all of them from the JSON."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from .help_tables import gaps_card, runs_card, trials_card
from .markup import Element, node
from .numbers import TIMES, Numbers
from .table import card, cell, print_note, strip_name, table

_SIGN: Final = {
    "developable": "\N{CHECK MARK}",
    "stretched": "~",
    "creased": "!",
    "folded": "!",
    "passed": "\N{CHECK MARK}",
    "failed": "!",
    "unsure": "?",
}
_PASSED: Final = {True: ("PASS", "pass"), False: ("FAIL", "fail")}
_STITCH_ROWS: Final = (
    ("Free edges before", "free_edges_before", ""),
    ("Free edges after", "free_edges_after", ""),
    ("Largest edge tolerance", "max_edge_tolerance_mm", "mm"),
    ("Faces", "faces", ""),
    ("Area", "area_mm2", "mm²"),
    ("Area balance", "area_balance_mm2", "mm²"),
)


def verdict_panel(numbers: Numbers) -> Element:
    """The verdict at the top of the page."""
    said: Mapping[str, Any] = numbers.get("/verdict")
    panel = node(
        "section",
        node("div", _SIGN[_tone(said)], class_="sign", aria_hidden="true"),
        node("p", _headline(said), class_="headline"),
        node("p", said["meaning"], class_="meaning"),
        _limits(said),
        class_=f"card verdict {_tone(said)}",
    )
    leading = [strip for strip in said["strips"] if strip["role"] != "band"]
    if len(leading) > 1:
        lines = [
            node("li", strip["name"], ": ", strip["sentence"])
            for strip in leading
            if strip["state"] != "developable"
        ]
        panel.append(node("ul", *lines, class_="missed"))
    if said["bands"]:
        panel.append(node("p", said["bands"], class_="bands note"))
    return panel


def _headline(said: Mapping[str, Any]) -> str:
    """The verdict's; of a single strip without limits the state only: its figures stand below."""
    leading = [strip for strip in said["strips"] if strip["role"] != "band"] or said["strips"]
    headline = str(said["headline"])
    if said["passed"] is None and len(leading) == 1:
        return headline.split(". ")[0].removesuffix(".") + "."
    return headline


def _tone(said: Mapping[str, Any]) -> str:
    """The panel's color: by the limits, or by the state where none are given."""
    passed = said["passed"]
    tone = str(said["state"]) if passed is None else "passed" if passed else "failed"
    return "unsure" if said["piece_differs"] and tone in ("developable", "passed") else tone


def _limits(said: Mapping[str, Any]) -> Element:
    if said["passed"] is None:
        return node(
            "div", "No limits were given, so nothing is passed or refused.", class_="limits note"
        )
    word, kind = _PASSED[bool(said["passed"])]
    box = node(
        "div",
        node("span", word, class_=f"badge {kind}"),
        "Limits: " + "; ".join(said["limits"]) + ".",
        class_="limits",
    )
    if said["reasons"]:
        box = node(
            "div", box, node("ul", *(node("li", line) for line in said["reasons"]), class_="missed")
        )
    return box


def tables_panel(numbers: Numbers) -> list[Element]:
    """All tables below the pictures, in their order; those without content are left out."""
    small = [
        _seams_card(numbers),
        _stitch_card(numbers),
        _angles_card(numbers),
        _pairs_card(numbers, "Versions", "/versions"),
        _pairs_card(numbers, "Seconds", "/seconds", unit="s", digits=3),
    ]
    return [
        shown
        for shown in (
            gaps_card(numbers),
            trials_card(numbers),
            _findings_card(numbers),
            _taken_card(numbers),
            _strips_card(numbers),
            runs_card(numbers),
            node("div", *(each for each in small if each is not None), class_="tables"),
            _pairs_card(numbers, "Settings", "/settings"),
        )
        if shown is not None
    ]


def _taken_card(numbers: Numbers) -> Element | None:
    """What the file's shapes were taken as, and why."""
    reasons = numbers.get("/input/reasons")
    if not reasons:
        return None
    lines = node("ul", *(node("li", line) for line in reasons))
    return card("Taken from the file", lines, is_printed=False)


def _strips_card(numbers: Numbers) -> Element:
    columns = (
        ("Strip", False),
        ("Samples P", True),
        ("Samples Q", True),
        ("Bridges", True),
        ("Invalid", True),
        ("of them inflections", True),
        ("Largest fold", True),
        ("Largest twist", True),
        ("Bending", True),
        ("Least bending", True),
        ("Price", True),
        ("Piece longer", True),
    )
    rows = []
    for at in range(len(numbers.get("/strips"))):
        entry = f"/strips/{at}"
        shown = [
            *(numbers.show(f"{entry}/{key}") for key in ("samples_p", "samples_q")),
            *(
                numbers.show(f"{entry}/{key}_bridges")
                for key in ("interior", "invalid", "inflection")
            ),
            *(numbers.show(f"{entry}/max_{key}_deg", "°", 2) for key in ("fold", "twist")),
            *(numbers.show(f"{entry}/{key}") for key in ("bending", "least_bending")),
            numbers.show(f"/verdict/strips/{at}/price_of_developability", TIMES, 2),
            numbers.show(f"{entry}/cut/longer_percent", "%", 1),
        ]
        name = cell(strip_name(numbers, at), kind="name")
        rows.append(node("tr", name, *(cell(figure, right=True) for figure in shown)))
    note = (
        "Price: bending energy of the strip over that of the one that bends least. Far above 1,"
        " its bridges were made locally convex with folds. Piece longer: how much longer the piece"
        " that is cut is at most along the rulings of the surface that is judged."
    )
    return card("Strips", table(columns, rows), node("p", note, class_="note"))


def _seams_card(numbers: Numbers) -> Element:
    columns = (("", False), ("In space", True), ("Flat", True), ("Difference", True))
    rows = []
    for at in range(len(numbers.get("/strips"))):
        entry = f"/strips/{at}"
        for key, title in (("p", "seam P"), ("q", "seam Q")):
            seam = f"{entry}/seam_lengths_mm/{key}"
            difference = f"/verdict/strips/{at}/seam_difference_{key}_mm"
            rows.append(
                node(
                    "tr",
                    cell(f"{strip_name(numbers, at)}, {title}", kind="name"),
                    cell(numbers.show(f"{seam}/space", "mm", 3), right=True),
                    cell(numbers.show(f"{seam}/pattern", "mm", 3), right=True),
                    cell(numbers.show(difference, "mm", 4), right=True),
                )
            )
        rows.append(
            node(
                "tr",
                cell(f"{strip_name(numbers, at)}, area", kind="name"),
                cell(numbers.show(f"{entry}/area_3d_mm2", "mm²", 2), right=True),
                cell(numbers.show(f"{entry}/area_pattern_mm2", "mm²", 2), right=True),
                cell(),
            )
        )
    return card("Seams and areas", table(columns, rows))


def _findings_card(numbers: Numbers) -> Element | None:
    findings = numbers.get("/findings")
    if not findings:
        return None
    items = [
        node(
            "li",
            node("span", finding["severity"], class_=f"badge {finding['severity']}"),
            node("span", finding["message"]),
        )
        for finding in findings
    ]
    return card("Findings", node("ul", *items, class_="findings"), print_note(len(items)))


def _stitch_card(numbers: Numbers) -> Element | None:
    stitch = numbers.get("/stitch")
    if not stitch:
        return None
    rows = [
        node("tr", cell(title), cell(numbers.show(f"/stitch/{key}", unit), right=True))
        for title, key, unit in _STITCH_ROWS
        if key in stitch
    ]
    rows.append(
        node("tr", cell("Valid geometry"), cell("yes" if stitch["is_valid"] else "no", right=True))
    )
    return card("Sewn to the body", table((("", False), ("", True)), rows))


def _angles_card(numbers: Numbers) -> Element | None:
    """How sharply the surface turns at each seam of the stitched shell."""
    seams = numbers.get("/stitch/seams")
    if not seams:
        return None
    columns = (("Seam", False), ("Length", True), ("Mean angle", True), ("Largest", True))
    rows = []
    for at, seam in enumerate(seams):
        path = f"/stitch/seams/{at}"
        shown = (
            numbers.show(f"{path}/length_mm", "mm", 2),
            numbers.show(f"{path}/mean_deg", "°", 1),
            numbers.show(f"{path}/largest_deg", "°", 1),
        )
        name = cell(seam["seam"], kind="name")
        rows.append(node("tr", name, *(cell(figure, right=True) for figure in shown)))
    return card("Angles at the seams", table(columns, rows), is_printed=False)


def _pairs_card(
    numbers: Numbers, title: str, path: str, *, unit: str = "", digits: int | None = None
) -> Element | None:
    """Names and values as a list that flows into as many columns as fit."""
    pairs = numbers.get(path)
    if not pairs:
        return None
    rows = []
    for key, value in pairs.items():
        if value is None or value == "":
            continue
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        shown = numbers.show(f"{path}/{key}", unit, digits) if is_number else _words(value)
        rows.append(node("div", node("dt", key.replace("_", " ")), node("dd", shown)))
    return card(title, node("dl", *rows, class_="pairs"), is_printed=False)


def _words(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return ", ".join(str(part) for part in value)
    return str(value)
