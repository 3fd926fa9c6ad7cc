from __future__ import annotations

import numpy as np
import pytest
from build123d import Solid as B3dSolid
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.kernel.topology import (
    as_edge,
    as_face,
    as_shell,
    as_wire,
    edges_of,
    faces_of,
    free_edges,
    kind_name,
    make_compound,
    make_vertex,
    shells_of,
    unwrap,
    vertex_point,
    vertices_of,
)
from wrinkle_cad.errors import CadError, InputError

BOX = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape()
CYLINDER = BRepPrimAPI_MakeCylinder(10.0, 5.0).Shape()


def test_a_shape_is_found_in_whatever_wraps_it() -> None:
    assert unwrap(BOX) is BOX
    assert unwrap(B3dSolid(BOX)).IsSame(BOX)


@pytest.mark.parametrize("source", [None, 3, "edge", TopoDS_Shape(), np.zeros((2, 3))])
def test_what_holds_no_shape_is_refused(source: object) -> None:
    with pytest.raises(InputError, match=r"is no CAD shape|is an empty shape"):
        unwrap(source)


def test_a_cast_takes_the_exact_kind_only() -> None:
    face = faces_of(BOX)[0]
    assert kind_name(as_face(face)) == "face"
    for cast in (as_edge, as_wire, as_shell):
        with pytest.raises(CadError, match="it is a face"):
            cast(face)
    with pytest.raises(CadError, match="an empty shape"):
        as_face(TopoDS_Shape())


def test_every_piece_of_a_shape_is_found_once() -> None:
    counts = [len(pieces(BOX)) for pieces in (vertices_of, edges_of, faces_of, shells_of)]
    assert counts == [8, 12, 6, 1]


def test_free_edges_bound_one_face_only() -> None:
    faces = faces_of(BOX)
    assert free_edges(BOX) == []
    assert len(free_edges(make_compound(faces[1:]))) == 4
    assert len(free_edges(make_compound(faces[:2]))) == 8


def test_a_seam_and_a_pole_are_no_free_edges() -> None:
    (side,) = (face for face in faces_of(CYLINDER) if len(edges_of(face)) == 3)
    assert len(free_edges(side)) == 2
    assert free_edges(BRepPrimAPI_MakeSphere(1.0).Shape()) == []


def test_a_vertex_stands_where_it_was_put() -> None:
    assert vertex_point(make_vertex((1, -2, 3e4))).tolist() == [1, -2, 3e4]
