"""The text of a STEP file (ISO 10303-21): line ends, statements, units, and what is wrong with it.

The kernel answers "no shapes" to most defects and ends the process on some, so the true cause is
looked for here, in the text. A statement is ``#12 = NAME(...)`` or ``#12 = (A(...) B(...))``;
comments and the contents of strings are dropped while scanning.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Final

from wrinkle_cad.cad.exchange.sniff import Source

_TOKEN = re.compile(rb"'(?:[^']|'')*'|/\*.*?(?:\*/|\Z)|;[\s;]*", re.DOTALL)
_HEAD = re.compile(rb"#\s*(\d+)\s*=\s*(.*)", re.DOTALL)
_END = re.compile(rb"END-ISO-10303-21\s*;")
_SECTION = re.compile(rb"(?<![\w#])(DATA|ENDSEC)\s*(?:\([^;]*\)\s*)?;")
_LIST = re.compile(rb"\(([^()]*)\)")
# Inside of a string, since a letter stands before it: the kernel reads '') and '', as an end.
_END_LIKE = re.compile(rb"(?<=[^,(\s'/])\'\'(?=\s*[),])")
_NUMERIC = re.compile(rb"\s*[-+.\d#]")
_REFERENCE = re.compile(rb"#\s*(\d+)")
_SI_PREFIX: Final = {
    b"MICRO": "micrometre",
    b"MILLI": "mm",
    b"CENTI": "cm",
    b"DECI": "dm",
    b"KILO": "km",
}
_UNIT_WORDS: Final = {
    "metre": "m",
    "meter": "m",
    "millimetre": "mm",
    "millimeter": "mm",
    "centimetre": "cm",
    "centimeter": "cm",
    "in": "inch",
    "inches": "inch",
    "foot": "ft",
    "feet": "ft",
}

Statements = dict[int, bytes]


def plain_text(content: bytes) -> bytes:
    """Returns the bytes with line feeds as the only line ends and every letter in UTF-8.

    Files written before editions with Unicode hold Latin-1; those are told by not being UTF-8.
    Apostrophes that the kernel would take for the end of their string are written another way.
    """
    text = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    text = _END_LIKE.sub(rb"\\X\\27", text)
    if text.isascii():
        return text
    try:
        text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1").encode("utf-8")
    return text


def statements(text: bytes) -> Iterator[bytes]:
    """Yields each statement without comments, its strings emptied to ``''``, one blank at most."""
    return (statement for statement, _ in quoted_statements(text))


def quoted_statements(text: bytes) -> Iterator[tuple[bytes, list[bytes]]]:
    """Yields each statement as ``statements`` does, and its strings without their quotes."""
    parts: list[bytes] = []
    strings: list[bytes] = []
    at = 0
    for token in _TOKEN.finditer(text):
        parts.append(text[at : token.start()])
        at = token.end()
        kind = text[token.start() : token.start() + 1]
        if kind == b"'":
            parts.append(b"''")
            strings.append(text[token.start() + 1 : token.end() - 1])
        elif kind == b";":
            yield b"".join(parts).strip(), strings
            parts.clear()
            strings = []


def entities(text: bytes, *keywords: bytes) -> Statements:
    """Returns the bodies of the entities in which one of the keywords occurs, by their number."""
    wanted = re.compile(rb"\b(?:" + b"|".join(keywords) + rb")\s*\(")
    if wanted.search(text) is None:
        return {}
    found: Statements = {}
    for statement in statements(text):
        head = _HEAD.match(statement)
        if head is not None and wanted.search(head[2]):
            found[int(head[1])] = head[2]
    return found


def check_step(source: Source, text: bytes) -> None:
    """Refuses what the kernel would misread, or not survive.

    Args:
        source: where the text is from, for the message.
        text: the file in ``plain_text``.

    Raises:
        InputError: the file is cut short, or a B-spline's counts contradict each other.
    """
    if _END.search(text, max(0, text.rfind(b"END-ISO-10303-21"))) is None:
        sections = [match[1] for match in _SECTION.finditer(text)]
        where = "inside DATA" if sections and sections[-1] == b"DATA" else "before its end mark"
        line = text.count(b"\n") + 1
        raise source.fail(
            f"truncated: the file ends in line {line} {where}, END-ISO-10303-21 is missing."
            " Copy or export it again."
        )
    for number, body in entities(
        text, rb"B_SPLINE_\w+_WITH_KNOTS", rb"RATIONAL_B_SPLINE_\w+"
    ).items():
        fault = _spline_fault(body)
        if fault is not None:
            raise source.fail(f"damaged: B-spline #{number} has {fault}. Export it again.")


def _spline_fault(body: bytes) -> str | None:
    """Returns what is wrong with the counts of a B-spline, or None if they agree."""
    knots_at = re.search(rb"_WITH_KNOTS", body)
    if knots_at is None:
        return None
    lists = [entry for entry in _LIST.findall(body) if _NUMERIC.match(entry)]
    counts = [entry.count(b",") + 1 for entry in lists]
    is_row = [entry.lstrip().startswith(b"#") for entry in lists]
    rows = [count for count, row in zip(counts, is_row, strict=True) if row]
    rest = [count for count, row in zip(counts, is_row, strict=True) if not row]
    is_surface = b"B_SPLINE_SURFACE" in body
    knot_lists = 4 if is_surface else 2
    if not rows or len(rest) < knot_lists:
        return "no control points or no knots"
    if len(set(rows)) > 1:
        return f"rows of {min(rows)} to {max(rows)} control points"
    return _knot_fault(rest[:knot_lists]) or (
        _weight_fault(rows, rest[knot_lists:]) if b"RATIONAL_B_SPLINE" in body else None
    )


def _knot_fault(counts: list[int]) -> str | None:
    half = len(counts) // 2
    for multiplicities, knots in zip(counts[:half], counts[half:], strict=True):
        if multiplicities != knots:
            return f"{knots} knots and {multiplicities} multiplicities"
    return None


def _weight_fault(rows: list[int], weights: list[int]) -> str | None:
    if weights == rows:
        return None
    return f"{sum(weights)} weights for {sum(rows)} control points"


def length_units(text: bytes) -> tuple[str, ...]:
    """Returns the length units that the geometry's contexts declare, in words, each once, in order.

    Units that no 3-D context refers to (drawings, validation properties) are not listed.
    """
    units = entities(text, rb"LENGTH_UNIT")
    contexts = entities(text, rb"GLOBAL_UNIT_ASSIGNED_CONTEXT")
    used: dict[str, None] = {}
    for body in contexts.values():
        if re.search(rb"GEOMETRIC_REPRESENTATION_CONTEXT\s*\(\s*2\s*\)", body):
            continue
        for number in map(int, _REFERENCE.findall(body)):
            if number in units:
                used[_unit_word(text, number, units[number])] = None
    return tuple(used)


def _unit_word(text: bytes, number: int, body: bytes) -> str:
    if b"CONVERSION_BASED_UNIT" in body:
        # The name stands in a string, which the scan has emptied.
        pattern = rb"#\s*%d\s*=[^;]*?CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'" % number
        name = re.search(pattern, text)
        word = name[1].decode("utf-8", "replace").strip().lower() if name else "unknown unit"
        return _UNIT_WORDS.get(word, word)
    si = re.search(rb"SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,", body)
    if si is None:
        return "unknown unit"
    return _SI_PREFIX.get(si[1], si[1].decode().lower()) if si[1] else "m"


def why_no_shape(text: bytes) -> str:
    """Returns why the kernel found no shape in a STEP file, in words for a message."""
    external = entities(
        text, rb"DOCUMENT_FILE", rb"APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT", rb"EXTERNAL_SOURCE"
    )
    if external:
        return "no geometry: its parts are external references to other files. Open those instead"
    tiny = _tiny_edge(text)
    if tiny is not None:
        return tiny
    if entities(text, rb"TESSELLATED_\w+", rb"TRIANGULATED_\w+", rb"COMPLEX_TRIANGULATED_\w+"):
        return "no exact geometry: only triangles (tessellation). Export as exact B-rep"
    schema = re.search(rb"FILE_SCHEMA\s*\(\s*\(\s*'([^' {]*)", text)
    name = schema[1].decode("ascii", "replace").upper() if schema else ""
    if name.startswith("STRUCTURAL_ANALYSIS") or entities(text, rb"FEA_MODEL\w*", rb"NODE"):
        return "no geometry: an analysis mesh (AP209). Export the CAD model instead"
    if name.startswith("IFC"):
        return "no geometry: a building model (IFC), not a CAD part. Export the part as STEP"
    curves = entities(text, rb"\w*CURVE\w*", rb"LINE", rb"CIRCLE", rb"\w*FACE")
    if curves and not entities(text, rb"\w*SHAPE_REPRESENTATION"):
        return f"no geometry: {len(curves)} curves and faces belong to no shape. Export it again"
    return "no geometry: no curve, face or solid in it. Export the curves and the upper"


def _tiny_edge(text: bytes) -> str | None:
    """Names an edge whose two vertices are nearer than the accuracy that the file declares."""
    accuracy = 0.0
    for body in entities(text, rb"UNCERTAINTY_MEASURE_WITH_UNIT").values():
        value = re.search(rb"LENGTH_MEASURE\s*\(\s*([-+.\dEe]+)", body)
        accuracy = max(accuracy, _number(value[1]) if value else 0.0)
    edges = entities(text, rb"EDGE_CURVE")
    if not edges or accuracy <= 0.0:
        return None
    vertices = entities(text, rb"VERTEX_POINT")
    points = entities(text, rb"CARTESIAN_POINT")
    units = length_units(text)
    unit = units[0] if len(units) == 1 else "units"
    for number, body in edges.items():
        ends = [_location(int(end), vertices, points) for end in _REFERENCE.findall(body)[:2]]
        if len(ends) < 2 or ends[0] is None or ends[1] is None or ends[0] == ends[1]:
            continue
        length = math.dist(ends[0], ends[1])
        if length <= accuracy:
            return (
                f"damaged: edge #{number} is {length:.2g} {unit} long, shorter than the accuracy"
                f" of {accuracy:.2g} {unit} that the file declares. Remove it or export again"
            )
    return None


def _location(
    vertex: int, vertices: Statements, points: Statements
) -> tuple[float, float, float] | None:
    reference = _REFERENCE.search(vertices.get(vertex, b""))
    body = points.get(int(reference[1]), b"") if reference else b""
    inner = _LIST.search(body)
    values = [_number(entry) for entry in inner[1].split(b",")] if inner else []
    return (values[0], values[1], values[2]) if len(values) == 3 else None


def _number(entry: bytes) -> float:
    try:
        return float(entry)
    except ValueError:
        return math.nan
