"""What a STEP file calls each free curve and shell, and which of them it hides.

Programs write all free curves into one product and name the curves, the sets that hold them, the
representations of these, or the layers that they lie on, instead of giving each a product of its
own. The kernel drops most of these names. So each such item is marked in the text with its number,
which comes back with the name of the entity that a shape was made from.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from .text import quoted_statements

_CURVE: Final = (
    r"\w*CURVE\w*|LINE|CIRCLE|ELLIPSE|PARABOLA|HYPERBOLA|POLYLINE|CLOTHOID|\w*EDGE_SET|PATH"
    r"|EDGE_LOOP|(?:EDGE|SHELL)_BASED_WIREFRAME_MODEL|OPEN_PATH|ORIENTED_EDGE|SUBEDGE|WIRE_SHELL"
)
_SHELL: Final = r"OPEN_SHELL|CLOSED_SHELL|ORIENTED_OPEN_SHELL|SHELL_BASED_SURFACE_MODEL"
_SOLID: Final = r"MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS|FACETED_BREP"
_SURFACE: Final = (
    r"(?:RECTANGULAR_TRIMMED|CURVE_BOUNDED|RECTANGULAR_COMPOSITE)_SURFACE|B_SPLINE_SURFACE\w*"
)
_SET: Final = r"GEOMETRIC_(?:CURVE_)?SET"
_REPRESENTATION: Final = r"\w*REPRESENTATION"
_LAYER: Final = r"PRESENTATION_LAYER_ASSIGNMENT"
_GROUP: Final = r"GROUP|\w*GROUP_ASSIGNMENT"
_STYLE: Final = r"\w*STYLED_ITEM|INVISIBILITY"
_MAP: Final = "REPRESENTATION_MAP"
_INSTANCE: Final = "MAPPED_ITEM"
_ABOVE_ALL: Final = f"{_LAYER}|{_STYLE}|{_MAP}"
"""What can hold a whole representation."""
_ITEM: Final = "|".join((_CURVE, _SHELL, _SOLID, _SURFACE))
_WANTED: Final = re.compile(
    "|".join((_ITEM, _SET, _REPRESENTATION, _LAYER, _GROUP, _STYLE, _MAP, _INSTANCE))
)
_FREE: Final = re.compile(rb"\bGEOMETRIC_(?:CURVE_)?SET\b|_BASED_WIREFRAME_MODEL\b|OPEN_SHELL\b")
_MARKED: Final = re.compile(_ITEM)
_HEAD: Final = re.compile(rb"#\s*(\d+)\s*=\s*(\(?)\s*(\w*)")
_KEYWORD: Final = re.compile(rb"\b([A-Z]\w*)\s*\(")
_REFERENCE: Final = re.compile(rb"#\s*(\d+)")
_MARK: Final = re.compile(r"\{shape#(\d+)\}\Z")
_ESCAPE: Final = re.compile(
    r"\\X2\\((?:[0-9A-F]{4})+)\\X0\\|\\X4\\((?:[0-9A-F]{8})+)\\X0\\|\\X\\([0-9A-F]{2})"
    r"|\\S\\(.)|\\(\\)|''"
)
_DEEPEST: Final = 4
"""Steps from a composite curve over its segments to the curves that these trim, and one more."""


class Candidate(NamedTuple):
    """One name that stands for an item."""

    name: str
    """As in the file."""
    carrier: str
    """What carries it: ``curve``, ``set``, ``layer``, ..."""
    number: int
    """Of the entity that carries it."""


@dataclass(frozen=True, slots=True, eq=False)
class ItemNames:
    """The names of the items of a file, by their numbers."""

    candidates: Mapping[int, tuple[Candidate, ...]]
    """The most specific first; no empty ones."""
    hidden: frozenset[int]
    """Items that the file says are not shown."""


class _Entity(NamedTuple):
    keyword: str
    name: str
    references: tuple[int, ...]


def item_names(text: bytes) -> ItemNames:
    """Returns the names that a file gives to its curves and shells, and what it hides.

    Args:
        text: a STEP file as ``plain_text`` returns it.
    """
    if _FREE.search(text) is None:
        return ItemNames({}, frozenset())
    entities = dict(_entities(text))
    holders: dict[int, list[int]] = defaultdict(list)
    for number, entity in entities.items():
        for reference in entity.references:
            holders[reference].append(number)
    marked = [number for number, entity in entities.items() if _MARKED.fullmatch(entity.keyword)]
    above = {number: _above(number, entities, holders) for number in marked}
    return ItemNames(
        {number: tuple(_candidates(number, entities, above[number])) for number in marked},
        frozenset(
            number
            for number in marked
            if any(entities[holder].keyword == "INVISIBILITY" for holder in above[number])
        ),
    )


def _entities(text: bytes) -> Iterator[tuple[int, _Entity]]:
    for statement, strings in quoted_statements(text):
        head = _HEAD.match(statement)
        if head is None:
            continue
        keyword = head[3].decode("ascii", "replace")
        first = 0
        if head[2]:
            words = [word.decode("ascii") for word in _KEYWORD.findall(statement)]
            keyword = next((word for word in words if _WANTED.fullmatch(word)), "")
            # The parts of a complex entity stand in alphabetical order, each with its own strings.
            first = statement.partition(b"REPRESENTATION_ITEM")[0].count(b"''")
        if _WANTED.fullmatch(keyword):
            name = decoded(strings[first]) if first < len(strings) else ""
            references = tuple(int(number) for number in _REFERENCE.findall(statement))
            yield int(head[1]), _Entity(keyword, name, references[1:])


def _candidates(
    number: int, entities: Mapping[int, _Entity], above: Sequence[int]
) -> Iterator[Candidate]:
    """Yields the names of an item: its own, of what it consists of, of what holds it, of layers."""
    own = entities[number]
    if own.name:
        yield Candidate(own.name, _word(own.keyword), number)
    inner = {name for name in _inner_names(number, entities, _DEEPEST) if name}
    if len(inner) == 1:
        yield Candidate(inner.pop(), "curve", number)
    for pattern, word in (
        (f"{_CURVE}|{_SHELL}|{_SOLID}", ""),
        (_SET, "set"),
        (_GROUP, "group"),
        (_INSTANCE, "instance"),
        (_REPRESENTATION, "representation"),
        (_LAYER, "layer"),
    ):
        for holder in above:
            found = entities[holder]
            if found.name and re.fullmatch(pattern, found.keyword):
                yield Candidate(found.name, word or _word(found.keyword), holder)


def _word(keyword: str) -> str:
    if "SHELL" in keyword and "WIREFRAME" not in keyword:
        return "shell"
    if keyword in ("EDGE_CURVE", "ORIENTED_EDGE", "SUBEDGE"):
        return "edge"
    if "BREP" in keyword:
        return "solid"
    if re.fullmatch(_SURFACE, keyword):
        return "surface"
    return "wire" if re.search("WIREFRAME|PATH|LOOP|EDGE_SET|WIRE_SHELL", keyword) else "curve"


def _inner_names(number: int, entities: Mapping[int, _Entity], depth: int) -> Iterator[str]:
    for reference in entities[number].references:
        inner = entities.get(reference)
        if inner is not None and (inner.keyword.startswith("COMPOSITE") or _is_curve(inner)):
            yield inner.name
            if depth > 1:
                yield from _inner_names(reference, entities, depth - 1)


def _is_curve(entity: _Entity) -> bool:
    return re.fullmatch(_CURVE, entity.keyword) is not None


def _above(
    number: int, entities: Mapping[int, _Entity], holders: Mapping[int, list[int]]
) -> list[int]:
    """Returns what holds an item, directly or not, the nearest first."""
    todo = sorted(holders.get(number, ()))
    found = dict.fromkeys(todo)
    while todo:
        holder = todo.pop(0)
        for at in _holding(holder, entities, holders):
            if at not in found:
                found[at] = None
                todo.append(at)
    # An assignment puts items into the group that it refers to.
    groups = [
        group
        for at in found
        if entities[at].keyword.endswith("GROUP_ASSIGNMENT")
        for group in entities[at].references
        if group in entities and entities[group].keyword == "GROUP"
    ]
    return [*found, *groups]


def _holding(
    holder: int, entities: Mapping[int, _Entity], holders: Mapping[int, list[int]]
) -> list[int]:
    """Returns what holds a holder.

    A representation is not held by its relations: the context of another part is no holder. What
    is mapped to several places has at each another name, which its number does not tell.
    """
    keyword = entities[holder].keyword
    found = holders.get(holder, [])
    if keyword == _MAP:
        return found if len(found) == 1 else []
    if not re.fullmatch(_REPRESENTATION, keyword):
        return found
    return [at for at in found if re.fullmatch(_ABOVE_ALL, entities[at].keyword)]


def marked_text(text: bytes, names: ItemNames) -> bytes:
    """Returns the text with every item's number at the end of its name; see ``mark_of``."""
    if not names.candidates:
        return text
    pattern = re.compile(
        rb"(#\s*(\d+)\s*=\s*(?:\([^;']*?\bREPRESENTATION_ITEM\s*\(|\w+\s*\()\s*'(?:[^']|'')*)'"
    )

    def mark(match: re.Match[bytes]) -> bytes:
        number = int(match[2])
        return b"%s{shape#%d}'" % (match[1], number) if number in names.candidates else match[0]

    return pattern.sub(mark, text)


def mark_of(name: str) -> int | None:
    """Returns the number of the item that a marked name stands for, or None."""
    found = _MARK.search(name)
    return int(found[1]) if found else None


def unmarked(name: str) -> str:
    """Returns a name as the file has it."""
    return _MARK.sub("", name)


def decoded(raw: bytes) -> str:
    r"""Returns the text of a STEP string without its outer quotes: ``\X2\``, ``\S\``, ``''``."""
    return _ESCAPE.sub(_unescaped, raw.decode("utf-8", "replace").replace("\n", ""))


def _unescaped(match: re.Match[str]) -> str:
    wide, wider, single, shifted, backslash = match.groups()
    if wide:
        return bytes.fromhex(wide).decode("utf-16-be", "replace")
    if wider:
        return bytes.fromhex(wider).decode("utf-32-be", "replace")
    if single:
        return chr(int(single, 16))
    if shifted:
        return chr(ord(shifted) + 128)
    return "\\" if backslash else "'"
