"""The parts of the page that hold pictures: 3-D view, validity matrix, curves, pattern."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from wrinkle_cad import settings

from .markup import Element, node
from .numbers import Numbers, written
from .views import MeshView, StripView

_IDLE: Final = "Point at the strip: the same bridge lights up in every view."
_COLORS: Final = (
    ("state", "Verdict"),
    ("validity", "Validity"),
    ("fold", "Fold angle"),
    ("twist", "Twist"),
    ("leather", "Leather"),
)
_STANDPOINTS: Final = (
    ("whole", "Whole", "All that is shown"),
    ("strips", "Strip", "The strips alone"),
    ("top", "Top", "From above"),
    ("front", "Front", "Along y"),
    ("side", "Side", "Against x"),
)
_PRINTED_PATTERNS: Final = 3
"""Of the wrinkles: as many as stand on one sheet of A4."""
_PATTERN_LAYERS: Final = (
    ("cut", "Cut line"),
    ("sew", "Sew line"),
    ("notches", "Notches"),
    ("grain", "Grain line"),
    ("bridges", "Bridges"),
    ("dimensions", "Dimensions"),
    ("names", "Names"),
)


def figures_panel(numbers: Numbers) -> Element:
    """The key figures of the wrinkle that asks most of a sheet, as tiles."""
    worst = _worst_strip(numbers)
    entry = f"/strips/{worst}"
    strain: list[Element | str] = [numbers.show(f"{entry}/max_strain_percent", "%", 3)]
    if written(numbers.get(f"{entry}/p95_strain_percent") or 0.0, digits=3) != "0":
        p95 = numbers.show(f"{entry}/p95_strain_percent", "%", 3)
        strain.append(node("small", "mostly below ", p95))
    tiles = (
        ("Largest strain", strain),
        ("Sharpest crease", _crease(numbers, entry)),
        ("Developable share", [numbers.show(f"{entry}/developable_share", "", 3)]),
        ("Smallest bend radius", _radius(numbers, entry)),
        ("Largest twist", [numbers.show(f"{entry}/max_twist_deg", "°", 2)]),
        ("Area of the pattern", [numbers.show(f"{entry}/area_pattern_mm2", "mm²", 1)]),
    )
    shown = node(
        "dl",
        *(
            node("div", node("dt", title), node("dd", *parts), class_=_tile_class(parts))
            for title, parts in tiles
        ),
        class_="tiles",
    )
    if len(_wrinkles(numbers)) <= 1:
        return shown
    words = f"Worst wrinkle: {numbers.get(f'{entry}/name')}"
    return node("section", node("h2", words, class_="head"), shown)


def _tile_class(parts: Sequence[Element | str]) -> str:
    """Long figures are set smaller: none is broken, and none touches its box."""
    first = parts[0]
    return "tile long" if len(first if isinstance(first, str) else first.text or "") > 9 else "tile"


def _crease(numbers: Numbers, entry: str) -> list[Element | str]:
    creases = numbers.get(f"{entry}/creases")
    if not creases:
        return ["none"]
    angles = [float(crease["angle_deg"]) for crease in creases]
    at = angles.index(max(angles))
    place = node("small", "at ", numbers.show(f"{entry}/creases/{at}/p_mm", "mm", 1), " of P")
    return [numbers.show(f"{entry}/creases/{at}/angle_deg", "°", 1), place]


def _radius(numbers: Numbers, entry: str) -> list[Element | str]:
    if numbers.get(f"{entry}/smallest_bend_radius_mm") is None:
        return ["flat"]
    shown = [numbers.show(f"{entry}/smallest_bend_radius_mm", "mm", 2)]
    inner = numbers.get(f"{entry}/inner_bend_radius_mm")
    if inner != numbers.get(f"{entry}/smallest_bend_radius_mm"):
        inside = numbers.show(f"{entry}/inner_bend_radius_mm", "mm", 2)
        shown.append(node("small", inside, " inside"))
    return [*shown]


def _wrinkles(numbers: Numbers) -> list[int]:
    """Which of the strips are no bands."""
    entries = numbers.get("/strips") or []
    return [at for at, entry in enumerate(entries) if entry.get("role") != "band"]


def _worst_strip(numbers: Numbers) -> int:
    """The wrinkle of the worst state, and among equals of the largest strain."""
    entries = numbers.get("/strips") or [{}]
    return max(_wrinkles(numbers) or range(len(entries)), key=lambda at: _badness(entries[at]))


def _badness(entry: Mapping[str, Any]) -> tuple[int, float, float]:
    state = settings.STATES.index(entry["state"]) if "state" in entry else 0
    crease = max((float(crease["angle_deg"]) for crease in entry.get("creases", ())), default=0.0)
    return state, crease, float(entry.get("max_strain_percent") or 0.0)


def space_panel(strips: Sequence[StripView], body: MeshView | None) -> Element:
    """The 3-D view with its colors and layers."""
    colors = [
        node(
            "label",
            node("input", type="radio", name="color-by", value=value, checked=value == "state"),
            title,
        )
        for value, title in _COLORS
    ]
    layers = [_layer(str(at), view.name) for at, view in enumerate(strips) if view.role != "band"]
    if len(layers) < len(strips):
        layers.append(_layer("bands", "Bands", is_on=False))
    layers += [_layer("bridges", "Bridges"), _layer("rails", "Rails")]
    if body is not None:
        layers.append(_layer("body", body.name))
    standpoints = [
        node("button", title, type="button", title=hint, data_view=name)
        for name, title, hint in _STANDPOINTS
    ]
    return node(
        "section",
        node("div", node("h2", "In space"), node("p", _IDLE, class_="readout"), class_="head"),
        node(
            "div",
            node("canvas", class_="space", aria_label="3-D view: drag to turn, wheel to zoom"),
            node("p", "This browser shows no 3-D graphics (WebGL).", class_="failure"),
            node("div", *standpoints, class_="standpoints", aria_label="Seen from"),
            class_="stage",
        ),
        node(
            "div",
            node("fieldset", *colors, class_="segments", aria_label="Color by"),
            node("fieldset", node("legend", "Show"), *layers),
            class_="toolbar",
        ),
        _space_legend(),
        class_="card space-panel",
    )


def _layer(value: str, title: str, *, is_on: bool = True) -> Element:
    return node("label", node("input", type="checkbox", data_layer=value, checked=is_on), title)


def _key(tone: str, title: str, kind: str = "") -> Element:
    mark = node("i", class_=f"key {kind}".strip(), style=f"--tone: var(--{tone})")
    return node("span", mark, title)


def _space_legend() -> Element:
    keys = []
    for mode, tone, title in (
        ("state", "valid", "developable"),
        ("state", "stretched", "a sheet must give"),
        ("state", "creased", "creased"),
        ("state", "folded", "folded back"),
        ("validity", "valid", "locally convex bridge"),
        ("validity", "inflection", "inflection ruling"),
        ("validity", "invalid", "not locally convex"),
    ):
        key = _key(tone, title)
        key.set("data-for", mode)
        if mode != "state":
            key.set("hidden", "")
        keys.append(key)
    measure = node(
        "span",
        node("span", class_="what"),
        "0°",
        node("i", node("span", class_="quarter"), class_="ramp"),
        node("span", class_="high"),
        data_for="measure",
        hidden=True,
    )
    mouse = "Drag to turn; click, then wheel to zoom; right button to shift."
    touch = "Drag to turn; pinch to zoom; two fingers to shift."
    hints = (node("span", mouse, class_="by-mouse"), node("span", touch, class_="by-touch"))
    return node("div", *keys, measure, *hints, class_="legend")


def tabs(names: Sequence[str]) -> Element:
    """One button for each strip."""
    buttons = [
        node("button", name, type="button", role="tab", data_tab=str(at))
        for at, name in enumerate(names)
    ]
    return node("div", *buttons, class_="tabs", role="tablist", aria_label="Strips")


def strip_section(numbers: Numbers, index: int, view: StripView) -> Element:
    """Matrix, curves and pattern of one strip."""
    parts = [_matrix_card(numbers, index, view), _curves_card(numbers, index, view)]
    if view.pieces:
        parts.append(_pattern_card(view))
    is_printed = bool(view.pieces) and index in _wrinkles(numbers)[:_PRINTED_PATTERNS]
    kind = "strip-views" if is_printed else "strip-views screen-only"
    return node("section", *parts, class_=kind, data_strip=str(index))


def _zoom() -> Element:
    buttons = (("+", "Nearer"), ("\N{MINUS SIGN}", "Further"), ("\N{WHITE SQUARE}", "Whole"))
    return node(
        "div",
        *(
            node("button", sign, type="button", title=title, aria_label=title)
            for sign, title in buttons
        ),
        class_="zoom",
    )


def _matrix_card(numbers: Numbers, index: int, view: StripView) -> Element:
    local = [_key("local", "local search", "dash")] if view.local is not None else []
    return node(
        "div",
        node("div", node("h2", "Validity matrix"), _zoom(), class_="head"),
        node("div", node("canvas", class_="matrix", aria_label="Validity matrix"), class_="plot"),
        node(
            "div",
            _key("valid-cell", "locally convex", "box"),
            _key("invalid-cell", "not", "box"),
            _key("ink", "chosen path"),
            *local,
            class_="legend",
        ),
        node("p", *_matrix_words(numbers, index, view), class_="note"),
        class_="card screen-only",
    )


def _matrix_words(numbers: Numbers, index: int, view: StripView) -> list[Element | str]:
    words: list[Element | str] = [
        "Each cell is one possible bridge, from one of ",
        numbers.show(f"/strips/{index}/samples_p"),
        " samples of P to one of ",
        numbers.show(f"/strips/{index}/samples_q"),
        " of Q; a path from corner to corner is a strip. ",
    ]
    if view.valid is None:
        words.append("The matrix is too large to be drawn: only the paths are.")
    elif max(view.valid.shape) > settings.MATRIX_OVERVIEW:
        words.append(
            "Seen whole, a pixel stands for several bridges and is shaded by the share of them"
            " that is locally convex, never white or full where both kinds occur; zoom in for"
            " single bridges."
        )
    return words


def _curves_card(numbers: Numbers, index: int, view: StripView) -> Element:
    entry = f"/strips/{index}"
    chosen = _key("chosen", "this strip, in all ")
    chosen.append(numbers.show(f"{entry}/bending"))
    keys = [chosen]
    if view.least_bending is not None:
        least = _key("least", "least-bending path, in all ", "dots")
        least.append(numbers.show(f"{entry}/least_bending"))
        keys.append(least)
    if view.local is not None:
        keys.append(_key("local", "local search", "dash"))
    keys += [_key("inflection", "inflection", "box"), _key("invalid", "not locally convex", "box")]
    return node(
        "div",
        node("h2", "Along the strip", class_="head"),
        node(
            "div",
            node("canvas", class_="curves", aria_label="Bending energy and fold angle"),
            class_="plot",
        ),
        node("div", *keys, class_="legend"),
        node(
            "p",
            "Where this strip needs far more energy than the least-bending one, it was made"
            " developable with folds.",
            class_="note",
        ),
        class_="card screen-only",
    )


def _pattern_card(view: StripView) -> Element:
    layers = [
        node("label", node("input", type="checkbox", data_pattern_layer=name, checked=True), title)
        for name, title in _PATTERN_LAYERS
        if name != "sew" or any(piece.has_allowance for piece in view.pieces)
    ]
    return node(
        "div",
        node("div", node("h2", "Flat pattern"), node("p", _IDLE, class_="readout"), class_="head"),
        node("div", node("fieldset", node("legend", "Show"), *layers), _zoom(), class_="toolbar"),
        node(
            "div", node("canvas", class_="pattern", aria_label="Flat pattern"), class_="plot flat"
        ),
        class_="card wide",
    )
