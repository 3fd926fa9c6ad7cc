r"""The kernel's STEP text -> the text that goes to disk: header, names, colors.

The kernel encodes names as it likes and orders colors by memory addresses, so it writes neither
here: products and faces get placeholder names, which are replaced by names in the standard's own
encoding (``\X2\``), and the colors are added after the last entity in the order of the parts.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final

from wrinkle_cad.cad.exchange.shapes import Part
from wrinkle_cad.errors import CadError
from wrinkle_cad.files.names import one_line

from .colors import Colored, color_lines, holders

_EPOCH: Final = datetime(1970, 1, 1, tzinfo=UTC)
_PLACEHOLDER: Final = re.compile(rb"'wrinkle-(?:part-(\d{6})|face-(\d{6})-(\d{6}))'")
# The kernel's own strings hold no semicolon, so a statement ends at the first one.
_PRODUCT: Final = re.compile(rb"#(\d+) = PRODUCT\(\s*'wrinkle-part-(\d{6})'")
_FACE: Final = re.compile(rb"#(\d+) = ADVANCED_FACE\(\s*'wrinkle-face-(\d{6})-(\d{6})'")
_STRUCTURE: Final = re.compile(
    rb"#(\d+) = (PRODUCT_DEFINITION(?:_FORMATION|_SHAPE)?|\w*SHAPE_(?:DEFINITION_)?REPRESENTATION)"
    rb"\(([^;]*)\);"
)
_PLACEMENT: Final = re.compile(rb"#(\d+) = AXIS2_PLACEMENT_3D\(")
_LAST: Final = re.compile(rb"#(\d+) = ")
_NUMBER: Final = re.compile(rb"#(\d+)")
# The kernel takes an apostrophe before one of these for the end of the string, doubled or not.
_END_LIKE: Final = re.compile(r"'(?=\s*[),])")
_STRING_LIMIT: Final = 32767


@dataclass(frozen=True, slots=True, eq=False)
class Header:
    """What the header of a STEP file says about the file."""

    file_name: str
    """The file's own name."""
    timestamp: datetime | None = None
    """When it was written; the start of 1970 when None."""


def placeholder(i: int) -> str:
    """Returns the name under which the kernel is to write part ``i``."""
    return f"wrinkle-part-{i:06d}"


def face_placeholder(i: int, k: int) -> str:
    """Returns the name under which the kernel is to write the face of style ``k`` of part ``i``."""
    return f"wrinkle-face-{i:06d}-{k:06d}"


def encoded(text: str) -> bytes:
    """Returns a text as a STEP string with its quotes: ASCII only, whatever the text holds."""
    shown = one_line(text)[:_STRING_LIMIT]
    pieces = [b"'"]
    for run in re.findall(r"[ -~]+|[^ -~]+", shown):
        if run.isascii():
            run = _END_LIKE.sub(r"\\X\\27", run.replace("\\", "\\\\"))
            pieces.append(run.replace("'", "''").encode())
        else:
            wide = any(ord(letter) > 0xFFFF for letter in run)
            digits = run.encode("utf-32-be" if wide else "utf-16-be").hex().upper()
            pieces.append(f"\\X{4 if wide else 2}\\{digits}\\X0\\".encode())
    return b"".join([*pieces, b"'"])


def finished_text(raw: bytes, parts: Sequence[Part], header: Header) -> bytes:
    """Returns the file's text with its own header, and the names and colors of parts and faces.

    Args:
        raw: what the kernel wrote for the parts, under placeholder names.
        parts: in the order in which the kernel got them, with the faces in the order in which they
            got their placeholders.
        header: what the header is to say.

    Raises:
        CadError: the kernel left a part or a face out.
    """
    text = raw.replace(b"\r\n", b"\n")
    start = text.index(b"\nDATA;")
    end = text.rindex(b"ENDSEC;")
    data = text[start + 1 : end]
    styles = _styles(data, parts)
    data = _PLACEHOLDER.sub(lambda match: _name(match, parts), data)
    schema = re.search(rb"FILE_SCHEMA\(.*?\);", text[:start], re.DOTALL)
    if schema is None:
        raise CadError("write STEP", "the CAD kernel wrote no schema. Check the shapes.")
    head = _header(header, schema[0])
    return b"".join([head, data, styles, b"ENDSEC;\nEND-ISO-10303-21;\n"])


