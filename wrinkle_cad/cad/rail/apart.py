"""Whether two rails may bound a strip: they may meet at their ends, and nowhere else."""

from __future__ import annotations

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.meetings import Meeting, meetings_of
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.places import place_text
from wrinkle_cad.strip.portable import dot, norm

from .directrix import Directrix

_ADVICE = "Rails may meet at their ends only: shorten one, or move them apart."


def check_apart(p: Directrix, q: Directrix, p_samples: Samples, q_samples: Samples) -> None:
    """Checks that two rails meet at their ends at most, on the curves and not on their chords.

    They meet where they are within 1e-6 of the shorter one's length of each other. From a common
    end they may run together for a fiftieth of it, as rails do that touch there.

    Args:
        p: rail P.
        q: rail Q, in the same direction.
        p_samples: samples of P; its corners are among them.
        q_samples: samples of Q, likewise.

    Raises:
        InputError: both are points, or they cross, touch or coincide anywhere else; the message
            says where.
    """
    if p.is_point and q.is_point:
        raise InputError(
            "P and Q are a point each, and nothing lies between. A strip needs a curve: pass one"
            " for P, for Q or for both."
        )
    shorter = min(rail.length for rail in (p, q) if not rail.is_point)
    distance = settings.RAILS_APART_PER_LENGTH * shorter
    met = meetings_of(p.point_at, q.point_at, p_samples, q_samples, distance)
    longest = settings.COMMON_END_PER_LENGTH * shorter
    ends = [rail.point_at(np.array(rail.interval)) for rail in (p, q)]
    faults = [
        meeting
        for meeting in met
        if not (_is_at_ends(meeting, p, q, ends, distance) and _length(meeting) <= longest)
    ]
    if faults:
        raise InputError(f"{_sentence(faults, p, q, longest)} {_ADVICE}")


def _length(meeting: Meeting) -> float:
    return max(meeting.p_end - meeting.p_start, meeting.q_end - meeting.q_start)


def _is_at_ends(
    meeting: Meeting, p: Directrix, q: Directrix, ends: list[np.ndarray], distance: float
) -> bool:
    """Whether a meeting holds an end of each rail, and these two are one point."""
    for i, u in enumerate(p.interval):
        for j, v in enumerate(q.interval):
            holds = meeting.p_start <= u <= meeting.p_end and meeting.q_start <= v <= meeting.q_end
            if holds and norm(ends[0][i] - ends[1][j]) <= 2.0 * distance:
                return True
    return False


def _sentence(faults: list[Meeting], p: Directrix, q: Directrix, longest: float) -> str:
    """Says where two rails meet, naming the longest stretch, or else the first place."""
    size = max(p.length, q.length)
    first = max(faults, key=_length)
    if _length(first) > longest:
        start, end = (place_text(at, size) for at in (first.point, first.end_point))
        return f"P and Q coincide over some {_length(first):.3g} mm, from {start} to {end}."
    first = faults[0]
    middle = (np.array(first.point) + np.array(first.end_point)) / 2.0
    more = len(faults) - 1
    others = "" if not more else f" and at {more} more place{'s' if more > 1 else ''}"
    return f"P and Q {_verb(first, p, q)} at {place_text(middle, size)}{others}."


def _verb(meeting: Meeting, p: Directrix, q: Directrix) -> str:
    if p.is_point or q.is_point:
        return "touch"
    for rail, start, end in (
        (p, meeting.p_start, meeting.p_end),
        (q, meeting.q_start, meeting.q_end),
    ):
        if start <= rail.interval[0] or end >= rail.interval[1]:
            return "touch"
    one, other = (
        rail.tangent_at(np.array([(start + end) / 2.0]))[0]
        for rail, start, end in (
            (p, meeting.p_start, meeting.p_end),
            (q, meeting.q_start, meeting.q_end),
        )
    )
    is_steep = abs(float(dot(one, other))) < settings.CROSSING_COSINE
    return "cross" if is_steep else "touch"
