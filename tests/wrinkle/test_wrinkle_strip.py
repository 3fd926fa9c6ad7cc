from __future__ import annotations

from pathlib import Path

import build123d as b3d
import numpy as np
import pytest
from numpy.typing import NDArray

from wrinkle_cad import InputError, PieceSettings, WrinkleStrip


def arc_points(height: float, count: int = 40) -> NDArray[np.float64]:
    angle = np.linspace(0.2, np.pi - 0.2, count)
    return np.column_stack([50 * np.cos(angle), np.full(count, height), 50 * np.sin(angle)])


def spline(height: float) -> b3d.Edge:
    return b3d.Edge.make_spline([b3d.Vector(*point) for point in arc_points(height, 9)])


@pytest.fixture(scope="module")
def strip() -> WrinkleStrip:
    return WrinkleStrip(spline(0.0), spline(20.0), tolerance=0.02, name="vamp")


def test_a_strip_on_a_cylinder_is_developable(strip: WrinkleStrip) -> None:
    assert strip.report.is_developable
    assert strip.triangulation.invalid_count == strip.triangulation.inflection_count


def test_the_shell_is_a_valid_build123d_shell_with_its_label(strip: WrinkleStrip) -> None:
    shell = strip.shell()
    assert isinstance(shell, b3d.Shell)
    assert shell.is_valid
    assert shell.label == "vamp"
    assert shell.color is not None
    assert shell.area == pytest.approx(strip.report.area_3d_mm2, rel=1e-6)
    assert isinstance(strip.shell("facets"), b3d.Shell)
    assert len(strip.shell("facets").faces()) >= len(shell.faces())


def test_the_pattern_is_a_sketch_on_xy_of_the_strips_area(strip: WrinkleStrip) -> None:
    sketch = strip.pattern().sketch
    assert isinstance(sketch, b3d.Sketch)
    assert sketch.area == pytest.approx(strip.report.area_3d_mm2, rel=1e-3)
    box = sketch.bounding_box()
    assert pytest.approx((0.0, 0.0), abs=1e-9) == (box.min.Z, box.max.Z)


def test_options_of_the_pattern_go_by_name(strip: WrinkleStrip) -> None:
    (piece,) = strip.pattern(seam_allowance=(6, 6, 4, 4), size="42").pieces
    assert piece.size == "42"
    assert piece.widths == (6, 6, 4, 4)
    assert strip.pattern(PieceSettings(size="41"), size="42").pieces[0].size == "42"
    with pytest.raises(InputError, match="allowance_seam"):
        strip.pattern(allowance_seam=6)


def test_shell_and_sketch_work_inside_builders(strip: WrinkleStrip) -> None:
    with b3d.BuildPart() as part:
        b3d.insert(strip.shell())
    with b3d.BuildSketch() as sketch:
        b3d.insert(strip.pattern().sketch)
    assert sketch.sketch.area == pytest.approx(strip.report.area_pattern_mm2, rel=1e-3)
    assert part is not None


def test_rails_may_come_from_a_builder() -> None:
    with b3d.BuildLine() as p:
        b3d.Spline(*[tuple(point) for point in arc_points(0.0, 9)])
    with b3d.BuildLine() as q:
        b3d.Spline(*[tuple(point) for point in arc_points(20.0, 9)])
    assert WrinkleStrip(p.line, q.line).report.is_developable
    assert WrinkleStrip(p, q).report.is_developable


def test_every_kind_of_rail_gives_the_same_strip() -> None:
    p, q = spline(0.0), spline(20.0)
    expected = WrinkleStrip(p, q).report.area_3d_mm2
    for rails in (
        (b3d.Wire([p]), b3d.Wire([q])),
        (b3d.ShapeList([p]), [q]),
        (p.wrapped, q.wrapped),
    ):
        assert WrinkleStrip(*rails).report.area_3d_mm2 == pytest.approx(expected, rel=1e-9)


def test_points_are_taken_as_samples() -> None:
    strip = WrinkleStrip(arc_points(0.0), arc_points(20.0), surface="facets")
    assert strip.triangulation.p == pytest.approx(arc_points(0.0))
    assert strip.triangulation.invalid_count == 0


def test_rails_in_opposite_directions_are_turned_alike_and_told() -> None:
    strip = WrinkleStrip(spline(0.0), arc_points(20.0)[::-1])
    assert [finding.code for finding in strip.findings] == ["rails-turned-alike"]
    assert strip.report.is_developable


def test_the_same_rail_twice_is_refused() -> None:
    with pytest.raises(InputError, match="same curve"):
        WrinkleStrip(spline(0.0), spline(0.0))


@pytest.mark.parametrize(
    "options",
    [
        {"surface": "nurbs"},
        {"tolerance": 0.0},
        {"tolerance": float("nan")},
        {"criteria": ("beauty",)},
        {"search": "random"},
        {"energy": "none"},
    ],
)
def test_an_option_that_makes_no_sense_is_refused(options: dict[str, object]) -> None:
    with pytest.raises(InputError):
        WrinkleStrip(spline(0.0), spline(20.0), **options)