def _name(match: re.Match[bytes], parts: Sequence[Part]) -> bytes:
    part, face_part, face = match.groups()
    if part is not None:
        return encoded(parts[int(part)].name)
    return encoded(parts[int(face_part)].faces[int(face)].name)


def _header(header: Header, schema: bytes) -> bytes:
    when = (header.timestamp or _EPOCH).replace(microsecond=0, tzinfo=None).isoformat()
    file_name = b",".join(
        [
            encoded(header.file_name),
            encoded(when),
            b"('')",
            b"('')",
            b"'Open CASCADE'",
            b"'wrinkle-cad'",
            b"''",
        ]
    )
    lines = (
        b"ISO-10303-21;",
        b"HEADER;",
        b"FILE_DESCRIPTION(('wrinkle-cad'),'2;1');",
        b"FILE_NAME(" + file_name + b");",
        schema.replace(b"\n", b""),
        b"ENDSEC;\n",
    )
    return b"\n".join(lines)


def _styles(data: bytes, parts: Sequence[Part]) -> bytes:
    """Returns the entities that color the parts, numbered after the last one of the data."""
    items = _items_of_parts(data)
    missing = [i for i in range(len(parts)) if i not in items]
    if missing:
        name = one_line(parts[missing[0]].name)
        raise CadError("write STEP", f"the CAD kernel left out part '{name}'. Check its shape.")
    faces = _numbers_of_faces(data, parts)
    holder_of = holders(data) if faces else {}
    following = max(int(match[1]) for match in _LAST.finditer(data)) + 1
    lines: list[bytes] = []
    for i, part in enumerate(parts):
        others = [
            (faces[i, k], style.color)
            for k, style in enumerate(part.faces)
            if style.color is not None
        ]
        colored = Colored(*items[i], part.color, others)
        lines += color_lines(colored, following + len(lines), holder_of)
    return b"".join(line + b"\n" for line in lines)


def _numbers_of_faces(data: bytes, parts: Sequence[Part]) -> dict[tuple[int, int], int]:
    """Returns the number of each face's entity by its part and its place among the styles."""
    found = {(int(match[2]), int(match[3])): int(match[1]) for match in _FACE.finditer(data)}
    for i, part in enumerate(parts):
        missing = sum((i, k) not in found for k in range(len(part.faces)))
        if missing:
            name = one_line(part.name)
            raise CadError(
                "write STEP",
                f"the CAD kernel left out {missing} of {len(part.faces)} named or colored faces of"
                f" part '{name}'. Check its shape.",
            )
    return found


def _items_of_parts(data: bytes) -> dict[int, tuple[int, list[int]]]:
    """Returns for each part the number of its context and those of its geometric items."""
    part_of = {int(match[1]): int(match[2]) for match in _PRODUCT.finditer(data)}
    items: dict[int, list[int]] = {}
    links: dict[bytes, list[list[int]]] = {}
    for match in _STRUCTURE.finditer(data):
        numbers = [int(number) for number in _NUMBER.findall(match[3])]
        if match[2] == b"SHAPE_DEFINITION_REPRESENTATION" or b"PRODUCT" in match[2]:
            links.setdefault(match[2], []).append([int(match[1]), *numbers])
        else:
            items[int(match[1])] = numbers
    for keyword in (b"PRODUCT_DEFINITION_FORMATION", b"PRODUCT_DEFINITION"):
        part_of |= _followed(links.get(keyword, []), part_of)
    part_of |= _followed(links.get(b"PRODUCT_DEFINITION_SHAPE", []), part_of)
    placements = {int(match[1]) for match in _PLACEMENT.finditer(data)}
    found: dict[int, tuple[int, list[int]]] = {}
    for _, shape, representation in links.get(b"SHAPE_DEFINITION_REPRESENTATION", []):
        if shape in part_of and representation in items:
            *inner, context = items[representation]
            shapes = [number for number in inner if number not in placements]
            if shapes:
                found[part_of[shape]] = (context, shapes)
    return found


def _followed(links: list[list[int]], part_of: dict[int, int]) -> dict[int, int]:
    """Returns the part that each linking entity leads to."""
    return {number: part_of[to] for number, to, *_ in links if to in part_of}
