"""The smooth surface of a strip, or why it has none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from wrinkle_cad.errors import CadError, Finding, InputError, Severity
from wrinkle_cad.strip.rulings.held import NOTHING_HELD, Held

from .exact_surface import exact_surface, rail_curve

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shell

    from wrinkle_cad.cad.rail.directrix import Directrix
    from wrinkle_cad.strip.curve.sampling import Samples
    from wrinkle_cad.strip.rulings.smooth_path import SmoothPath
    from wrinkle_cad.strip.rulings.surface import RuledStrip
    from wrinkle_cad.strip.triangulation import Triangulation


FEW_FACES: Final = 8
"""With so many faces a strip is not asked whether it has fewer as cones."""


@dataclass(frozen=True, slots=True, eq=False)
class SmoothSurface:
    """A strip's smooth surface; where it has none, the reason."""

    made: tuple[TopoDS_Shell, SmoothPath] | None
    """Its shell, and the pieces that this consists of; None where cones stand for it."""
    findings: tuple[Finding, ...]
    """Why it has none, or which pieces are made of cones though they are developable."""


def smooth_surface(
    name: str,
    rails: tuple[Directrix, Directrix],
    samples: tuple[Samples, Samples],
    triangulation: Triangulation,
    ruled: RuledStrip,
    held: Held = NOTHING_HELD,
) -> SmoothSurface:
    """Returns the smooth surface of a strip.

    Args:
        name: of the strip.
        rails: P and Q.
        samples: of P and of Q.
        triangulation: of these samples.
        ruled: its exact surface.
        held: what was asked of its rulings.
    """
    from wrinkle_cad.cad.kernel.topology import faces_of

    from .shell import build_faces
    from .smooth_shell import build_smooth_shell

    reason = _hindrance(rails)
    if reason:
        return SmoothSurface(None, (_made_of_cones(name, reason),))
    if all(rail.is_closed for rail in rails):
        ruled = exact_surface(*rails, *samples, triangulation, held, is_cut=True)
    curves = (rail_curve(rails[0]), rail_curve(rails[1]))
    try:
        made = build_smooth_shell(ruled, curves, triangulation, rails, samples)
    except (CadError, InputError) as error:
        return SmoothSurface(None, (_made_of_cones(name, f"it cannot be built ({error})"),))
    # Where no piece is smooth, the strip's own triangulation is as good as another.
    if not made.path.runs:
        return SmoothSurface(None, tuple(_refused(name, ruled, made.path)))
    faces = len(faces_of(made.shell))
    if faces > FEW_FACES:
        cones = build_faces(triangulation, rails, samples, has_curves=True)
        count = sum(map(len, cones.values()))
        if count <= faces:
            reason = f"it has {count} faces so, and {faces} with smooth pieces"
            return SmoothSurface(None, (_made_of_cones(name, reason, "info"),))
    return SmoothSurface((made.shell, made.path), tuple(_refused(name, ruled, made.path)))


def _hindrance(rails: tuple[Directrix, Directrix]) -> str:
    """Why a strip between two rails has no smooth surface; empty if it has."""
    if any(rail.is_polyline for rail in rails):
        return "a rail is given as points, between which it is straight"
    return ""


def _made_of_cones(name: str, reason: str, severity: Severity = "warning") -> Finding:
    message = f"{name} is made of cones, not of smooth pieces: {reason}."
    return Finding("not-smooth", severity, message)


def _refused(name: str, ruled: RuledStrip, path: SmoothPath) -> list[Finding]:
    """Which pieces are made of cones because their rulings meet inside the strip."""
    if not path.refused:
        return []
    sheet, piece = ruled.sheet, path.refused[0]
    place = (sheet.p_arc[piece.first], sheet.p_arc[piece.last])
    more = len(path.refused) - 1
    message = (
        f"{name} is made of cones from {place[0]:.1f} to {place[1]:.1f} mm of P"
        f"{_more(more)}: neighbouring rulings meet inside the strip there, so that no smooth"
        " surface has them."
    )
    return [Finding("rulings-cross", "info", message)]


def _more(count: int) -> str:
    return f" and along {count} more piece{'s' if count > 1 else ''}" if count else ""
