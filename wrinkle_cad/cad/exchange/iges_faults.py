"""What is wrong with the records of an IGES file.

The kernel follows a pointer to nothing, or a count that its list does not have, into memory that is
not its own, and the process ends. So numbers, counts and pointers are looked at before.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Final

from wrinkle_cad import settings

from .iges_names import Entity

_NUMBER: Final = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d{1,3})?")
_WHOLE: Final = re.compile(rb"[-+]?\d{1,9}")
_LEAST: Final = {
    100: 7,
    110: 6,
    116: 3,
    120: 4,
    122: 4,
    123: 3,
    124: 12,
    142: 5,
    144: 4,
    190: 2,
    510: 3,
}
"""Numbers that an entity of a kind has at least."""
_LISTS: Final = {102: 1, 502: 3, 504: 5, 508: 5, 514: 2}
"""Kinds whose first number counts the entries of a list, and how long each is at least."""
_POINTERS: Final = {
    120: (1, 2), 122: (1,), 142: (2, 3, 4), 144: (1, 4), 190: (1, 2), 192: (1, 2), 194: (1, 2),
    196: (1,), 198: (1, 2), 510: (1,), 186: (1,),
}  # fmt: skip
"""Which numbers of a kind point at other entities; 0 is no entity."""
_SPLINE_CURVE, _SPLINE_SURFACE, _COMPOSITE, _SHELL, _LOOP = 126, 128, 102, 514, 508
_FACE: Final = 510
_VERTICES, _EDGES = 502, 504
_DEPTH: Final = 12
"""Steps from an entity to itself that are looked for."""


def sequence_fault(text: bytes) -> str | None:
    """Returns what is wrong with the order of a file's records and with its directory, or None.

    Args:
        text: an IGES file as ``plain_text`` returns it, its sections as long as they say.
    """
    lines = [line for line in text.split(b"\n") if len(line) > 72]
    for section in (b"D", b"P"):
        rows = [line for line in lines if line[72:73] == section]
        for i, row in enumerate(rows, start=1):
            if _whole(row[73:80]) != i:
                shown = row[72:80].decode("ascii", "replace").strip()
                return f"record {i} of section {section.decode()} is numbered '{shown}'"
    directory = [line for line in lines if line[72:73] == b"D"]
    count = sum(line[72:73] == b"P" for line in lines)
    if len(directory) % 2:
        return "the directory has an odd number of records"
    for i in range(0, len(directory), 2):
        first, second = directory[i], directory[i + 1]
        if any(_whole(first[at : at + 8]) is None for at in range(0, 64, 8)):
            return f"directory entry {i + 1} holds what is no whole number"
        start, rows_of = _whole(first[8:16]), _whole(second[24:32])
        if second[:8].strip() not in (b"", first[:8].strip()):
            return f"directory entry {i + 1} has two kinds"
        if start is None or rows_of is None or not 0 < start <= start + rows_of - 1 <= count:
            return f"directory entry {i + 1} points at parameters that the file does not have"
    return None


def entities_fault(entities: Mapping[int, Entity]) -> str | None:
    """Returns what is wrong with the parameters of a file's entities, or None.

    Args:
        entities: by directory entry, as ``entities_of`` yields them.
    """
    for number, entity in entities.items():
        fault = _entity_fault(entity, entities)
        if fault is not None:
            return f"entity {entity.kind} at directory entry {number} {fault}"
    return _ring_fault(entities)


def _entity_fault(entity: Entity, entities: Mapping[int, Entity]) -> str | None:
    fields = entity.fields
    if entity.kind and (not fields or _whole(fields[0]) != entity.kind):
        return "has the parameters of another one"
    for pointer in (entity.level, entity.transform):
        if (
            pointer
            and abs(pointer) not in entities
            and (pointer < 0 or pointer == entity.transform)
        ):
            return f"points at {abs(pointer)}, which the file does not have"
    if entity.kind not in _LEAST.keys() | _LISTS.keys() | _POINTERS.keys() | {126, 128}:
        return None
    values = [_value(field) for field in fields[1:]]
    for field, value in zip(fields[1:], values, strict=True):
        if value is not None and not abs(value) <= settings.LARGEST_COORDINATE:
            return f"holds the number {field.strip()[:20].decode('ascii', 'replace')}"
    counts = _count_fault(entity.kind, fields[1:], values)
    return counts or _pointer_fault(entity, entities) or _loop_fault(entity, entities)


def _loop_fault(entity: Entity, entities: Mapping[int, Entity]) -> str | None:
    """Checks that a loop's edges and vertices are in the lists that it names."""
    if entity.kind != _LOOP:
        return None
    numbers = [_whole(field) or 0 for field in entity.fields]
    at = 2
    for _ in range(numbers[1]):
        if len(numbers) < at + 5:
            return "has fewer edges than it says"
        kind, pointer, place, _, curves = numbers[at : at + 5]
        held = entities.get(pointer)
        if held is None or held.kind != (_VERTICES if kind == 1 else _EDGES):
            return f"points at {pointer}, which is no list of edges or vertices"
        count = (_whole(held.fields[1]) or 0) if len(held.fields) > 1 else 0
        if not 0 < place <= count:
            return f"names edge {place} of a list of {count}"
        at += 5 + 2 * max(0, curves)
    return None


