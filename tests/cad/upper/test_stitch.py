from __future__ import annotations

from pathlib import Path

import build123d
import numpy as np
import pytest
from OCP.BRep import BRep_Tool
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Dir, gp_Lin, gp_Pnt
from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from shoe_examples.rails import feather_rail, vamp_rail
from shoe_examples.upper import upper_surface
from tests.cad.shoes import (
    gaping_panels,
    lens_rail,
    opening,
    rails,
    shoe,
    two_panels,
    wrinkle,
)
from tests.cad.stitch_checks import (
    edges_off_their_faces,
    freecad_boolean_faults,
    freecad_report,
    reread,
    shell_faults,
    step_faults,
    stl_faults,
)
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.shapes import Part
from wrinkle_cad.cad.exchange.write import write_step
from wrinkle_cad.cad.kernel.connectivity import joined_faces
from wrinkle_cad.cad.kernel.measures import is_valid, tolerance_of
from wrinkle_cad.cad.kernel.topology import (
    as_shell,
    edges_of,
    faces_of,
    make_compound,
    make_vertex,
    shells_of,
    unwrap,
)
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix
from wrinkle_cad.cad.upper.bands import distances_from
from wrinkle_cad.cad.upper.carve import carve
from wrinkle_cad.cad.upper.opening import Opening
from wrinkle_cad.cad.upper.profiles import profile_curves
from wrinkle_cad.cad.upper.projection import UpperFaces
from wrinkle_cad.cad.upper.smooth import smooth_edge
from wrinkle_cad.cad.upper.stitch import Stitched, stitch
from wrinkle_cad.errors import CadError, InputError
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip


def stitched(carved: Opening, **waves: object) -> Stitched:
    options: dict[str, object] = {"waves": 5, "height": 3.0, "phase_deg": (0.0, 57.3), **waves}
    profiles = profile_curves(carved, **options)  # type: ignore[arg-type]
    return stitch(carved, WrinkleStrip(*profiles, name="wrinkle"))


def largest_distance(profile: Directrix, shell: TopoDS_Shape) -> float:
    """mm; of points on a profile from the nearest edge of the shell."""
    points = profile.point_at(np.linspace(*profile.interval, 301))
    held = make_compound(edges_of(shell))
    return max(BRepExtrema_DistShapeShape(make_vertex(point), held).Value() for point in points)


def points_on(part: TopoDS_Shape, count: int) -> np.ndarray:
    """Seeded points (count, 3), mm, on a part of the upper."""
    random = np.random.default_rng(5)
    faces, inside = faces_of(part), UpperFaces(part)
    found: list[np.ndarray] = []
    while len(found) < count:
        face = faces[random.integers(len(faces))]
        surface = BRep_Tool.Surface_s(face)
        u0, u1, v0, v1 = surface.Bounds()
        at = surface.Value(float(random.uniform(u0, u1)), float(random.uniform(v0, v1)))
        point = np.array([at.X(), at.Y(), at.Z()])
        if inside.feet(point[None]).distances[0] < 1e-9:
            found.append(point)
    return np.array(found)


def test_one_wrinkle_becomes_one_valid_shell_with_the_uppers_border() -> None:
    strip, whole = wrinkle()
    report = whole.report
    assert shell_faults(whole.shell_shape, report.face_count, shoe()) == []
    assert (report.free_edges_before, report.free_edges_after) == (2, 2)
    assert report.free_length_after_mm == pytest.approx(report.free_length_before_mm, abs=1e-6)
    assert report.max_edge_tolerance_mm <= 1e-4
    assert report.max_edge_tolerance_mm == tolerance_of(whole.shell_shape)
    expected = 1 + len(faces_of(strip.topods_shell())) + 2
    expected += sum(len(faces_of(band.shell)) for band in report.bands)
    assert report.face_count == len(faces_of(whole.shell_shape)) == expected
    assert abs(report.area_balance_mm2) < 1e-5 * 41_736.0


def test_the_rails_of_the_wrinkle_are_the_profiles() -> None:
    strip, whole = wrinkle()
    assert largest_distance(strip.p, whole.shell_shape) <= 1e-5
    assert largest_distance(strip.q, whole.shell_shape) <= 1e-5
    assert largest_distance(strip.p, opening().body_shape) > 1.0


