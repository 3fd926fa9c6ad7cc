"""References between the entities of a STEP file: there, and to what they should be to.

The kernel follows a reference to nothing, or to an entity of the wrong kind, into memory that is
not its own, and the process ends. So the links of geometry and topology are checked in the text
before. Entities that are not listed here are only checked for being there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

from .text import statements

_HEAD: Final = re.compile(rb"#\s*(\w+)\s*=\s*(\(?)\s*(\w*)")
# Whatever stands after the sign: what is no number is in no file and so a fault.
_REFERENCE: Final = re.compile(rb"#\s*([^\s,()#]*)")
# No two matches try the same bytes: a run of blanks, digits or signs costs its length, not the
# square of it.
_LINE: Final = re.compile(rb"^[ \t\r]*+#\d++\s*+=", re.MULTILINE)
_HUGE: Final = re.compile(rb"(?<=[\d.])E\+?(?:[3-9]\d|\d{3,})\b|\bNaN\b|\bINF\b", re.IGNORECASE)
_MANTISSA: Final = re.compile(rb"[-+.\d]*\Z")
_SHOWN: Final = 40
_LONGEST_ID: Final = 18
"""Digits: what CAD systems count with; the kernel takes longer ones for another entity's."""

_POINT: Final = r"\w*POINT\w*"
_CURVE: Final = (
    r"\w*CURVE\w*|LINE|CIRCLE|ELLIPSE|PARABOLA|HYPERBOLA|POLYLINE|CLOTHOID|PCURVE|TRIMMED\w*"
)
_SURFACE: Final = r"PLANE|\w*SURFACE\w*"
_PLACEMENT: Final = r"AXIS2_PLACEMENT_[23]D"
_FACE: Final = r"\w*FACE\w*"
# What the references of an entity are to, in their order; the last entry holds for all further.
_KINDS: Final[dict[bytes, tuple[str, ...]]] = {
    b"VERTEX_POINT": (_POINT,),
    b"VECTOR": ("DIRECTION",),
    b"LINE": (_POINT, "VECTOR"),
    b"AXIS1_PLACEMENT": (_POINT, "DIRECTION"),
    b"AXIS2_PLACEMENT_2D": (_POINT, "DIRECTION"),
    b"AXIS2_PLACEMENT_3D": (_POINT, "DIRECTION"),
    b"CIRCLE": (_PLACEMENT,),
    b"ELLIPSE": (_PLACEMENT,),
    b"PLANE": (_PLACEMENT,),
    b"CYLINDRICAL_SURFACE": (_PLACEMENT,),
    b"CONICAL_SURFACE": (_PLACEMENT,),
    b"SPHERICAL_SURFACE": (_PLACEMENT,),
    b"TOROIDAL_SURFACE": (_PLACEMENT,),
    b"B_SPLINE_CURVE_WITH_KNOTS": (_POINT,),
    b"B_SPLINE_SURFACE_WITH_KNOTS": (_POINT,),
    b"POLYLINE": (_POINT,),
    b"TRIMMED_CURVE": (_CURVE, _POINT),
    b"SURFACE_CURVE": (_CURVE, rf"{_SURFACE}|PCURVE"),
    b"SEAM_CURVE": (_CURVE, rf"{_SURFACE}|PCURVE"),
    b"PCURVE": (_SURFACE, "DEFINITIONAL_REPRESENTATION"),
    b"EDGE_CURVE": (r"VERTEX\w*", r"VERTEX\w*", _CURVE),
    b"ORIENTED_EDGE": (r"\w*EDGE\w*",),
    b"EDGE_LOOP": (r"\w*EDGE\w*",),
    b"FACE_BOUND": (r"\w*LOOP",),
    b"FACE_OUTER_BOUND": (r"\w*LOOP",),
    b"OPEN_SHELL": (_FACE,),
    b"CLOSED_SHELL": (_FACE,),
    b"SHELL_BASED_SURFACE_MODEL": (r"\w*SHELL\w*",),
    b"MANIFOLD_SOLID_BREP": (r"\w*SHELL\w*",),
}
_PATTERNS: Final = {
    keyword: tuple(re.compile(kind.encode()) for kind in kinds) for keyword, kinds in _KINDS.items()
}
_BOUND: Final = re.compile(rb"FACE_(?:OUTER_)?BOUND")
_FACE_SURFACE: Final = re.compile(_SURFACE.encode())

Body = tuple[bytes, list[bytes], bytes]


def link_fault(text: bytes) -> str | None:
    """Returns what is wrong with the references and numbers of a STEP file, or None.

    Args:
        text: the file as ``plain_text`` returns it.
    """
    bodies = dict(_bodies(text))
    if len(bodies) < len(_LINE.findall(text)) // 2:
        return "a string or a comment that does not end swallows most of its entities"
    longest = max(bodies, key=len, default=b"")
    if len(longest) > _LONGEST_ID:
        return f"entity #{_shown(longest)} has an id of {len(longest)} digits"
    used: set[bytes] = set()
    for number, (keyword, references, _) in bodies.items():
        for reference in references:
            if reference not in bodies:
                return (
                    f"entity #{_shown(number)} refers to #{_shown(reference)},"
                    " which the file does not have"
                )
        used.update(references)
        fault = _kind_fault(keyword, references, bodies)
        if fault is not None:
            return f"{_shown(keyword)} #{_shown(number)} {fault}"
    for number in used:
        huge = _HUGE.search(bodies[number][2])
        if huge is not None:
            before = bodies[number][2][max(0, huge.start() - _SHOWN) : huge.start()]
            mantissa = _MANTISSA.search(before)
            shown = (b"" if mantissa is None else mantissa[0]) + huge[0]
            return f"entity #{_shown(number)} holds the number {_shown(shown)}"
    return None


def _bodies(text: bytes) -> Iterator[tuple[bytes, Body]]:
    """Yields each entity: number, keyword (empty if it has several), references, text."""
    for statement in statements(text):
        head = _HEAD.match(statement)
        if head is not None:
            body = statement[head.end(1) :]
            keyword = b"" if head[2] else head[3]
            yield head[1], (keyword, _REFERENCE.findall(body), body)


def _kind_fault(keyword: bytes, references: list[bytes], bodies: dict[bytes, Body]) -> str | None:
    patterns = _PATTERNS.get(keyword)
    if keyword in (b"ADVANCED_FACE", b"FACE_SURFACE") and references:
        patterns = (*[_BOUND] * (len(references) - 1), _FACE_SURFACE)
    if patterns is None:
        return None
    if len(references) < len(patterns) and keyword in _NEEDS_ALL:
        return f"has {len(references)} references of {len(patterns)}"
    for i, reference in enumerate(references):
        found = bodies[reference][0]
        # An entity of several keywords can be any kind.
        if found and not patterns[min(i, len(patterns) - 1)].fullmatch(found):
            return f"refers to #{_shown(reference)}, a {_shown(found)}"
    return None


_NEEDS_ALL: Final = frozenset(
    (b"VERTEX_POINT", b"VECTOR", b"LINE", b"EDGE_CURVE", b"ORIENTED_EDGE", b"FACE_BOUND", b"PCURVE")
)


def _shown(word: bytes) -> str:
    return word[:_SHOWN].decode("ascii", "replace")
