"""``WrinkleStrip``: what a script holds in its hand; joins the mathematics, CAD and pattern."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from wrinkle_cad.cad.rail.directrix import check_distinct, make_directrix, orient_alike
from wrinkle_cad.errors import Finding
from wrinkle_cad.options.checking import check_known
from wrinkle_cad.options.option import options_of
from wrinkle_cad.options.signature import takes_options_of

from .found_strip import found_between
from .grain import Stock
from .options import StripArguments
from .size_findings import size_findings
from .strip_findings import unused_findings
from .triangulated_strip import TriangulatedStrip

if TYPE_CHECKING:
    from build123d import Solid

    from wrinkle_cad.report.material import Material
    from wrinkle_cad.report.verdict import Verdict

    from .cut_pattern import Pattern


class WrinkleStrip(TriangulatedStrip):
    """The most developable strip between two directrices.

    Sampling and search run at once, so a curve that cannot be used raises here; surfaces and the
    unrolling are made when first asked for. A strip does not change after it was made. The rails
    are sampled with regard to each other: the strip is the same with P and Q swapped, or both
    drawn the other way.

    Args:
        p: directrix P: a build123d Edge, Wire, Sketch, builder, ShapeList or list of edges in any
            order, the same from CadQuery (anything with ``.wrapped``, or a Workplane), or an array
            (k, 3) of points in mm. It starts where its first edge, as drawn, starts.
        q: directrix Q, likewise; turned round when it runs against P, which is reported.
        options: how it is sampled, searched and made, its name and color, and the material, by
            name; ``help(WrinkleStrip.__init__)`` lists them with their units and defaults.

    Raises:
        InputError: a curve or an option cannot be used.
        CadError: the kernel could not evaluate a curve.

    Example:
        >>> import numpy as np
        >>> x = np.linspace(0.0, 100.0, 51)
        >>> lace = WrinkleStrip(
        ...     np.stack((x, 0 * x, 5 * np.sin(x / 20)), axis=1),
        ...     np.stack((x, 0 * x + 20, 5 * np.sin(x / 20)), axis=1),
        ...     tolerance=0.1,
        ...     name="lace",
        ... )
        >>> lace.report.is_developable
        True
    """

    @takes_options_of(StripArguments)
    def __init__(self, p: object, q: object, **options: Any) -> None:
        """Finds the strip."""
        check_known(options, options_of(StripArguments), "WrinkleStrip()")
        chosen = StripArguments(p, q, **options)
        given_p = make_directrix(p, name="P", join=chosen.join)
        given_q = make_directrix(q, name="Q", join=chosen.join)
        check_distinct(given_p, given_q)
        p_rail, q_rail, was_turned = orient_alike(given_p, given_q)
        found = found_between(p_rail, q_rail, chosen)
        self.material: Material | None = _material_of(p, q)
        super().__init__(
            *found.rails,
            *found.samples,
            found.triangulation,
            tolerance=chosen.tolerance,
            name=chosen.name,
            color=chosen.color,
            surface=chosen.surface,
            stock=_stock(chosen, options, self.material),
            findings=(
                *given_p.findings,
                *given_q.findings,
                *(_orientation_findings(chosen.name) if was_turned else ()),
                *unused_findings(chosen.name, found.triangulation.unused),
                *size_findings(chosen.name, found.triangulation, chosen.tolerance),
            ),
            held=found.held,
        )

    def thicken(self, thickness: float) -> Solid:
        """Returns the strip as a solid of planes, as thick everywhere, with its name and color.

        Creases are mitred. Whether parts of the strip that are far from each other along it meet
        when thickened is not checked.

        Args:
            thickness: mm, to the side that the surface faces; below 0 to the other one.

        Raises:
            InputError: no thickness, or the strip bends too sharply for it.
            CadError: the kernel makes no valid solid of it.

        Example:
            >>> import numpy as np
            >>> x = np.linspace(0.0, 100.0, 51)
            >>> flat = WrinkleStrip(np.stack((x, 0 * x), axis=1), np.stack((x, 0 * x + 20), axis=1))
            >>> round(flat.thicken(1.5).volume, 6)
            3000.0
        """
        from wrinkle_cad.cad.build123d_objects import to_build123d
        from wrinkle_cad.cad.faces.thick_solid import thick_solid

        made = thick_solid(self.triangulation, thickness)
        return cast("Solid", to_build123d(made, label=self.name, color=self.color))

    def verdict(self, **judging: Any) -> Verdict:
        """Judges the strip: PASS or FAIL by limits and by those of its material, else its state.

        Args:
            judging: a ``material``, by name or as a file, and limits by their names in a job; where
                no material is given that of P or Q counts, if build123d has one for it.

        Raises:
            InputError: a limit is unknown or out of its range.

        Example:
            >>> from build123d import Edge
            >>> p, q = Edge.make_line((0, 0), (90, 0)), Edge.make_line((0, 20), (90, 30))
            >>> WrinkleStrip(p, q).verdict(max_strain_percent=1).headline
            'PASS: gives 1%, needs 0%.'
        """
        from wrinkle_cad.report.strip_page import strip_verdict

        return strip_verdict(self, judging)

    def export_html(
        self, path: str | Path, *, pattern: Pattern | None = None, **judging: Any
    ) -> None:
        """Writes the page of the strip: verdict, figures, 3-D view, pattern, tables.

        Args:
            path: the file; replaced as a whole.
            pattern: whose pieces are shown; ``pattern()`` when None.
            judging: a ``material``, by name or as a file, and limits by their names in a job.

        Raises:
            InputError: a limit is unknown or out of its range.
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from wrinkle_cad.report.strip_page import write_strip_page

        write_strip_page(Path(path), self, pattern or self.pattern(), judging)

    def _repr_html_(self) -> str:
        """What a notebook shows: figures and the flat pattern."""
        from wrinkle_cad.report.strip_page import strip_in_notebook

        return strip_in_notebook(self)

    def as_rest_of(self, longer: WrinkleStrip) -> WrinkleStrip:
        """This strip, known to be what another one with free ends left of its rails."""
        rest = copy(self)
        unused = longer.triangulation.unused
        rest.triangulation = replace(self.triangulation, unused=unused)
        rest._noticed = (*self._noticed, *unused_findings(self.name, unused))
        return rest


def _material_of(p: object, q: object) -> Material | None:
    """What build123d says that a rail is made of."""
    from wrinkle_cad.cad.build123d_objects import material_on

    named = material_on(p) or material_on(q)
    if named is None:
        return None
    from wrinkle_cad.report.material import material_named

    return material_named(*named)


def _stock(chosen: StripArguments, given: Mapping[str, Any], material: Material | None) -> Stock:
    """What a strip is cut from: as it was asked for, and else as its material is."""
    thickness, k_factor = chosen.thickness, chosen.k_factor
    if material is not None and "thickness" not in given:
        thickness = material.thickness_mm or thickness
    if material is not None and "k_factor" not in given:
        k_factor = material.k_factor or k_factor
    name = "" if material is None else material.name
    return Stock(thickness, k_factor, chosen.grain, chosen.surface_side, name)


def _orientation_findings(name: str) -> tuple[Finding, ...]:
    message = f"P and Q of {name} ran in opposite directions: Q was turned round."
    return (Finding("rails-turned-alike", "info", message),)
