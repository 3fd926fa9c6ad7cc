"""An independent DXF reader for the tests: group codes only, nothing of ezdxf.

It knows sections, header variables, table entries, blocks and entities, and hands every entity out
as its tags. Polylines of both kinds come out as vertices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

Tag = tuple[int, str]


@dataclass
class Entity:
    kind: str
    tags: list[Tag]
    vertices: list[tuple[float, float]] = field(default_factory=list)
    bulges: list[float] = field(default_factory=list)

    def text(self, code, default=None):
        return next((value for found, value in self.tags if found == code), default)

    def number(self, code, default=0.0):
        value = self.text(code)
        return default if value is None else float(value)

    @property
    def layer(self):
        return self.text(8)

    @property
    def is_closed(self):
        return bool(int(self.text(70, "0")) & 1)


@dataclass
class DxfText:
    header: dict[str, list[Tag]]
    layers: list[str]
    line_types: list[str]
    blocks: dict[str, list[Entity]]
    entities: list[Entity]
    sections: list[str]
    tags: list[Tag]

    def on(self, layer, kind=None, block=None):
        space = self.entities if block is None else self.blocks[block]
        return [e for e in space if e.layer == layer and kind in (None, e.kind)]


def read_group_codes(content: bytes) -> DxfText:
    lines = content.decode("ascii").split("\n")
    if lines[-1] == "":
        lines.pop()
    assert len(lines) % 2 == 0, "a value without a group code"
    tags = [(int(lines[i]), lines[i + 1].rstrip("\r")) for i in range(0, len(lines), 2)]
    assert tags[-1] == (0, "EOF")
    dxf = DxfText({}, [], [], {}, [], [], tags)
    position = 0
    while tags[position] != (0, "EOF"):
        assert tags[position] == (0, "SECTION"), tags[position]
        name = tags[position + 1][1]
        end = next(i for i in range(position, len(tags)) if tags[i] == (0, "ENDSEC"))
        dxf.sections.append(name)
        inside = tags[position + 2 : end]
        if name == "HEADER":
            read_header(inside, dxf)
        elif name == "TABLES":
            read_tables(inside, dxf)
        elif name == "BLOCKS":
            read_blocks(inside, dxf)
        elif name == "ENTITIES":
            dxf.entities = read_entities(inside)
        position = end + 1
    return dxf


def read_header(tags, dxf):
    for code, value in tags:
        if code == 9:
            dxf.header[value] = current = []
        else:
            current.append((code, value))


def read_tables(tags, dxf):
    for part in split_at_zero(tags):
        if part[0][1] == "LAYER":
            dxf.layers.append(next(value for code, value in part if code == 2))
        elif part[0][1] == "LTYPE":
            dxf.line_types.append(next(value for code, value in part if code == 2))


def read_blocks(tags, dxf):
    parts = split_at_zero(tags)
    starts = [i for i, part in enumerate(parts) if part[0][1] == "BLOCK"]
    for start in starts:
        end = next(i for i in range(start, len(parts)) if parts[i][0][1] == "ENDBLK")
        name = next(value for code, value in parts[start] if code == 2)
        assert name not in dxf.blocks, f"block {name} twice"
        dxf.blocks[name] = read_entities([tag for part in parts[start + 1 : end] for tag in part])


def read_entities(tags):
    entities = []
    for part in split_at_zero(tags):
        kind = part[0][1]
        entity = Entity(kind, part[1:])
        if kind == "VERTEX":
            entities[-1].vertices.append((entity.number(10), entity.number(20)))
            entities[-1].bulges.append(entity.number(42))
        elif kind == "LWPOLYLINE":
            read_light_polyline(entity)
            entities.append(entity)
        elif kind != "SEQEND":
            entities.append(entity)
    return entities


def read_light_polyline(entity):
    for code, value in entity.tags:
        if code == 10:
            entity.vertices.append((float(value), math.nan))
            entity.bulges.append(0.0)
        elif code == 20:
            entity.vertices[-1] = (entity.vertices[-1][0], float(value))
        elif code == 42:
            entity.bulges[-1] = float(value)
    assert int(entity.text(90)) == len(entity.vertices)


def split_at_zero(tags):
    starts = [i for i, (code, _) in enumerate(tags) if code == 0] + [len(tags)]
    return [tags[i:j] for i, j in pairwise(starts)]


def area_of(vertices):
    """Signed area of a closed polygon: positive when it runs counter-clockwise."""
    after = vertices[1:] + vertices[:1]
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(vertices, after, strict=True))


def perimeter_of(vertices):
    after = vertices[1:] + vertices[:1]
    return sum(math.dist(a, b) for a, b in zip(vertices, after, strict=True))