def test_facets_have_the_chords_lengths_and_cones_the_curves() -> None:
    p, q = spline(0.0), spline(20.0)
    cones = WrinkleStrip(p, q, surface="cones").report
    facets = WrinkleStrip(p, q, surface="facets").report
    assert cones.seam_lengths_mm["p"].space == pytest.approx(p.length, rel=1e-6)
    assert facets.seam_lengths_mm["p"].space < cones.seam_lengths_mm["p"].space
    for report in (cones, facets):
        for seam in report.seam_lengths_mm.values():
            assert seam.pattern == pytest.approx(seam.space, rel=1e-6)


def test_step_and_stl_are_written_from_a_script(strip: WrinkleStrip, tmp_path: Path) -> None:
    strip.export_step(tmp_path / "vamp.step")
    strip.export_step(tmp_path / "managed.step", schema="AP242")
    schemas = [(tmp_path / name).read_bytes()[:2000] for name in ("vamp.step", "managed.step")]
    assert [b"AUTOMOTIVE_DESIGN" in schema for schema in schemas] == [True, False]
    assert b"AP242_MANAGED_MODEL" in schemas[1]
    strip.export_stl(tmp_path / "vamp.stl")
    again = b3d.import_step(tmp_path / "vamp.step")
    assert again.area == pytest.approx(strip.report.area_3d_mm2, rel=1e-6)
    assert (tmp_path / "vamp.stl").stat().st_size > 84


def test_the_local_search_is_never_better_than_the_global_one() -> None:
    wavy = arc_points(20.0) + 3 * np.sin(np.linspace(0, 12, 40))[:, None] * [0, 0.2, 1]
    best = WrinkleStrip(arc_points(0.0), wavy, price=None).triangulation
    greedy = WrinkleStrip(arc_points(0.0), wavy, search="local").triangulation
    assert (best.invalid_count, best.bending) <= (greedy.invalid_count, greedy.bending)
    assert best.invalid_count > 0


def test_the_price_of_validity_stands_in_the_report() -> None:
    wavy = arc_points(20.0) + 3 * np.sin(np.linspace(0, 12, 40))[:, None] * [0, 0.2, 1]
    cheap = WrinkleStrip(arc_points(0.0), wavy, price=0.0).report
    assert (cheap.price, cheap.fold_backs) == (0.0, 0)
    dear = WrinkleStrip(arc_points(0.0), wavy, price=None).report
    assert dear.price is None
    assert dear.counted_invalid_bridges <= cheap.counted_invalid_bridges <= dear.interior_bridges
    assert dear.bending >= cheap.bending == pytest.approx(cheap.least_bending, rel=1e-9)


def test_cadquery_shapes_are_equal_guests() -> None:
    cq = pytest.importorskip("cadquery", reason="the extra cadquery is not installed")
    p = cq.Edge.makeSpline([cq.Vector(*point) for point in arc_points(0.0, 9)])
    q = cq.Wire.assembleEdges([cq.Edge.makeSpline([cq.Vector(*t) for t in arc_points(20.0, 9)])])
    strip = WrinkleStrip(p, q)
    assert strip.report.is_developable
    assert cq.Shell(strip.shell().wrapped).isValid()


def test_a_flat_strip_has_no_bend_radius_in_the_json() -> None:
    report = WrinkleStrip([[0, 0, 0], [90, 0, 0]], [[0, 20, 0], [90, 30, 0]]).report
    assert report.smallest_bend_radius_mm == np.inf
    assert report.as_json()["smallest_bend_radius_mm"] is None
    assert report.as_json()["inner_bend_radius_mm"] is None


def test_what_is_said_of_the_material_holds_for_the_pattern_as_well() -> None:
    plain = WrinkleStrip(spline(0.0), spline(20.0))
    thick = WrinkleStrip(spline(0.0), spline(20.0), thickness=2.0, k_factor=0.3, grain="across")
    as_a_job_has_it = plain.pattern(thickness=2.0, k_factor=0.3, grain="across")
    (piece,), (expected,) = thick.pattern().pieces, as_a_job_has_it.pieces
    assert np.array_equal(piece.cut_line, expected.cut_line)
    assert np.array_equal(piece.grain_line, expected.grain_line)
    assert not np.array_equal(piece.cut_line, plain.pattern().pieces[0].cut_line)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"thickness": -1}, r"^thickness cannot be -1 mm: give a number from 0 to 1000 mm\.$"),
        ({"k_factor": 1}, r"^k_factor cannot be 1: give a number above 0 and below 1\.$"),
        ({"grain": "up"}, r"^grain cannot be 'up': give along, across or 3 numbers"),
        ({"color": (0, 0, 2)}, r"^color cannot be \(0, 0, 2\): give 3 numbers from 0 to 1\.$"),
        ({"thicknes": 1}, r"^WrinkleStrip\(\) has no option 'thicknes': did you mean thickness"),
    ],
)
def test_every_option_of_a_strip_is_checked(wrong: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        WrinkleStrip(spline(0.0), spline(20.0), **wrong)  # type: ignore[arg-type]
