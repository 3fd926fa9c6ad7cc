"""The line at which a closed face begins is no rail, an edge that was cut there is one."""

from __future__ import annotations

from collections.abc import Callable

import build123d as b3d
import pytest

from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.rail.directrix import make_directrix
from wrinkle_cad.errors import InputError

CYLINDER = b3d.Solid.make_cylinder(10, 40)


def straight(shape: b3d.Shape) -> b3d.ShapeList[b3d.Edge]:
    return shape.edges().filter_by(b3d.GeomType.LINE)


def half_side() -> b3d.Shape:
    """Half a cylinder's side, cut along its seam, which has no neighbor there."""
    side = b3d.Face(CYLINDER.faces().filter_by(b3d.GeomType.CYLINDER)[0].wrapped)
    return b3d.split(side, b3d.Plane.XZ)


SEAMS: dict[str, Callable[[], object]] = {
    "cylinder": lambda: straight(CYLINDER)[0],
    "cone": lambda: straight(b3d.Solid.make_cone(30, 20, 50)),
    "sphere": lambda: b3d.Solid.make_sphere(9).edges().sort_by(b3d.SortBy.LENGTH)[-1],
    "torus": lambda: b3d.Solid.make_torus(20, 5).edges()[0],
    "moved": lambda: straight(b3d.Pos(5, 5, 5) * CYLINDER)[0],
    "of the kernel": lambda: straight(CYLINDER)[0].wrapped,
    "beside others": lambda: CYLINDER.faces().filter_by(b3d.GeomType.CYLINDER)[0].edges(),
}


@pytest.mark.parametrize("name", SEAMS)
def test_a_seam_is_no_rail(name: str) -> None:
    with pytest.raises(InputError, match=r"is the seam of a closed face, from .* mm: no edge of"):
        make_directrix(SEAMS[name](), name="P")


def test_the_message_names_rail_and_place() -> None:
    with pytest.raises(InputError) as caught:
        WrinkleStrip(straight(CYLINDER)[0], b3d.Line((20, 0, 0), (20, 0, 40)))
    assert str(caught.value) == (
        "Rail P is the seam of a closed face, from (10.00, 0.00, 0.00) mm to (10.00, 0.00, 40.00)"
        " mm: no edge of the design, but the line at which the program that made the face lets it"
        " begin and end. Choose another edge; if this line is meant, draw it as a curve of its own."
    )


EDGES: dict[str, Callable[[], object]] = {
    "between two faces": lambda: straight(b3d.split(CYLINDER, b3d.Plane.XZ)),
    "of a face alone": lambda: straight(half_side()),
    "of a solid of half a turn": lambda: straight(b3d.Solid.make_cylinder(10, 40, angle=180)),
}


@pytest.mark.parametrize("name", EDGES)
def test_an_edge_where_a_face_was_cut_is_a_rail_also_at_the_seam(name: str) -> None:
    for edge in EDGES[name]().filter_by(b3d.Axis.Z):
        assert make_directrix(edge).length == pytest.approx(40.0)


def test_a_circle_at_the_end_of_a_cylinder_is_a_rail() -> None:
    for edge in CYLINDER.edges().filter_by(b3d.GeomType.CIRCLE):
        assert make_directrix(edge).is_closed
