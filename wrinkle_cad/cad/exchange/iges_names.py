"""What an IGES file calls each entity, and which of them it hides.

An entity has a label of eight letters, may point at a name (property 406, form 15), lies on a level
that may have a name (property 406, form 3), and may be in a group (402). It is hidden if its status
number begins with 01. The kernel keeps the labels only.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

from .step.names import Candidate, ItemNames

_PROPERTY: Final = 406
_GROUP: Final = 402
_NAME, _LEVEL = 15, 3
"""Forms of a property."""
_GROUPS: Final = (1, 7, 14, 15)
"""Forms of a group."""
_COUNTED: Final = re.compile(rb"\s*(\d+)H")


class Entity(NamedTuple):
    """One entity of a file."""

    kind: int
    """Its type: 110 is a line."""
    form: int
    """Of its kind."""
    level: int
    """That it lies on; below 0 the entry of a property that lists several."""
    transform: int
    """The entry of the matrix that moves it; 0 for none."""
    label: str
    """Of up to eight letters, with its subscript."""
    is_hidden: bool
    """Whether it is blanked."""
    fields: tuple[bytes, ...]
    """Its parameters, the kind first."""


def item_names(entities: Mapping[int, Entity]) -> ItemNames:
    """Returns the names of the entities of a file by their directory entry, and what it hides.

    Args:
        entities: by directory entry, as ``entities_of`` yields them.
    """
    levels = {
        entity.level: _text(entity.fields[3])
        for entity in entities.values()
        if (entity.kind, entity.form) == (_PROPERTY, _LEVEL) and len(entity.fields) > 3
    }
    groups = _groups(entities)
    return ItemNames(
        {
            number: tuple(_candidates(number, entities, levels, groups[number]))
            for number in entities
        },
        frozenset(number for number, entity in entities.items() if entity.is_hidden),
    )


def _candidates(
    number: int, entities: Mapping[int, Entity], levels: Mapping[int, str], groups: Sequence[int]
) -> Iterator[Candidate]:
    """Yields the names of an entity: its own, of its groups, of its level."""
    own = entities[number]
    for name in (_given_name(own, entities), own.label):
        if name:
            yield Candidate(name, "curve", number)
    for group in groups:
        name = _given_name(entities[group], entities) or entities[group].label
        if name:
            yield Candidate(name, "group", group)
    if levels.get(own.level):
        yield Candidate(levels[own.level], "layer", own.level)


def _given_name(entity: Entity, entities: Mapping[int, Entity]) -> str:
    """Returns what the name among an entity's properties says; empty without one."""
    for pointer in _properties(entity, entities):
        found = entities[pointer]
        if found.form == _NAME and len(found.fields) > 2:
            return _text(found.fields[2])
    return ""


def _properties(entity: Entity, entities: Mapping[int, Entity]) -> list[int]:
    """Returns the pointers to properties: the last numbers of an entity, behind their count."""
    numbers = [_number(field) for field in entity.fields]
    for count in range(1, len(numbers) - 1):
        pointers = numbers[-count:]
        if pointers[0] not in entities or entities[pointers[0]].kind != _PROPERTY:
            break
        if numbers[-count - 1] == count:
            return pointers
    return []


def _groups(entities: Mapping[int, Entity]) -> dict[int, list[int]]:
    """Returns for each entity the groups that it is in."""
    found: dict[int, list[int]] = defaultdict(list)
    for number, entity in entities.items():
        if entity.kind == _GROUP and entity.form in _GROUPS and len(entity.fields) > 1:
            for field in entity.fields[2 : 2 + max(0, _number(entity.fields[1]))]:
                found[_number(field)].append(number)
    return found


def entities_of(text: bytes) -> Iterator[tuple[int, Entity]]:
    """Yields each entity of a file with its directory entry.

    Args:
        text: an IGES file as ``plain_text`` returns it.
    """
    lines = text.split(b"\n")
    directory = [line[:72] for line in lines if line[72:73] == b"D"]
    separators = _separators(b"".join(line[:72] for line in lines if line[72:73] == b"G"))
    parameters: dict[int, list[bytes]] = defaultdict(list)
    for line in lines:
        if line[72:73] == b"P":
            parameters[_number(line[64:72])].append(line[:64])
    for i in range(0, len(directory) - 1, 2):
        first, second = directory[i], directory[i + 1]
        label = second[56:64].decode("ascii", "replace").strip()
        subscript = second[64:72].strip().decode("ascii", "replace")
        yield (
            i + 1,
            Entity(
                _number(first[:8]),
                _number(second[32:40]),
                _number(first[32:40]),
                _number(first[48:56]),
                f"{label}{subscript}" if label and subscript not in ("", "0") else label,
                first[64:66].strip() in (b"1", b"01"),
                tuple(fields_of(b"".join(parameters[i + 1]), *separators)),
            ),
        )


def _separators(header: bytes) -> tuple[bytes, bytes]:
    """Returns what ends a field and what ends an entity, as the global section says."""
    ends = re.match(rb"1H(.)\1?(?:1H(.))?", header)
    if ends is None:
        other = re.match(rb",1H(.)", header)
        return b",", other[1] if other else b";"
    return ends[1], ends[2] or b";"


def fields_of(text: bytes, separator: bytes = b",", end: bytes = b"") -> Iterator[bytes]:
    """Yields fields; one may be a counted string that holds what ends a field.

    Args:
        text: records of one section, joined.
        separator: what ends a field.
        end: what ends the last one; the end of the text if empty.
    """
    at = 0
    while at < len(text):
        counted = _COUNTED.match(text, at)
        start = counted.end() + int(counted[1]) if counted and len(counted[1]) < 9 else at
        stops = [
            found for mark in (separator, end) if mark and (found := text.find(mark, start)) >= 0
        ]
        stop = min(stops, default=len(text))
        yield text[at:stop]
        if end and text[stop : stop + 1] == end:
            return
        at = stop + 1


def _text(field: bytes) -> str:
    counted = _COUNTED.match(field)
    return field[counted.end() if counted else 0 :].decode("utf-8", "replace").strip()


def _number(field: bytes) -> int:
    digits = field.strip()
    return int(digits) if re.fullmatch(rb"[-+]?\d{1,9}", digits) else 0
