"""One DXF entity as a plain line or mark."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from types import MappingProxyType
from typing import Final

import numpy as np
from ezdxf.entities import DXFEntity
from ezdxf.math import BSpline as EzdxfSpline
from ezdxf.math import Vec3
from ezdxf.path import make_path

from wrinkle_cad import settings
from wrinkle_cad.pattern.piece.piece import Floats, frozen
from wrinkle_cad.strip.portable import cos, sin

from . import limits

LINES: Final = frozenset({"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"})
_TEXTS: Final = frozenset({"TEXT", "MTEXT", "ATTRIB", "ATTDEF"})
_PLACES: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "LINE": ("extrusion",),
        "LWPOLYLINE": ("extrusion",),
        "POLYLINE": ("extrusion",),
        "ARC": ("center", "radius", "start_angle", "end_angle", "extrusion"),
        "CIRCLE": ("center", "radius", "extrusion"),
        "ELLIPSE": ("center", "major_axis", "ratio", "start_param", "end_param", "extrusion"),
        "SPLINE": ("extrusion",),
    }
)
"""What ezdxf takes lines apart by, by their kind."""
_SAGITTA: Final = 0.01
"""mm; how finely curves are taken apart."""
_SAGITTA_PER_SIZE: Final = 1e-4
"""... but no finer than this share of a curve's size: files may hold arcs as large as the earth."""
_SPLINE_POINTS: Final = 20_000
"""A spline is looked at in so many points at most, but in no fewer than it has controls."""


@dataclass(frozen=True, slots=True, eq=False)
class FileLine:
    """A line of any kind: (k, 2) points; a closed one does not repeat its first point."""

    space: str
    """What it stands in: a block's name, or ``ENTITIES``."""
    layer: str
    """Its layer."""
    kind: str
    """Its kind of entity, as DXF calls it."""
    points: Floats
    """(k, 2) in the file's unit; a closed line does not repeat its first point."""
    is_closed: bool
    """Whether its end is its start."""
    vertex_count: int
    """Vertices as the file states them, not those of a curve taken apart."""
    height: float
    """Largest distance from the plane z = 0."""
    is_curved: bool
    """Whether it is a curve taken apart."""
    stated: Floats
    """(s, 2) the vertices that the file states; none for arcs and splines."""

    @property
    def corners(self) -> Floats:
        """(k, 2) the vertices whose distances the file decides: as stated, where it states any."""
        return self.stated if self.is_curved and len(self.stated) else self.points


@dataclass(frozen=True, slots=True, eq=False)
class FileMark:
    """Anything that is no line: a text, a point, a hatch. ``text`` is empty for the others."""

    space: str
    """What it stands in: a block's name, or ``ENTITIES``."""
    layer: str
    """Its layer."""
    kind: str
    """Its kind of entity, as DXF calls it."""
    position: tuple[float, float]
    """(x, y)."""
    text: str
    """What it says; empty where it is no text."""


def line_of(entity: DXFEntity, space: str) -> FileLine | None:
    """Returns an entity as a line, None if it is no line or has no place in the plane."""
    kind = entity.dxftype()
    if kind not in LINES or not _has_place(entity):
        return None
    if kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
        return None
    if kind == "LINE":
        return _straight(entity, space)
    stated = _stated_vertices(entity)
    is_curved = kind in ("ARC", "CIRCLE", "ELLIPSE", "SPLINE") or bool(
        getattr(entity, "has_arc", False)
    )
    try:
        # Numbers without bounds are found below; numpy need not tell the user's screen of them.
        with np.errstate(all="ignore"):
            points = _along(entity, stated) if is_curved else stated
    # Bulges and axes that contradict each other: ezdxf has no one error for them.
    except (ArithmeticError, ValueError, RuntimeError, LookupError, TypeError):
        return None
    if not len(points) or not _is_usable(points) or not _is_usable(stated):
        return None
    is_closed = bool(getattr(entity, "is_closed", False)) and kind != "SPLINE"
    if is_curved:
        meets = len(points) > 2 and math.dist(points[0], points[-1]) < limits.ZERO
        is_closed = meets and (is_closed or kind not in ("LWPOLYLINE", "POLYLINE"))
        points = points[:-1] if is_closed else points
    return FileLine(
        space=space,
        layer=entity.dxf.layer,
        kind=kind,
        points=frozen(points[:, :2]),
        is_closed=is_closed,
        vertex_count=len(stated) or len(points),
        height=float(np.abs(points[:, 2]).max()),
        is_curved=is_curved,
        stated=frozen(stated[:, :2]),
    )


def _straight(entity: DXFEntity, space: str) -> FileLine | None:
    """Returns a LINE, of which a drawing may have a hundred thousand, without detours."""
    start, end = entity.dxf.start, entity.dxf.end
    if not _are_usable((*start, *end)):
        return None
    points = frozen(((start.x, start.y), (end.x, end.y)))
    height = max(abs(start.z), abs(end.z))
    return FileLine(
        space=space,
        layer=entity.dxf.layer,
        kind="LINE",
        points=points,
        is_closed=False,
        vertex_count=2,
        height=height,
        is_curved=False,
        stated=points,
    )


def mark_of(entity: DXFEntity, space: str) -> FileMark | None:
    """Returns an entity as a mark, None if it is a line, or its place is no number."""
    kind = entity.dxftype()
    if kind in LINES and kind != "POLYLINE":
        return None
    text = ""
    if kind in _TEXTS:
        text = entity.plain_text() if kind == "MTEXT" else str(entity.dxf.get("text", ""))
    named = [name for name in ("location", "insert") if entity.dxf.hasattr(name)]
    place = entity.dxf.get(named[0]) if named else (0.0, 0.0)
    position = (float(place[0]), float(place[1]))
    if not _are_usable(position):
        return None
    return FileMark(space, entity.dxf.layer, kind, position, text)


