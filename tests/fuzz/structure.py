"""Damage to STEP files that keeps their syntax: other geometry, other references; seeded.

A file is taken as its entities, number -> text, so that what is changed is a degree, a knot, a
weight or a curve and the kernel is reached, where bytes that are changed blindly are told before.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from typing import Final

_ENTITY: Final = re.compile(rb"^#(\d+)\s*=\s*(.*?);\s*$", re.MULTILINE | re.DOTALL)
_REFERENCE: Final = re.compile(rb"#(\d+)")
_CURVE: Final = re.compile(rb"B_SPLINE_CURVE_WITH_KNOTS\('',(\d+),\(([^)]*)\)")
_KNOTS: Final = re.compile(
    rb"\((\d+(?:\s*,\s*\d+)*)\)\s*,\s*\(([^()#]+)\)\s*,\s*\.(?:UNSPECIFIED|PIECEWISE_BEZIER_KNOTS)\."
)
_POINT: Final = re.compile(rb"CARTESIAN_POINT\('',\(([^()]*)\)\)")
_LIST: Final = re.compile(rb"\((#\d+(?:\s*,\s*#\d+)+)\)")

Entities = dict[int, bytes]
Change = Callable[[Entities, Entities, random.Random], None]


def entities_of(content: bytes) -> Entities:
    """The entities of a file by their number."""
    return {int(match[1]): match[2] for match in _ENTITY.finditer(content)}


def swap_ids(own: Entities, _: Entities, chance: random.Random) -> None:
    """Exchanges the numbers of up to three pairs of entities of one kind."""
    for _ in range(chance.randint(1, 3)):
        first = chance.choice(list(own))
        kind = own[first].partition(b"(")[0]
        second = chance.choice([n for n, body in own.items() if body.partition(b"(")[0] == kind])
        own[first], own[second] = own[second], own[first]


def delete_entities(own: Entities, _: Entities, chance: random.Random) -> None:
    """Deletes up to two entities, and sometimes also takes them out of every list."""
    for number in chance.sample(list(own), min(len(own), chance.randint(1, 2))):
        del own[number]
        if chance.random() < 0.7:
            listed = re.compile(rb"#%d\s*,\s*|,\s*#%d(?=\s*\))" % (number, number))
            for other, body in own.items():
                own[other] = listed.sub(b"", body)


def change_degrees(own: Entities, _: Entities, chance: random.Random) -> None:
    """Gives a curve another degree, sometimes with as many knots as that one needs."""
    number, body = _pick(own, _CURVE, chance)
    if number is None:
        return
    degree = chance.choice((0, 1, 2, 4, 5, 9, 24, 25, 26))
    body = re.sub(rb"(B_SPLINE_CURVE_WITH_KNOTS\('',)\d+", rb"\g<1>%d" % degree, body)
    if chance.random() < 0.7:
        poles = body.partition(b"(#")[2].partition(b")")[0].count(b"#")
        inner = max(0, poles - degree - 1)
        repeats = b",".join([b"%d" % (degree + 1), *[b"1"] * inner, b"%d" % (degree + 1)])
        knots = b",".join(b"%d." % knot for knot in range(inner + 2))
        body = _KNOTS.sub(b"(%s),(%s),.UNSPECIFIED." % (repeats, knots), body)
    own[number] = body


def change_knots(own: Entities, _: Entities, chance: random.Random) -> None:
    """Moves, joins, turns round, scales or shifts the knots of a curve or a surface."""
    number, body = _pick(own, _KNOTS, chance)
    if number is None:
        return
    match = _KNOTS.search(body)
    assert match is not None
    knots = [float(part) for part in match[2].split(b",")]
    at = chance.randrange(len(knots))
    kind = chance.randrange(6)
    if kind == 0:
        knots[at] += chance.uniform(-1.0, 1.0) * (knots[-1] - knots[0]) / len(knots)
    elif kind == 1:
        knots[at] = knots[max(0, at - 1)] + chance.choice((0.0, 1e-12, 1e-7))
    elif kind == 2:
        knots.reverse()
    else:
        scale, shift = ((1e-9, 0.0), (1e9, 0.0), (1.0, 1e12))[kind - 3]
        knots = [scale * knot + shift for knot in knots]
    own[number] = body[: match.start(2)] + _numbers(knots) + body[match.end(2) :]


def change_multiplicities(own: Entities, _: Entities, chance: random.Random) -> None:
    """Moves one from a knot's multiplicity to another's: their sum stays right."""
    number, body = _pick(own, _KNOTS, chance)
    if number is None:
        return
    match = _KNOTS.search(body)
    assert match is not None
    counts = [int(part) for part in match[1].split(b",")]
    for _ in range(chance.randint(1, 3)):
        counts[chance.randrange(len(counts))] += 1
        counts[chance.randrange(len(counts))] -= 1
    own[number] = (
        body[: match.start(1)] + b",".join(b"%d" % c for c in counts) + body[match.end(1) :]
    )


def change_weights(own: Entities, _: Entities, chance: random.Random) -> None:
    """Makes a curve rational, with weights that are fine, tiny, huge, zero or negative."""
    number, body = _pick(own, re.compile(rb"^B_SPLINE_CURVE_WITH_KNOTS"), chance)
    if number is None:
        return
    parts = re.match(
        rb"B_SPLINE_CURVE_WITH_KNOTS\('',(\d+,\(.*?\),\.\w+\.,\.\w\.,\.\w\.),(.*)\)\Z",
        re.sub(rb"\s+", b"", body),
        re.DOTALL,
    )
    if parts is None:
        return
    count = parts[1].count(b"#")
    weights = [chance.uniform(0.2, 5.0) for _ in range(count)]
    for _ in range(chance.randint(0, 3)):
        odd = chance.choice((0.0, -1.0, 1e-300, 1e-12, 1e-3, 1e3, 1e12, 1e15))
        weights[chance.randrange(count)] = odd
    own[number] = (
        b"( BOUNDED_CURVE() B_SPLINE_CURVE(%s) B_SPLINE_CURVE_WITH_KNOTS(%s) CURVE()"
        b" GEOMETRIC_REPRESENTATION_ITEM() RATIONAL_B_SPLINE_CURVE((%s))"
        b" REPRESENTATION_ITEM('') )"
    ) % (parts[1], parts[2], _numbers(weights))


def mix_faces(own: Entities, other: Entities, chance: random.Random) -> None:
    """Puts faces, curves or points of another file among those of this one."""
    offset = max(own) + 1
    moved = {
        offset + number: _REFERENCE.sub(lambda m: b"#%d" % (offset + int(m[1])), body)
        for number, body in other.items()
    }
    kind = chance.choice((b"ADVANCED_FACE", b"TRIMMED_CURVE", b"B_SPLINE", b"EDGE_CURVE"))
    foreign = [number for number, body in moved.items() if body.startswith(kind)]
    ours = [number for number, body in own.items() if body.startswith(kind)]
    if not foreign or not ours:
        return
    own.update(moved)
    target, source = chance.choice(ours), chance.choice(foreign)
    for number in [n for n in own if n < offset]:
        mixed = b"#%d" % source if chance.random() < 0.5 else b"#%d,#%d" % (target, source)
        own[number] = re.sub(rb"#%d(?!\d)" % target, mixed, own[number])


def double_curves(own: Entities, _: Entities, chance: random.Random) -> None:
    """Names a part of a list twice, or a copy of it."""
    number, body = _pick(own, _LIST, chance)
    curves = [n for n, text in own.items() if text.startswith((b"GEOMETRIC_CURVE_SET", b"OPEN_SH"))]
    if curves and chance.random() < 0.7:
        number = chance.choice(curves)
        body = own[number]
    if number is None:
        return
    reference = chance.choice(_REFERENCE.findall(body) or [b"1"])
    if chance.random() < 0.5 and int(reference) in own:
        copy = max(own) + 1
        own[copy] = own[int(reference)]
        own[number] = re.sub(
            rb"#%s(?!\d)" % reference, b"#%s,#%d" % (reference, copy), body, count=1
        )
    else:
        own[number] = re.sub(rb"#%s(?!\d)" % reference, b"#%s,#%s" % (reference, reference), body)


def lay_rails_together(own: Entities, _: Entities, chance: random.Random) -> None:
    """Puts the points of one curve a hair beside those of another."""
    curves = [match[2] for body in own.values() if (match := _CURVE.search(body))]
    if len(curves) < 2:
        return
    first, second = chance.sample(curves, 2)
    hair = chance.choice((0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.1))
    numbers = [[int(n) for n in _REFERENCE.findall(curve)] for curve in (first, second)]
    for source, target in zip(*numbers, strict=False):
        point = _POINT.match(own.get(source, b""))
        if point is not None:
            moved = [float(part) + hair for part in point[1].split(b",")]
            own[target] = b"CARTESIAN_POINT('',(%s))" % _numbers(moved)


def move_points(own: Entities, _: Entities, chance: random.Random) -> None:
    """Makes points of a curve equal, straight, far away, tiny, or throws them about."""
    number, body = _pick(own, _CURVE, chance)
    if number is None:
        return
    match = _CURVE.search(body)
    assert match is not None
    kind = chance.randrange(6)
    listed = [int(n) for n in _REFERENCE.findall(match[2])]
    start = chance.randrange(len(listed))
    for i, point_number in enumerate(listed if kind else listed[start:]):
        point = _POINT.match(own.get(point_number, b""))
        if point is None:
            continue
        place = [float(part) for part in point[1].split(b",")]
        place = (
            [1.0] * len(place),
            [float(i), *[0.0] * (len(place) - 1)],
            [part + 1e7 for part in place],
            [1e-6 * part for part in place],
            [part + chance.gauss(0.0, 5.0) for part in place],
            [1e4 * part for part in place],
        )[kind]
        own[point_number] = b"CARTESIAN_POINT('',(%s))" % _numbers(place)


CHANGES: Final[tuple[Change, ...]] = (
    swap_ids,
    delete_entities,
    change_degrees,
    change_knots,
    change_multiplicities,
    change_weights,
    mix_faces,
    double_curves,
    lay_rails_together,
    move_points,
)


def restructure(content: bytes, other: bytes, chance: random.Random) -> bytes:
    """Applies one or two changes to the entities of a file; header and end stay.

    Args:
        content: a STEP file.
        other: another one, whose faces may be mixed in.
        chance: decides.
    """
    own = entities_of(content)
    if not own:
        return content
    for _ in range(chance.randint(1, 2)):
        chance.choice(CHANGES)(own, entities_of(other), chance)
    head, _, rest = content.partition(b"DATA;")
    tail = rest[rest.rindex(b"ENDSEC;") :] if b"ENDSEC;" in rest else b""
    lines = b"\n".join(b"#%d = %s;" % item for item in own.items())
    return head + b"DATA;\n" + lines + b"\n" + tail


def _pick(
    own: Entities, pattern: re.Pattern[bytes], chance: random.Random
) -> tuple[int | None, bytes]:
    found = [number for number, body in own.items() if pattern.search(body)]
    if not found:
        return None, b""
    number = chance.choice(found)
    return number, own[number]


def _numbers(values: list[float]) -> bytes:
    """Numbers as STEP writes them: with a point."""
    return b",".join(
        (f"{value:.17G}" if "." in f"{value:.17G}" else f"{value:.17G}".replace("E", ".E")).encode()
        + (b"" if "." in f"{value:.17G}" or "E" in f"{value:.17G}" else b".")
        for value in values
    )
