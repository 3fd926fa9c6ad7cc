"""Which layer, color and line type each kind of line gets: the profiles and a user's own map.

In ``cutter`` every kind has a layer of its own; rulings share one, mountains dash-dotted and
valleys dashed (red and blue). ``aama`` and ``astm`` use the trade's layer numbers; there the file
has no line types, so mountains and valleys differ in color only, and a text says which is which.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final, Literal

from wrinkle_cad.errors import InputError
from wrinkle_cad.files.toml import read_toml

Role = Literal[
    "cut", "sew", "notch", "mark", "grain", "stretch", "mountain", "valley",
    "bend_up", "bend_down", "punch", "text",
    "test_square",
]  # fmt: skip
ROLES: Final[tuple[Role, ...]] = (
    "cut", "sew", "notch", "mark", "grain", "stretch", "mountain", "valley",
    "bend_up", "bend_down", "punch", "text",
    "test_square",
)  # fmt: skip

LINE_TYPES: Final[Mapping[str, tuple[str, tuple[float, ...]]]] = MappingProxyType(
    {
        "CONTINUOUS": ("Solid ________", ()),
        "DASHED": ("Dashed __ __ __", (6.0, 4.0, -2.0)),
        "DASHDOT": ("Dash dot __ . __ .", (8.0, 5.0, -1.5, 0.0, -1.5)),
        "DOTTED": ("Dotted . . . . .", (1.5, 0.0, -1.5)),
    }
)
"""Name: (description, pattern in mm as DXF wants it: total, then dashes, gaps and dots)."""

_LAYER_NAME: Final = re.compile(r"[A-Za-z0-9_$-]{1,31}")


@dataclass(frozen=True, slots=True)
class LayerStyle:
    """How one kind of line is drawn."""

    layer: str
    """Its layer, a name that DXF R12 accepts."""
    color: int = 7
    """AutoCAD color index 1...255 (7 is black on white)."""
    line_type: str = "CONTINUOUS"
    """A key of ``LINE_TYPES``."""


@dataclass(frozen=True, slots=True)
class Profile:
    """A named map from roles to layers."""

    name: str
    """``cutter``, ``aama``, ``astm`` or the user's own."""
    styles: Mapping[Role, LayerStyle]
    """Role to style; a role that is missing is not written."""
    is_blocks: bool = False
    """Pieces are blocks as in AAMA-292 and ASTM D6673, not plain entities."""


_CUTTER: Final[Mapping[Role, LayerStyle]] = MappingProxyType(
    {
        "cut": LayerStyle("CUT", 1),
        "sew": LayerStyle("SEW", 3),
        "notch": LayerStyle("NOTCH", 6),
        "mark": LayerStyle("MARK", 6),
        "grain": LayerStyle("GRAIN", 4),
        "stretch": LayerStyle("STRETCH", 30, "DASHDOT"),
        "mountain": LayerStyle("RULING", 1, "DASHDOT"),
        "valley": LayerStyle("RULING", 5, "DASHED"),
        "bend_up": LayerStyle("BEND_UP", 5, "DASHED"),
        "bend_down": LayerStyle("BEND_DOWN", 1, "DASHDOT"),
        "punch": LayerStyle("PUNCH", 2),
        "text": LayerStyle("TEXT", 7),
        "test_square": LayerStyle("TEST", 9),
    }
)
_TRADE: Final[Mapping[Role, LayerStyle]] = MappingProxyType(
    {
        "cut": LayerStyle("1"),
        "sew": LayerStyle("14"),
        "notch": LayerStyle("4"),
        "mark": LayerStyle("8"),
        "grain": LayerStyle("7"),
        "stretch": LayerStyle("33"),
        "mountain": LayerStyle("8", 1),
        "valley": LayerStyle("8", 5),
        "punch": LayerStyle("13"),
        "text": LayerStyle("15"),
    }
)
PROFILES: Final[Mapping[str, Profile]] = MappingProxyType(
    {
        "cutter": Profile("cutter", _CUTTER),
        "aama": Profile("aama", _TRADE, is_blocks=True),
        "astm": Profile("astm", _TRADE, is_blocks=True),
    }
)


def profile_from(source: str | Path) -> Profile:
    """Returns a shipped profile by name, or the user's own from a ``.toml`` file.

    The file has a table ``[layers]`` with roles as keys and as values a layer name, a table
    ``{layer, color, line_type}`` or ``false`` to leave the role out. Roles it does not name are
    as in ``cutter``.

    Raises:
        InputError: no such profile or file, or something in it that is not understood.
    """
    if str(source) in PROFILES:
        return PROFILES[str(source)]
    path = Path(source)
    if path.suffix.lower() != ".toml":
        raise InputError(
            f"The profile {str(source)!r} is not known. Choose one of {', '.join(PROFILES)} or a "
            ".toml file."
        )
    try:
        content = read_toml(path)
    except InputError as error:
        raise InputError(f"The profile {error}") from error
    return _parsed(content, path)


def _parsed(content: dict[str, object], path: Path) -> Profile:
    layers = content.get("layers")
    for key in sorted(set(content) - {"layers", "name"}):
        raise _refused(path, f"the key {key!r}, and only name and [layers] are known")
    if not isinstance(layers, dict):
        raise _refused(path, "no table [layers]")
    styles: dict[Role, LayerStyle] = dict(_CUTTER)
    for role, wanted in layers.items():
        if role not in ROLES:
            raise _refused(path, f"the role {role!r}, which is not one of {', '.join(ROLES)}")
        if wanted is False and role != "cut":
            del styles[role]
        else:
            styles[role] = _style(role, wanted, _CUTTER[role], path)
    for role, style in styles.items():
        if role != "cut" and style.layer == styles["cut"].layer:
            raise _refused(
                path, f"{role} on the cut layer {style.layer}; give it a layer of its own"
            )
    return Profile(str(content.get("name", path.stem)), MappingProxyType(styles))


def _style(role: str, wanted: object, usual: LayerStyle, path: Path) -> LayerStyle:
    given = {"layer": wanted} if isinstance(wanted, str) else wanted
    if not isinstance(given, dict):
        raise _refused(path, f"{role} = {wanted!r}, which is no layer name, table or false")
    # Users' files from before one spelling was settled on go on working.
    given = {"color" if key == "colour" else key: value for key, value in given.items()}
    for key in sorted(set(given) - {"layer", "color", "line_type"}):
        raise _refused(path, f"{role}.{key}, and only layer, color and line_type are known")
    layer = given.get("layer", usual.layer)
    color = given.get("color", usual.color)
    line_type = given.get("line_type", usual.line_type)
    if not isinstance(layer, str) or not _LAYER_NAME.fullmatch(layer):
        raise _refused(
            path, f"the {role} layer {layer!r}; a name has 1 to 31 of A-Z, a-z, 0-9, -, _ and $"
        )
    if not isinstance(color, int) or isinstance(color, bool) or not 1 <= color <= 255:
        raise _refused(path, f"the {role} color {color!r}; a color is a whole number 1 to 255")
    if not isinstance(line_type, str) or line_type.upper() not in LINE_TYPES:
        raise _refused(
            path, f"the {role} line_type {line_type!r}, which is not one of {', '.join(LINE_TYPES)}"
        )
    return LayerStyle(layer, color, line_type.upper())


def _refused(path: Path, found: str) -> InputError:
    return InputError(f"The profile {path.name} has {found}. Correct the file.")