def test_the_body_is_unchanged_away_from_the_opening() -> None:
    points = points_on(opening().body_shape, 1000)
    moved = UpperFaces(make_compound(dict(wrinkle()[1].parts)["body"]))
    assert moved.feet(points).distances.max() <= 1e-6
    removed = points_on(opening().removed_shape, 10)
    assert moved.feet(removed).distances.max() > 0.1


def test_the_shell_survives_a_step_file(tmp_path: Path) -> None:
    assert step_faults(wrinkle()[1], shoe(), tmp_path) == []


def test_the_mesh_is_manifold_and_faces_as_the_upper_does(tmp_path: Path) -> None:
    assert stl_faults(wrinkle()[1], shoe(), tmp_path) == []


@pytest.mark.freecad
def test_freecad_reads_one_valid_shell(freecadcmd: str, tmp_path: Path) -> None:
    path = tmp_path / "shoe.step"
    write_step(path, [Part(wrinkle()[1].shell_shape, "upper")])
    report = wrinkle()[1].report
    border = round(report.free_length_before_mm, 2)
    assert freecad_report(freecadcmd, [path], tmp_path) == [f"1 {report.face_count} True {border}"]


def test_programs_that_read_the_shell_find_every_edge_on_its_faces(tmp_path: Path) -> None:
    path = tmp_path / "shoe.step"
    write_step(path, [Part(wrinkle()[1].shell_shape, "upper")])
    shape = reread(path)
    assert edges_off_their_faces(shape) == 0
    assert tolerance_of(shape) <= 2e-7


@pytest.mark.slow
@pytest.mark.freecad
def test_freecads_check_for_boolean_operations_finds_every_edge_on_its_faces(
    freecadcmd: str, tmp_path: Path
) -> None:
    path = tmp_path / "shoe.step"
    write_step(path, [Part(wrinkle()[1].shell_shape, "upper")])
    assert freecad_boolean_faults(freecadcmd, path, tmp_path) == []


def test_a_missing_face_is_noticed(tmp_path: Path) -> None:
    whole = wrinkle()[1]
    faces = faces_of(whole.shell_shape)
    torn = Stitched(joined_faces(faces[:-1]), whole.report, whole.parts, None)
    assert any("faces of" in fault for fault in step_faults(torn, shoe(), tmp_path))
    assert any("border" in fault for fault in step_faults(torn, shoe(), tmp_path))
    assert any("border" in fault for fault in stl_faults(torn, shoe(), tmp_path))


def test_a_face_turned_over_is_noticed(tmp_path: Path) -> None:
    whole = wrinkle()[1]
    turned = Stitched(as_shell(whole.shell_shape.Reversed()), whole.report, whole.parts, None)
    assert any("normals turned" in fault for fault in stl_faults(turned, shoe(), tmp_path))


def three() -> list[tuple[TopoDS_Edge, TopoDS_Edge]]:
    return [
        (vamp_rail(shoe(), front, skew=2.0), vamp_rail(shoe(), back, skew=-2.0))
        for front, back in ((222.0, 205.0), (196.0, 180.0), (171.0, 157.0))
    ]


def stitched_three(carved: list[Opening]) -> Stitched:
    strips = [
        WrinkleStrip(*profile_curves(one, waves=5, height=2.5), name=f"w{i}")
        for i, one in enumerate(carved)
    ]
    return stitch(carved, strips)


def test_three_wrinkles_go_in_at_once(tmp_path: Path) -> None:
    in_turn: list[Opening] = []
    for pair in three():
        in_turn.append(carve(in_turn[-1].body_shape if in_turn else shoe(), *pair, margin=3.0))
    whole = stitched_three(in_turn)
    assert step_faults(whole, shoe(), tmp_path) == []
    assert {name for name, _ in whole.parts} >= {"body", "w0", "w1 band P", "w2 end 2"}


@pytest.mark.slow
def test_openings_carved_from_the_same_upper_are_carved_in_turn(tmp_path: Path) -> None:
    apart = [carve(shoe(), *pair, margin=3.0) for pair in three()[:2]]
    assert step_faults(stitched_three(apart), shoe(), tmp_path) == []