def _count_fault(kind: int, fields: Sequence[bytes], values: Sequence[float | None]) -> str | None:
    wanted = _LEAST.get(kind, 0)
    if kind in _LISTS:
        count = _whole(fields[0]) if fields else None
        if count is None or count < 1:
            return "has a list of no length"
        wanted = 1 + count * _LISTS[kind]
    if kind in (_SPLINE_CURVE, _SPLINE_SURFACE):
        return _spline_fault(kind, fields, values)
    held = sum(1 for value in values[:wanted] if value is not None)
    return f"has {held} numbers of {wanted}" if held < wanted and kind != _LOOP else None


def _spline_fault(kind: int, fields: Sequence[bytes], values: Sequence[float | None]) -> str | None:
    ways = 1 if kind == _SPLINE_CURVE else 2
    head = [_whole(field) for field in fields[: 2 * ways]]
    if len(head) < 2 * ways or any(number is None or number < 1 for number in head):
        return "has no degree or no control points"
    tops, degrees = [n or 0 for n in head[:ways]], [n or 0 for n in head[ways:]]
    if any(degree > 25 or degree > top for degree, top in zip(degrees, tops, strict=True)):
        return f"has degree {max(degrees)} and {min(tops) + 1} control points"
    knots = [top + degree + 2 for top, degree in zip(tops, degrees, strict=True)]
    poles = 1
    for top in tops:
        poles *= top + 1
    start = 2 * ways + (4 if ways == 1 else 5)
    needed = start + sum(knots) + 4 * poles + 2 * ways
    numbers = values[start:needed]
    if needed > len(values) or any(number is None for number in numbers):
        return f"has {len(values)} parameters, its counts say {needed}"
    at = start
    for count in knots:
        row = [value or 0.0 for value in values[at : at + count]]
        if any(after < before for before, after in pairwise(row)) or row[0] == row[-1]:
            return "has knots that do not rise"
        at += count
    if any((weight or 0.0) <= 0.0 for weight in values[at : at + poles]):
        return "has a weight that is not positive"
    return None


def _pointer_fault(entity: Entity, entities: Mapping[int, Entity]) -> str | None:
    for pointer in _references(entity):
        if pointer and abs(pointer) not in entities:
            return f"points at {abs(pointer)}, which the file does not have"
    return None


def _references(entity: Entity) -> Iterator[int]:
    numbers = [_whole(field) or 0 for field in entity.fields]
    for at in _POINTERS.get(entity.kind, ()):
        if at < len(numbers):
            yield numbers[at]
    count = numbers[1] if len(numbers) > 1 else 0
    if entity.kind == _COMPOSITE:
        yield from numbers[2 : 2 + count]
    elif entity.kind == _SHELL:
        yield from numbers[2 : 2 + 2 * count : 2]
    elif entity.kind == _EDGES:
        for at in range(2, min(len(numbers) - 4, 2 + 5 * count), 5):
            yield from (numbers[at], numbers[at + 1], numbers[at + 3])
    elif entity.kind == _FACE:
        yield from numbers[4 : 4 + max(0, numbers[2] if len(numbers) > 2 else 0)]


def _ring_fault(entities: Mapping[int, Entity]) -> str | None:
    """Finds an entity that holds itself, which the kernel would follow for ever."""
    held = {number: [abs(at) for at in _references(entity)] for number, entity in entities.items()}
    for number in entities:
        level = set(held[number])
        for _ in range(_DEPTH):
            if number in level:
                return f"the entity at directory entry {number} holds itself"
            level = {at for one in level for at in held.get(one, ())}
            if not level:
                break
    return None


def _whole(field: bytes) -> int | None:
    digits = field.strip()
    if not digits:
        return 0
    return int(digits) if _WHOLE.fullmatch(digits) else None


def _value(field: bytes) -> float | None:
    text = field.strip()
    if not text:
        return 0.0
    if _NUMBER.fullmatch(text) is None:
        return None
    return float(text.replace(b"D", b"E").replace(b"d", b"e"))
