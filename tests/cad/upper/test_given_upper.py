"""An upper may be any object of build123d or CadQuery; a closed one gives a solid again."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from build123d import (
    Box,
    BuildPart,
    BuildSketch,
    Color,
    Compound,
    Edge,
    Face,
    Plane,
    Rectangle,
    Solid,
    import_step,
)

from wrinkle_cad import WrinkleStrip, carve, stitch, wrinkle_profiles
from wrinkle_cad.cad.upper.carve import carve_all
from wrinkle_cad.cad.upper.given_upper import upper_shape
from wrinkle_cad.errors import InputError

P = Edge.make_line((-40, -8, 10), (40, -8, 10))
Q = Edge.make_line((-40, 8, 10), (40, 8, 10))
AREA = 2.0 * (100 * 60 + 100 * 20 + 60 * 20)
BOX = Solid.make_box(100, 60, 20, Plane((-50, -30, -10)))


def built_part():
    with BuildPart() as builder:
        Box(100, 60, 20)
    return builder


def built_sketch():
    with BuildSketch(Plane.XY.offset(10)) as builder:
        Rectangle(100, 60)
    return builder


def hollow():
    return BOX - Solid.make_box(10, 10, 4, Plane((0, 0, -5)))


@pytest.mark.parametrize(
    ("upper", "area"),
    {
        "face": (BOX.faces().sort_by()[-1], 6000.0),
        "shell": (BOX.shell(), AREA),
        "solid": (BOX, AREA),
        "solid with a hollow": (hollow(), AREA),
        "faces": (BOX.faces(), AREA),
        "plain list": ([*BOX.faces()], AREA),
        "compound": (Compound([BOX]), AREA),
        "part": (Box(100, 60, 20), AREA),
        "builder of a part": (built_part(), AREA),
        "builder of a sketch": (built_sketch(), 6000.0),
        "workplane": (SimpleNamespace(vals=lambda: [BOX]), AREA),
        "kernel's shape": (BOX.wrapped, AREA),
    }.values(),
)
def test_whatever_holds_faces_is_an_upper(upper, area):
    opening = carve(upper, P, Q, margin=2.0)
    whole = opening.body.area + opening.removed.area
    assert whole == pytest.approx(area, rel=1e-9)


def test_a_workplane_of_cadquery_is_an_upper():
    cadquery = pytest.importorskip("cadquery")
    faces = cadquery.Workplane().box(100, 60, 20).faces(">Z")
    assert carve(faces, P, Q).removed.area == pytest.approx(80.0 * 16.0)
    assert len(carve_all(faces, [(P, Q)])) == 1


@pytest.mark.parametrize("upper", [None, "face", 3, [], P, [P], Compound([])])
def test_what_holds_no_face_is_refused_in_a_sentence(upper):
    with pytest.raises(InputError, match=r"upper.*\. Pass a face"):
        upper_shape(upper)


def wrinkled(upper):
    opening = carve(upper, P, Q, margin=2.0)
    profiles = wrinkle_profiles(opening, waves=3, height=2)
    return stitch(opening, WrinkleStrip(*profiles, name="wrinkle"))


@pytest.fixture(scope="module")
def boot():
    boot = Solid.make_box(100, 60, 20, Plane((-50, -30, -10)))
    boot.label, boot.color = "boot", Color("red")
    return wrinkled(boot)


def test_a_closed_upper_gives_a_solid(boot):
    solid = boot.solid()
    assert solid.is_valid
    assert solid.label == "boot"
    # Waves stand on the box, to the outside only.
    assert 120_000.0 < solid.volume < 120_000.0 + 80.0 * 20.0 * 2.0
    assert solid.area == pytest.approx(boot.report.area_mm2)


def test_an_upper_with_a_border_is_no_solid():
    with pytest.raises(InputError, match=r"border of 320 mm, so it bounds no solid"):
        wrinkled(Face.make_rect(100, 60, Plane.XY.offset(10))).solid()


def test_what_was_stitched_is_written_with_its_names(boot, tmp_path):
    boot.export_step(tmp_path / "boot.step")
    boot.export_stl(tmp_path / "boot.stl")
    read = import_step(tmp_path / "boot.step")
    assert read.is_valid
    assert read.label == "boot"
    assert len(read.faces()) == boot.report.face_count
    text = (tmp_path / "boot.step").read_text()
    for name, _ in boot.parts:
        assert f"'{name}'" in text
    assert (tmp_path / "boot.stl").stat().st_size > 84 + 50 * boot.report.face_count