def test_a_strip_across_the_seams_of_an_upper_of_faces(tmp_path: Path) -> None:
    whole = stitched(carve(two_panels(), *rails(), margin=4.0))
    assert shell_faults(whole.shell_shape, whole.report.face_count, two_panels()) == []
    assert whole.report.max_edge_tolerance_mm <= 1e-4
    assert step_faults(whole, two_panels(), tmp_path) == []
    assert stl_faults(whole, two_panels(), tmp_path) == []


def test_a_strip_from_feather_edge_to_feather_edge_keeps_the_border(tmp_path: Path) -> None:
    ends = feather_rail(shoe(), 205.0), feather_rail(shoe(), 182.0)
    whole = stitched(carve(shoe(), *ends, margin=4.0, allow_split=True), waves=7)
    assert whole.report.free_length_after_mm == pytest.approx(
        whole.report.free_length_before_mm, abs=1e-4
    )
    assert step_faults(whole, shoe(), tmp_path) == []
    assert stl_faults(whole, shoe(), tmp_path) == []


@pytest.mark.parametrize(
    ("where", "expected_ends"),
    [
        ("across the face's own seam at the heel", (False, False)),
        ("from feather edge to collar", (True, True)),
        ("from the feather edge up the side", (True, False)),
    ],
)
def test_a_strip_anywhere_on_the_upper(
    where: str, expected_ends: tuple[bool, bool], tmp_path: Path
) -> None:
    share = np.linspace(0.0, 1.0, 61)
    p_places, q_places = {
        "across the face's own seam at the heel": (
            (18.0 + 4.0 * share, np.full(61, 0.35)),
            (18.0 + 4.0 * share, np.full(61, 0.6)),
        ),
        "from feather edge to collar": ((14.0 + 0.3 * share, share), (14.8 + 0.5 * share, share)),
        "from the feather edge up the side": (
            (14.0 + 0.3 * share, 0.7 * share),
            (14.8 + 0.5 * share, 0.7 * share),
        ),
    }[where]
    carved = carve(shoe(), rail_at(*p_places), rail_at(*q_places), margin=2.0)
    assert carved.ends_on_border == expected_ends
    whole = stitched(carved, height=1.5)
    assert shell_faults(whole.shell_shape, whole.report.face_count, shoe()) == []
    assert whole.report.max_edge_tolerance_mm <= 1e-3
    assert step_faults(whole, shoe(), tmp_path) == []


def rail_at(stations: np.ndarray, shares: np.ndarray) -> TopoDS_Edge:
    """A curve at (k,) sections around the last and (k,) shares of the way up to the collar."""
    surface = upper_surface()
    places = [surface.Value(u % 20.0, v) for u, v in zip(stations, shares, strict=True)]
    return smooth_edge(np.array([(at.X(), at.Y(), at.Z()) for at in places]))


def test_a_gap_between_faces_is_crossed_and_only_its_width_stays_open() -> None:
    upper = gaping_panels(0.3)
    carved = carve(upper, *rails(), margin=4.0)
    whole = stitched(carved)
    assert len(shells_of(whole.shell_shape)) == 1
    assert is_valid(whole.shell_shape)
    extra = whole.report.free_length_after_mm - (
        whole.report.free_length_before_mm - carved.lost_border
    )
    assert extra == pytest.approx(0.6, abs=0.05)
    closed = stitched(carve(upper, *rails(), margin=4.0, join=0.5))
    assert closed.report.free_edges_after == 4


def test_rails_that_meet_make_a_wrinkle_without_ends(tmp_path: Path) -> None:
    whole = stitched(carve(shoe(), lens_rail(1.0), lens_rail(-1.0), margin=3.0))
    assert not any("end" in name for name, _ in whole.parts)
    assert step_faults(whole, shoe(), tmp_path) == []


def test_drawn_profiles_that_end_above_the_upper_are_closed_too(tmp_path: Path) -> None:
    drawn = [
        smooth_edge(
            rail.points + (1.0 + 0.8 * np.sin(25.0 * rail.shares))[:, None] * rail.feet.normals
        )
        for rail in opening().rails
    ]
    carved = carve(shoe(), *drawn, margin=3.0)
    strip = WrinkleStrip(*drawn, name="drawn")
    whole = stitch(carved, strip)
    assert shell_faults(whole.shell_shape, whole.report.face_count, shoe()) == []
    assert largest_distance(strip.p, whole.shell_shape) <= 1e-5
    assert step_faults(whole, shoe(), tmp_path) == []


