"""What a user asks of the rulings, in mm along the rails, for a search between their samples.

Lengths are measured along the rails as the strip has them: Q as it runs after it was turned to run
like P, a closed rail from where its curve was drawn from. Samples are put where a pinned ruling or
a forbidden stretch ends; whatever samples come to them later, they are found again by their place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.cad.rail.feet import foot_on
from wrinkle_cad.cad.rail.rail_points import points_at_arcs
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.polyline import arc_lengths, row_lengths
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.rulings.held import Held
from wrinkle_cad.strip.runs import runs_of
from wrinkle_cad.strip.triangulation import Triangulation

from .options import StripSettings

Floats = NDArray[np.float64]
Places = tuple[Floats, ...]
"""Points in space, (3,) mm each."""


@dataclass(frozen=True, slots=True, eq=False)
class RulingControl:
    """What is asked of the rulings between two rails; places are points of the rails."""

    pinned: tuple[Places, ...]
    """Its ends on P and on Q, for each pinned ruling."""
    forbidden: tuple[Places, ...]
    """First and last place on P, first and last on Q."""
    limits: dict[str, float | None] = field(default_factory=dict)
    """max_lean and fold_bound in rad, max_ruling in mm."""
    is_ring: bool = False
    """Whether the rails are closed."""

    def marked(
        self, rails: tuple[Directrix, Directrix], samples: tuple[Samples, Samples]
    ) -> tuple[Samples, Samples]:
        """Returns the samples, and others where pinned rulings and forbidden stretches end."""
        p_places = [pin[0] for pin in self.pinned]
        q_places = [pin[1] for pin in self.pinned]
        p, q = (
            _with_places(rail, own, places)
            for rail, own, places in zip(rails, samples, (p_places, q_places), strict=True)
        )
        for stretch in self.forbidden:
            p = _with_stretch(rails[0], p, stretch[:2], is_ring=self.is_ring)
            q = _with_stretch(rails[1], q, stretch[2:], is_ring=self.is_ring)
        return p, q

    def asked_of(self, p: Floats, q: Floats, *, closed: bool = False) -> dict[str, Any]:
        """Returns the arguments of ``triangulate`` for rows of samples.

        Args:
            p: (m, 3) mm; the samples of P.
            q: (n, 3) mm; the samples of Q.
            closed: whether the first ones are not repeated; else a closed strip was cut open.
        """
        is_open_ring = self.is_ring and not closed
        forbidden = [
            (*p_run, *q_run)
            for stretch in self.forbidden
            for p_run in _runs(p, stretch[:2], is_ring=self.is_ring, is_cut=is_open_ring)
            for q_run in _runs(q, stretch[2:], is_ring=self.is_ring, is_cut=is_open_ring)
        ]
        pinned = [_bridge_at(p, q, places, is_open_ring) for places in self.pinned]
        return {"pinned": pinned, "forbidden": forbidden, **self.limits}

    def held_by(self, samples: tuple[Samples, Samples], found: Triangulation) -> Held:
        """Returns what is asked, in parameters of the rails that were found.

        Args:
            samples: of P and of Q; those of a closed rail end with their first one again.
            found: their triangulation, which keeps what is asked.
        """
        return Held(
            tuple(_pinned_at(samples, found, places) for places in self.pinned),
            tuple(
                (
                    *_span(samples[0], stretch[:2], is_ring=self.is_ring),
                    *_span(samples[1], stretch[2:], is_ring=self.is_ring),
                )
                for stretch in self.forbidden
            ),
        )


def control_of(chosen: StripSettings, p: Directrix, q: Directrix, *, closed: bool) -> RulingControl:
    """Returns what the settings ask of the rulings between two rails that run alike.

    Args:
        chosen: the settings.
        p: rail P as it was drawn.
        q: rail Q, which runs as P does.
        closed: whether the rails are closed; then the user's cut is pinned, last of all.

    Raises:
        InputError: a place lies on neither rail.
    """
    rails = (p, q)
    pins = [*chosen.pinned, *([chosen.cut] if closed and not isinstance(chosen.cut, str) else [])]
    limits = {
        "max_lean": _radians(chosen.max_lean_deg),
        "max_ruling": chosen.max_ruling,
        "fold_bound": _radians(chosen.fold_bound_deg),
    }
    return RulingControl(
        pinned=tuple(_pin(rails, pin) for pin in pins),
        forbidden=tuple(_stretch(rails, ends, closed) for ends in chosen.forbidden),
        limits=limits,
        is_ring=closed,
    )


def _radians(degrees: float | None) -> float | None:
    return None if degrees is None else math.radians(degrees)


def _pin(rails: tuple[Directrix, Directrix], given: tuple[float, ...]) -> Places:
    if len(given) == 2:
        return tuple(_at_arc(rail, "PQ"[k], given[k], "pinned") for k, rail in enumerate(rails))
    if len(given) != 6:
        raise InputError(
            f"A pinned ruling has {len(given)} numbers: give two, mm along P and along Q, or six,"
            " the coordinates of its ends on P and on Q."
        )
    return tuple(
        _on_rail(rail, "PQ"[k], np.array(given[3 * k : 3 * k + 3])) for k, rail in enumerate(rails)
    )


def _stretch(
    rails: tuple[Directrix, Directrix], ends: tuple[float, float, float, float], closed: bool
) -> Places:
    for k in (0, 2):
        if ends[k] == ends[k + 1] or (ends[k] > ends[k + 1] and not closed):
            raise InputError(
                f"A forbidden stretch of {'PQ'[k // 2]} cannot go from {ends[k]:g} to"
                f" {ends[k + 1]:g} mm: its end must lie behind its start."
            )
    return tuple(_at_arc(rails[k // 2], "PQ"[k // 2], ends[k], "forbidden") for k in range(4))


def _at_arc(rail: Directrix, name: str, arc: float, option: str) -> Floats:
    if not 0.0 <= arc <= rail.length * (1.0 + settings.SPAN_SLACK):
        raise InputError(
            f"{option} names a place at {arc:g} mm of rail {name}, which is {rail.length:.6g} mm"
            " long: give a length from its start to its end."
        )
    (point,) = points_at_arcs(rail, [min(arc, rail.length)])
    return np.asarray(point, dtype=np.float64)


def _on_rail(rail: Directrix, name: str, point: Floats) -> Floats:
    (foot,) = rail.point_at(np.array([foot_on(point, rail)]))
    off = float(row_lengths(foot[None] - point[None])[0])
    if off > settings.RAIL_GAP + settings.RAIL_GAP_PER_SIZE * rail.length:
        x, y, z = point.tolist()
        raise InputError(
            f"A pinned ruling ends at ({x:g}, {y:g}, {z:g}), which is {off:.3g} mm off rail {name}:"
            " give a point of the rail."
        )
    return np.asarray(foot, dtype=np.float64)


def _with_places(rail: Directrix, samples: Samples, places: list[Floats]) -> Samples:
    """The samples and those at new places; themselves if there are none."""
    near = settings.SHORTEST_SEGMENT_PER_LENGTH * rail.length
    new = [
        foot_on(place, rail)
        for place in places
        if float(row_lengths(samples.points - place).min()) > near
    ]
    return _with_parameters(rail, samples, new)


def _with_parameters(rail: Directrix, samples: Samples, new: list[float]) -> Samples:
    if not new:
        return samples
    at = np.array(sorted(set(new)))
    parameters = np.concatenate((samples.parameters, at))
    points = np.concatenate((samples.points, rail.point_at(at)))
    order = np.argsort(parameters, kind="stable")
    return Samples(parameters[order], points[order])


def _with_stretch(rail: Directrix, samples: Samples, ends: Places, *, is_ring: bool) -> Samples:
    """The samples with both ends of a stretch, and at least one between them."""
    if rail.is_point:
        return samples
    made = _with_places(rail, samples, list(ends))
    if _inside(made.points, ends, is_ring=is_ring, is_cut=is_ring).any():
        return made
    first, last = (float(made.parameters[_nearest(made.points, end)]) for end in ends)
    length = rail.interval[1] - rail.interval[0]
    span = (last - first) % length if is_ring else last - first
    middle = first + 0.5 * span
    return _with_parameters(rail, made, [middle % length if is_ring else middle])


def _nearest(points: Floats, place: Floats) -> int:
    return int(row_lengths(points - place).argmin())


def _inside(points: Floats, ends: Places, *, is_ring: bool, is_cut: bool) -> NDArray[np.bool_]:
    """Which samples lie strictly between two places, on a ring from the first on."""
    first, last = (_nearest(points, end) for end in ends)
    numbers = np.arange(len(points))
    if not is_ring:
        # At the end of an open rail there is no other side of the stretch.
        low = first if first > 0 else -1
        high = last if last < len(points) - 1 else len(points)
        return np.asarray((numbers > low) & (numbers < high), dtype=np.bool_)
    count = len(points) - 1 if is_cut else len(points)
    behind = (numbers - first) % count
    return np.asarray((behind > 0) & (behind < (last - first) % count), dtype=np.bool_)


def _runs(points: Floats, ends: Places, *, is_ring: bool, is_cut: bool) -> list[tuple[int, int]]:
    """First and last sample of each row of samples inside a stretch."""
    if len(points) == 1:
        return [(0, 0)]
    inside = _inside(points, ends, is_ring=is_ring, is_cut=is_cut)
    return [(first, stop - 1) for first, stop in runs_of(inside)]


def _bridge_at(p: Floats, q: Floats, places: Places, is_cut: bool) -> tuple[int, int]:
    """i, j of the bridge between two places; of a sample that is repeated, the fitting one."""
    i, j = _nearest(p, places[0]), _nearest(q, places[1])
    if not is_cut:
        return i, j
    choices = [
        (a, b)
        for a in ((0, len(p) - 1) if i in (0, len(p) - 1) else (i,))
        for b in ((0, len(q) - 1) if j in (0, len(q) - 1) else (j,))
    ]
    p_arcs, q_arcs = arc_lengths(p), arc_lengths(q)
    return min(
        choices,
        key=lambda at: abs(float(p_arcs[at[0]] / p_arcs[-1] - q_arcs[at[1]] / q_arcs[-1])),
    )


def _pinned_at(
    samples: tuple[Samples, Samples], found: Triangulation, places: Places
) -> tuple[float, float]:
    """Parameters of the bridge between two places."""
    off = np.zeros(len(found.bridges))
    for own, index, place in zip(samples, found.bridges.T, places, strict=True):
        off += row_lengths(own.points[index] - place)
    i, j = found.bridges[int(off.argmin())].tolist()
    return float(samples[0].parameters[i]), float(samples[1].parameters[j])


def _span(samples: Samples, ends: Places, *, is_ring: bool) -> tuple[float, float]:
    """Parameters between which a stretch lies; on a ring the end may be on the next turn."""
    first, last = (_nearest(samples.points, end) for end in ends)
    low, high = (float(samples.parameters[k]) for k in (first, last))
    whole = float(samples.parameters[-1] - samples.parameters[0])
    if is_ring:
        return low, high if high > low else high + whole
    # At the end of an open rail there is no other side of the stretch; a point has none at all.
    beyond = max(whole, 1.0)
    count = len(samples.points)
    return low - beyond * (first == 0), high + beyond * (last == count - 1)
