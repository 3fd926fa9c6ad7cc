from __future__ import annotations

import dataclasses

import build123d
import numpy as np
import pytest
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Shape

from shoe_examples.rails import feather_rail, vamp_rail
from shoe_examples.upper import upper_panels
from tests.cad.shoes import gaping_panels, lens_rail, opening, rails, shoe, two_panels
from wrinkle_cad.cad.kernel.curves import edge_ends
from wrinkle_cad.cad.kernel.measures import is_valid, length_of, tolerance_of
from wrinkle_cad.cad.kernel.topology import (
    edges_of,
    faces_of,
    free_edges,
    make_compound,
    make_vertex,
)
from wrinkle_cad.cad.rail.directrix import make_directrix, reversed_directrix
from wrinkle_cad.cad.upper.carve import carve, carve_shape
from wrinkle_cad.cad.upper.opening_outline import faded_margin
from wrinkle_cad.cad.upper.smooth import curve_edges, smooth_edge
from wrinkle_cad.errors import CadError, InputError


def exact_area(shape: TopoDS_Shape) -> float:
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found, 1e-12, False)
    return float(found.Mass())


def distance(point: np.ndarray, shape: TopoDS_Shape) -> float:
    return float(BRepExtrema_DistShapeShape(make_vertex(point), shape).Value())


def test_areas_of_body_and_removed_part_add_up() -> None:
    whole = exact_area(shoe())
    parts = exact_area(opening().body_shape) + exact_area(opening().removed_shape)
    assert abs(parts - whole) <= 1e-8 * whole
    assert abs(opening().area_balance) <= 1e-5 * whole
    assert exact_area(opening().removed_shape) > 100.0


def test_the_body_keeps_the_uppers_surface_and_its_own_border() -> None:
    body = opening().body_shape
    assert is_valid(body)
    (face,) = faces_of(body)
    assert face.Orientation() == shoe().Orientation()
    # Feather edge, collar, and the opening's four sides.
    assert len(free_edges(body)) == 2 + 4


def test_sides_are_edges_of_the_body_in_a_row() -> None:
    carved = carve(two_panels(), *rails(), margin=4.0)
    border = [length_of(edge) for edge in free_edges(carved.body_shape)]
    for edges in (carved.p_edges, carved.q_edges):
        assert len(edges) == 2
        assert np.linalg.norm(edge_ends(edges[0])[1] - edge_ends(edges[1])[0]) < 1e-6
        assert all(min(abs(length_of(e) - b) for b in border) < 1e-9 for e in edges)
    start = edge_ends(carved.p_edges[0])[0]
    assert np.linalg.norm(start - carved.rails[0].points[0]) < 1e-5


def test_without_margin_the_sides_are_the_rails() -> None:
    carved = opening(0.0)
    for edges, rail in (
        (carved.p_edges, carved.rail_p_curve),
        (carved.q_edges, carved.rail_q_curve),
    ):
        side = make_directrix(list(edges))
        points = side.point_at(np.linspace(*side.interval, 40))
        held = make_compound(curve_edges(rail))
        assert max(distance(point, held) for point in points) < 1e-4


def test_the_margin_is_held_in_the_middle_and_fades_to_nothing() -> None:
    held = make_compound(curve_edges(opening().rail_p_curve))
    side = make_directrix(list(opening().p_edges))
    gaps = [distance(point, held) for point in side.point_at(np.linspace(*side.interval, 41))]
    assert gaps[0] < 1e-5
    assert gaps[-1] < 1e-5
    assert all(3.9 < gap < 4.01 for gap in gaps[15:26])
    assert max(gaps) < 4.01


def test_the_faded_margin_is_a_quarter_sine_at_each_end() -> None:
    shares = np.array([0.0, 0.1, 0.2, 0.5, 0.9, 1.0])
    expected = 3.0 * np.array([0.0, np.sin(np.pi / 4), 1.0, 1.0, np.sin(np.pi / 4), 0.0])
    assert np.allclose(faded_margin(shares, 3.0, 0.2), expected, atol=1e-12)


def test_rails_off_the_upper_are_projected_and_their_distance_is_told() -> None:
    points = opening().rails[0].points + 2.0 * opening().rails[0].feet.normals
    carved = carve(shoe(), smooth_edge(points), rails()[1])
    assert carved.distances[0] == pytest.approx(2.0, abs=1e-3)
    on_rail = carved.rail_p_curve.point_at(np.linspace(*carved.rail_p_curve.interval, 30))
    assert max(distance(point, shoe()) for point in on_rail) < 1e-4


def test_rails_may_run_against_each_other() -> None:
    turned = curve_edges(reversed_directrix(make_directrix(rails()[1])))
    carved = carve(shoe(), rails()[0], turned, margin=4.0)
    assert carved.areas[2] == pytest.approx(opening().areas[2], rel=1e-6)


def test_rails_that_meet_leave_an_opening_without_ends() -> None:
    carved = carve(shoe(), lens_rail(1.0), lens_rail(-1.0), margin=2.0)
    assert carved.start_edges == ()
    assert carved.end_edges == ()
    assert is_valid(carved.body_shape)