def test_profiles_on_the_boundary_are_sewn_without_bands(tmp_path: Path) -> None:
    carved = opening(0.0)
    strip = WrinkleStrip(list(carved.p_edges), list(carved.q_edges), name="flat")
    whole = stitch(carved, strip)
    assert whole.report.bands == ()
    assert step_faults(whole, shoe(), tmp_path) == []
    (along,) = [seam for seam in whole.report.seams if seam.seam == "body | flat"]
    assert along.length_mm == pytest.approx(strip.p.length + strip.q.length, abs=1e-3)


def test_seam_angles_are_those_of_a_known_bend() -> None:
    flat = read_flat_square()
    p = smooth_edge(np.column_stack((np.linspace(20, 80, 21), np.full(21, 60.0), np.zeros(21))))
    q = smooth_edge(np.column_stack((np.linspace(20, 80, 21), np.full(21, 40.0), np.zeros(21))))
    carved = carve(flat, p, q, margin=5.0, fade=0.05)
    whole = stitched(carved, height=lambda arc: 5.0 * np.sin(np.pi * arc / 60.0) ** 0.5)
    (seam,) = [seam for seam in whole.report.seams if seam.seam == "body | wrinkle band P"]
    assert np.degrees(seam.mean) == pytest.approx(42.0, abs=6.0)


def read_flat_square() -> TopoDS_Shape:
    return unwrap(build123d.Face.make_rect(100, 100).moved(build123d.Location((50, 50, 0))))


def test_the_result_is_a_build123d_shell_named_as_the_upper() -> None:
    face = build123d.Face(shoe())
    face.label = "Schaft"
    face.color = build123d.Color("green")
    carved = carve(face, *rails(), margin=4.0)
    shell = stitched(carved).shell
    assert isinstance(shell, build123d.Shell)
    assert (shell.label, tuple(shell.color)) == ("Schaft", tuple(build123d.Color("green")))
    assert shell.is_valid


def test_as_many_strips_as_openings_are_needed() -> None:
    with pytest.raises(InputError, match="2 openings and 1 strips"):
        stitch([opening(), opening()], wrinkle()[0])


def test_profiles_of_another_opening_are_refused() -> None:
    elsewhere = carve(shoe(), *three()[2], margin=3.0)
    with pytest.raises(InputError, match=r"ends of profile P are [\d.]+ mm from those"):
        stitch(elsewhere, wrinkle()[0])


def test_facets_with_chords_off_their_rails_are_refused_and_those_of_straight_rails_sewn() -> None:
    wavy = WrinkleStrip(*profile_curves(opening(), waves=5, height=3.0), surface="facets")
    with pytest.raises(InputError, match=r"made of facets, whose chords leave its rails by 0\.0"):
        stitch(opening(), wavy)
    p, q = (
        build123d.Edge.make_line((-40, -8), (40, -8)),
        build123d.Edge.make_line((-40, 8), (40, 8)),
    )
    flat = carve(build123d.Face.make_rect(100, 60), p, q)
    assert stitch(flat, WrinkleStrip(p, q, surface="facets")).report.is_valid


def test_a_wave_without_margin_is_refused_since_its_band_would_close_up() -> None:
    with pytest.raises(InputError, match=r"touches the opening's boundary .* carve with a margin"):
        stitched(opening(0.0))


def test_a_wave_so_high_that_the_band_folds_over_is_refused() -> None:
    low = carve(shoe(), *rails(), margin=1.0)
    with pytest.raises(
        InputError,
        match=r"band along P is up to [\d.]+ mm wide and \d+% of it folds over: it faces into the"
        r" upper, most at \([-\d., ]+\) mm",
    ):
        stitched(low, waves=8, height=40.0, side="in")
    with pytest.raises(InputError, match=r"folds over.* at \([-\d., ]+\) mm"):
        stitched(low, waves=8, height=4.0, across=-4.0)


def test_a_border_that_is_not_the_uppers_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wrinkle_cad.cad.upper.stitch.end_fan", lambda *_: ())
    with pytest.raises(
        CadError, match=r"compare the border .* \d+ of the \d+ free edges.* the first at \("
    ):
        stitched(opening())