def _has_place(entity: DXFEntity) -> bool:
    """Whether what ezdxf would take apart has finite numbers: it may not come back from others."""
    numbers: list[float] = []
    for name in _PLACES.get(entity.dxftype(), ()):
        value = entity.dxf.get_default(name)
        numbers += [value] if isinstance(value, int | float) else list(value or ())
    if entity.dxftype() == "SPLINE":
        numbers += np.asarray(entity.control_points, dtype=np.float64).reshape(-1).tolist()
        numbers += [*entity.knots, *entity.weights]
        numbers += np.asarray(entity.fit_points, dtype=np.float64).reshape(-1).tolist()
    return _are_usable(numbers)


def _are_usable(numbers: Iterable[float]) -> bool:
    return all(abs(number) <= settings.LARGEST_COORDINATE for number in numbers)


def _is_usable(numbers: Floats) -> bool:
    # Not >: no comparison with NaN holds.
    return bool(np.all(np.abs(numbers) <= settings.LARGEST_COORDINATE))


def _along(entity: DXFEntity, stated: Floats) -> Floats:
    """Returns points (k, 3) along a curve, its first point repeated where it is closed."""
    if entity.dxftype() == "SPLINE":
        return _along_spline(entity)
    if not _is_usable(stated):
        return stated
    if entity.dxftype() in ("ARC", "CIRCLE"):
        return _along_arc(entity)
    path = make_path(entity)
    size = max((path.start.distance(point) for point in path.control_vertices()), default=0.0)
    sagitta = max(_SAGITTA, _SAGITTA_PER_SIZE * size)
    followed = islice(path.flattening(sagitta), limits.MOST_CURVE_POINTS + 1)
    points = np.array([tuple(point) for point in followed]).reshape(-1, 3)
    # Taken apart, an arc of a large radius may begin with its first point twice, to round-off.
    step = np.abs(np.diff(points, axis=0)).max(axis=1)
    return points[np.append(True, step > limits.ZERO)] if len(points) > 1 else points


def _along_arc(entity: DXFEntity) -> Floats:
    """Returns points (k, 3) along an arc or a circle, of which a drawing may have ten thousand."""
    dxf, full = entity.dxf, 2.0 * math.pi
    radius = abs(dxf.radius)
    start = math.radians(dxf.start_angle) if entity.dxftype() == "ARC" else 0.0
    turn = (math.radians(dxf.end_angle) - start) % full if entity.dxftype() == "ARC" else full
    sagitta = max(_SAGITTA, _SAGITTA_PER_SIZE * 2.0 * radius)
    step = 2.0 * math.acos(1.0 - sagitta / radius) if radius > sagitta else 0.5 * math.pi
    angles = np.linspace(
        start, start + (turn or full), max(3, math.ceil((turn or full) / step) + 1)
    )
    x, y, z = dxf.center
    points = np.column_stack(
        (x + radius * cos(angles), y + radius * sin(angles), np.full(len(angles), z))
    )
    system = entity.ocs()
    if system.transform:
        points = np.array([tuple(point) for point in system.points_to_wcs(Vec3.generate(points))])
    if not turn or turn == full:
        points[-1] = points[0]
    return points


def _along_spline(entity: DXFEntity) -> Floats:
    """Returns points (k, 3) along a spline's own domain, which a periodic one's knots exceed."""
    if not len(entity.control_points) and not len(entity.fit_points):
        return np.zeros((0, 3))
    spline = entity.construction_tool()
    knots = spline.knots()
    controls = len(spline.control_points)
    low, high = knots[spline.degree], knots[controls]
    places = np.array([tuple(point) for point in spline.control_points], dtype=np.float64)
    leg = float(np.abs(np.diff(places, axis=0)).max()) if controls > 1 else 0.0
    # A span as long as a leg that turns by a right angle leaves its chord by an eighth of it.
    wanted = math.ceil(math.sqrt(leg / (8.0 * _SAGITTA)))
    each = max(1, min(32, max(4, wanted), _SPLINE_POINTS // controls))
    parameters = np.linspace(low, high, each * controls + 1)
    return _spline_points(spline, parameters)


def _spline_points(spline: EzdxfSpline, parameters: Floats) -> Floats:
    """Returns points (k, 3); ezdxf's own evaluation takes a hundred times as long."""
    # scipy loads in a fifth of a second, and most drawings have no spline.
    from scipy.interpolate import BSpline

    controls = np.array([tuple(point) for point in spline.control_points], dtype=np.float64)
    weights = np.asarray(spline.weights() or np.ones(len(controls)), dtype=np.float64)
    rows = np.column_stack((controls * weights[:, None], weights))
    knots = np.asarray(spline.knots(), dtype=np.float64)
    found = BSpline(knots, rows, spline.degree)(parameters)
    return np.asarray(found[:, :3] / found[:, 3:])


def _stated_vertices(entity: DXFEntity) -> Floats:
    kind = entity.dxftype()
    if kind == "LWPOLYLINE":
        rows = [tuple(point) for point in entity.vertices_in_wcs()]
    elif kind == "POLYLINE":
        rows = [tuple(point) for point in entity.points_in_wcs()]
    else:
        rows = []
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