def test_a_strip_may_end_on_the_border_and_part_the_upper_on_request() -> None:
    ends = feather_rail(shoe(), 205.0), feather_rail(shoe(), 182.0)
    with pytest.raises(InputError, match=r"cuts the upper into 2 parts, it had 1\. End the rails"):
        carve(shoe(), *ends, margin=3.0)
    carved = carve(shoe(), *ends, margin=3.0, allow_split=True)
    assert carved.ends_on_border == (True, True)
    assert carved.body_count == 2
    feather = max(free_edges(shoe()), key=length_of)
    for edge in (*carved.start_edges, *carved.end_edges):
        assert max(distance(end, feather) for end in edge_ends(edge)) < 1e-5


def test_faces_that_are_not_sewn_are_joined_and_wide_gaps_stay() -> None:
    loose = make_compound(upper_panels((0.0, 10.0, 20.0)))
    assert len(free_edges(loose)) == 8
    assert len(free_edges(carve(loose, *rails()).upper_shape)) == 4
    gaping = carve(gaping_panels(0.3), *rails())
    assert len(free_edges(gaping.upper_shape)) == 8
    jump = edge_ends(gaping.p_edges[1])[0] - edge_ends(gaping.p_edges[0])[1]
    assert np.linalg.norm(jump) == pytest.approx(0.3, abs=0.02)
    assert gaping.lost_border > 40.0
    closed = carve(gaping_panels(0.3), *rails(), join=0.5)
    assert len(free_edges(closed.upper_shape)) == 4


def test_names_and_colors_of_the_panels_stay_with_the_body() -> None:
    panels = [build123d.Face(panel) for panel in faces_of(two_panels())]
    for panel, label, color in zip(panels, ("inner", "outer"), ("red", "blue"), strict=True):
        panel.label, panel.color = label, build123d.Color(color)
    upper = build123d.Compound(label="Schaft groß", children=panels)
    carved = carve(upper, *rails(), margin=2.0)
    body = carved.body
    assert body.label == "Schaft groß"
    assert [child.label for child in body.children] == ["inner", "outer"]
    assert [tuple(child.color) for child in body.children] == [
        tuple(build123d.Color("red")),
        tuple(build123d.Color("blue")),
    ]
    assert isinstance(carved.rail_p, build123d.Edge)
    assert carved.p.length == pytest.approx(sum(map(length_of, carved.p_edges)))
    assert carved.removed.area == pytest.approx(carved.areas[2], rel=1e-4)


def test_a_single_face_keeps_its_name_and_color() -> None:
    face = build123d.Face(shoe())
    face.label, face.color = "vamp", build123d.Color("green")
    body = carve(face, *rails()).body
    assert (body.label, tuple(body.color)) == ("vamp", tuple(build123d.Color("green")))


def test_the_upper_is_not_written_to() -> None:
    before = tolerance_of(shoe()), len(edges_of(shoe())), exact_area(shoe())
    carve(shoe(), *rails(), margin=1.0)
    assert before == (
        tolerance_of(shoe()),
        len(edges_of(shoe())),
        exact_area(shoe()),
    )


def test_rails_that_cross_are_refused_with_where_and_how_far() -> None:
    p, q = vamp_rail(shoe(), 205.0, skew=30.0), vamp_rail(shoe(), 200.0, skew=-30.0)
    with pytest.raises(InputError, match=r"cross 1 times, by up to [\d.]+ mm at [\d.]+ mm"):
        carve(shoe(), p, q)


def test_rails_that_enclose_nothing_are_refused() -> None:
    with pytest.raises(InputError, match=r"enclose no area: they are .* mm apart"):
        carve(shoe(), rails()[0], rails()[0])


def test_rails_far_from_the_upper_are_refused_with_the_distance() -> None:
    far = smooth_edge(np.array([[205.0, y, 90.0] for y in (-40.0, -10.0, 10.0, 40.0)]))
    with pytest.raises(InputError, match=r"Rail P leaves the upper by \d+\.\d mm .* 10 mm"):
        carve(shoe(), far, rails()[1])
    near = smooth_edge(opening().rails[0].points + 0.5 * opening().rails[0].feet.normals)
    with pytest.raises(
        InputError, match=r"leaves the upper by 0\.5 mm .* at most 0\.1 mm is allowed"
    ):
        carve(shoe(), near, rails()[1], limit=0.1)


@pytest.mark.parametrize(
    ("options", "named"),
    [({"margin": -1.0}, "margin"), ({"fade": 0.7}, "fade"), ({"limit": np.nan}, "limit")],
)
def test_numbers_out_of_range_are_refused(options: dict[str, float], named: str) -> None:
    with pytest.raises(InputError, match=f"{named} is "):
        carve(shoe(), *rails(), **options)  # type: ignore[arg-type]


def test_an_upper_without_faces_is_refused() -> None:
    with pytest.raises(InputError, match="There is no face in the upper"):
        carve(rails()[0], *rails())


def test_areas_that_do_not_add_up_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wrinkle_cad.settings.AREA_BALANCE", -1.0)
    monkeypatch.setattr(
        "wrinkle_cad.cad.upper.carve.face_areas", lambda faces, relative_error: [1.0] * len(faces)
    )
    with pytest.raises(CadError, match="carve the upper: body and removed part have"):
        carve_shape(shoe(), dataclasses.replace(opening().request, margin=0.0))