def test_faces_that_are_not_one_shell_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wrinkle_cad.cad.upper.stitch.make_band", lambda *_, **__: None)
    monkeypatch.setattr("wrinkle_cad.cad.upper.stitch.end_fan", lambda *_: ())
    with pytest.raises(
        CadError, match=r"sew the wrinkle to the body: found 1 shells, the first of \d+ faces"
    ):
        stitched(opening())


def test_the_width_of_a_band_is_measured_exactly_on_a_curve_of_uneven_speed() -> None:
    share = np.linspace(0.0, 1.0, 41) ** 3
    side = make_directrix(smooth_edge(np.column_stack((share * 100, share * 0, share * 0))))
    points = np.column_stack((np.linspace(0.0, 100.0, 77), np.full(77, 3.0), np.full(77, 4.0)))
    assert np.allclose(distances_from(points, side), 5.0, atol=1e-9)
    on_curve = side.point_at(np.linspace(*side.interval, 77))
    assert distances_from(on_curve, side).max() < 1e-9


def shot(
    shape: TopoDS_Shape, rays: list[tuple[tuple[float, ...], tuple[float, ...]]]
) -> TopoDS_Edge:
    """A curve through the first hits of rays on a shape."""
    shooter = IntCurvesFace_ShapeIntersector()
    shooter.Load(shape, 1e-7)
    points = []
    for origin, direction in rays:
        shooter.Perform(gp_Lin(gp_Pnt(*origin), gp_Dir(*direction)), -1e6, 1e6)
        hits = [(shooter.WParameter(i), i) for i in range(1, shooter.NbPnt() + 1)]
        hit = shooter.Pnt(min(hits)[1])
        points.append((hit.X(), hit.Y(), hit.Z()))
    return smooth_edge(np.array(points))


def check_real(
    upper: TopoDS_Shape,
    p: TopoDS_Edge,
    q: TopoDS_Edge,
    size: float,
    tmp_path: Path,
    freecadcmd: str,
) -> Opening:
    carved = carve(upper, p, q, margin=0.006 * size)
    whole = stitched(carved, height=0.004 * size)
    assert shell_faults(whole.shell_shape, whole.report.face_count, upper) == []
    assert whole.report.max_edge_tolerance_mm <= 1e-6 * size
    assert step_faults(whole, upper, tmp_path) == []
    assert stl_faults(whole, upper, tmp_path, tolerance=1e-4 * size) == []
    path = tmp_path / "real.step"
    write_step(path, [Part(whole.shell_shape, "upper")])
    (seen,) = freecad_report(freecadcmd, [path], tmp_path)
    assert seen.split()[:3] == ["1", str(whole.report.face_count), "True"]
    return carved


@pytest.mark.realdata
@pytest.mark.freecad
def test_a_ship_hull_is_carved_and_stitched(
    realdata: Path, tmp_path: Path, freecadcmd: str
) -> None:
    (hull,) = read_cad(realdata / "wigley_hull.step").surfaces()

    def rail(z: float) -> TopoDS_Edge:
        return shot(
            hull.shape,
            [((float(x), 1e3, z), (0.0, -1.0, 0.0)) for x in np.linspace(-500.0, 500.0, 61)],
        )

    check_real(hull.shape, rail(40.0), rail(-40.0), 2500.0, tmp_path, freecadcmd)


@pytest.mark.slow
@pytest.mark.realdata
@pytest.mark.freecad
def test_a_wing_is_carved_across_two_faces_and_stitched(
    realdata: Path, tmp_path: Path, freecadcmd: str
) -> None:
    wing = max(read_cad(realdata / "wing_with_guides.igs").surfaces(), key=lambda s: s.measure)

    def rail(offset: float) -> TopoDS_Edge:
        return shot(
            wing.shape,
            [
                ((15500.0 + offset + 0.35 * (y - 800.0), float(y), 5e3), (0.0, 0.0, -1.0))
                for y in np.linspace(800.0, 3500.0, 61)
            ],
        )

    carved = check_real(wing.shape, rail(0.0), rail(300.0), 17000.0, tmp_path, freecadcmd)
    assert len(carved.p_edges) == len(carved.q_edges) == 2


def test_reread_shapes_are_judged_by_the_same_measure(tmp_path: Path) -> None:
    path = tmp_path / "upper.step"
    write_step(path, [Part(shoe(), "upper")])
    assert shell_faults(reread(path), 1, shoe()) == []
