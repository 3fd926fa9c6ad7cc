"""``WrinkleStrip``: what a script holds in its hand; joins the mathematics, CAD and pattern."""

from __future__ import annotations

from collections.abc import Sequence

from wrinkle_cad import settings
from wrinkle_cad.cad.rail.directrix import check_distinct, make_directrix, orient_alike
from wrinkle_cad.cad.rail.joint_samples import sample_rails
from wrinkle_cad.errors import Finding
from wrinkle_cad.strip.triangulation import triangulate

from .triangulated_strip import TriangulatedStrip, check_surface


class WrinkleStrip(TriangulatedStrip):
    """The most developable strip between two directrices.

    Sampling and search run at once, so a curve that cannot be used raises here; surfaces and the
    unrolling are made when first asked for. A strip does not change after it was made. The rails
    are sampled with regard to each other: the strip is the same with P and Q swapped, or both
    drawn the other way.

    Args:
        p: directrix P: a build123d Edge, Wire, ShapeList or list of edges, the same from CadQuery
            (anything with ``.wrapped``), or an array (k, 3) of points in mm.
        q: directrix Q, likewise; turned round when it runs against P, which is reported.
        tolerance: mm; how far a chord may lie from its curve.
        name: label of the surface and of the pattern.
        color: of the surface, (red, green, blue) from 0 to 1.
        surface: ``cones`` (banks are the exact curves) or ``facets`` (planar triangles).
        criteria: what to minimise, most important first, among ``invalid``, ``bending``,
            ``area``, ``length``.
        search: ``global`` (exact optimum) or ``local`` (LODT and LMBT).
        energy: ``hinge`` or ``paper``.
        planarity: mm; slack of the convexity test, derived from the tolerance when None.
        max_chord: mm; longest chord, unlimited when None.

    Raises:
        InputError: a curve or an option cannot be used.
        CadError: the kernel could not evaluate a curve.
    """

    def __init__(
        self,
        p: object,
        q: object,
        *,
        tolerance: float = settings.TOLERANCE,
        name: str = settings.STRIP_NAME,
        color: tuple[float, float, float] = settings.STRIP_COLOR,
        surface: str = settings.SURFACE,
        criteria: Sequence[str] = settings.CRITERIA,
        search: str = settings.SEARCH,
        energy: str = settings.ENERGY,
        planarity: float | None = None,
        max_chord: float | None = None,
    ) -> None:
        check_surface(surface)
        given_p, given_q = make_directrix(p, name="P"), make_directrix(q, name="Q")
        check_distinct(given_p, given_q)
        p_rail, q_rail, was_turned = orient_alike(given_p, given_q)
        p_samples, q_samples = sample_rails(p_rail, q_rail, tolerance, max_chord)
        triangulation = triangulate(
            p_samples.points,
            q_samples.points,
            criteria=tuple(criteria),
            search=search,
            energy=energy,
            planarity=settings.planarity_from(tolerance) if planarity is None else planarity,
        )
        super().__init__(
            p_rail,
            q_rail,
            p_samples,
            q_samples,
            triangulation,
            tolerance=tolerance,
            name=name,
            color=color,
            surface=surface,
            findings=_orientation_findings(name) if was_turned else (),
        )


def _orientation_findings(name: str) -> tuple[Finding, ...]:
    message = f"{name} - P and Q ran in opposite directions - Q was turned round"
    return (Finding("rails-turned-alike", "info", message),)
