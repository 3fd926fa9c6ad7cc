"""A stitched upper in a file: the body's faces as they were, wrinkles and bands in their colors."""

from __future__ import annotations

from pathlib import Path

import pytest
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.TopoDS import TopoDS_Shape

from tests.cad.makers import line
from tests.cad.measuring import bounding_box
from wrinkle_cad import settings
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.shapes import FaceStyle, NamedShape, Part
from wrinkle_cad.cad.exchange.write import write_step
from wrinkle_cad.cad.kernel.topology import faces_of, make_compound
from wrinkle_cad.cad.upper.carve import carve
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone
from wrinkle_cad.job.workflow import run_job

RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
WIDTH = 40.0


def plate() -> TopoDS_Shape:
    """Three faces side by side along x, 40 mm wide and 100 mm long, that share no edges."""
    plane = gp_Pln(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
    # The first one in the file is the middle one.
    return make_compound(
        BRepBuilderAPI_MakeFace(plane, x, x + WIDTH, 0.0, 100.0).Face() for x in (WIDTH, 0.0, 80.0)
    )


def rails(name: str, y: float, width: float = 12.0) -> list[Part]:
    return [
        Part(line((15.0, y, 0.0), (105.0, y, 0.0)), f"{name}:P"),
        Part(line((15.0, y + width, 0.0), (105.0, y + width, 0.0)), f"{name}:Q"),
    ]


def stitched_from(folder: Path, *parts: Part) -> NamedShape:
    """The upper that a job makes of some parts, as its own file has it."""
    write_step(folder / "shoe.step", parts)
    job = Job(input=folder / "shoe.step", output_dir=folder / "out", waves=(2, 2), height=(2, 2))
    done = run_job(job)
    assert isinstance(done, JobDone), done.message
    shells = [shape for shape in read_cad(folder / "out/shoe.step").shapes if shape.measure > 0.0]
    assert [shape.kind for shape in shells] == ["shell"]
    return shells[0]


def test_each_face_looks_like_what_it_was_made_from(tmp_path: Path) -> None:
    """Two wrinkles, one of them called as the body is, over faces of which two look special."""
    upper = plate()
    middle, first, _ = faces_of(upper)
    looks = [FaceStyle(middle, "vamp", RED), FaceStyle(first, "toe cap", None)]
    part = Part(upper, "upper", BLUE, looks)
    found = stitched_from(tmp_path, part, *rails("body", 20.0), *rails("b", 60.0))
    assert found.color == pytest.approx(BLUE, abs=2e-6)
    look_of = {style.name: style.color for style in found.faces}
    bands = {f"{name} {rest}" for name in ("body", "b") for rest in ("band P", "band Q")}
    assert {"vamp", "toe cap", "body", "b"} | bands <= set(look_of)
    assert look_of["vamp"] == RED
    assert look_of["toe cap"] is None
    for name in ("body", "b"):
        assert look_of[name] == pytest.approx(settings.STRIP_COLOR, abs=2e-6)
    for name in bands:
        assert look_of[name] == pytest.approx(settings.BAND_COLOR, abs=2e-6)
    for name, low in (("vamp", WIDTH), ("toe cap", 0.0)):
        own = [bounding_box(style.face)[:, 0] for style in found.faces if style.name == name]
        assert min(box[0] for box in own) == pytest.approx(low, abs=1e-5)
        assert max(box[1] for box in own) == pytest.approx(low + WIDTH, abs=1e-5)
    plain = len(faces_of(found.shape)) - len(found.faces)
    assert plain == 1


def test_an_upper_without_colors_is_grey(tmp_path: Path) -> None:
    found = stitched_from(tmp_path, Part(plate(), "upper"), *rails("toe", 40.0))
    assert found.color == pytest.approx(settings.UPPER_COLOR, abs=2e-6)
    assert {style.name.split()[0] for style in found.faces} == {"toe"}
    # The opening runs across the middle face and leaves it in two.
    assert len(faces_of(found.shape)) - len(found.faces) == 4


def test_the_faces_of_a_body_in_two_parts_know_where_they_come_from() -> None:
    """The body holds its faces part by part, each face of the upper lies in both parts."""
    upper = plate()
    ends = [line((0.0, y, 0.0), (120.0, y, 0.0)) for y in (40.0, 60.0)]
    opening = carve(upper, *ends, allow_split=True)
    assert opening.body_count == 2
    body, given = faces_of(opening.body_shape), faces_of(upper)
    assert len(body) == 6
    for face, i in zip(body, opening.face_origin, strict=True):
        assert bounding_box(face)[:, 0] == pytest.approx(bounding_box(given[i])[:, 0], abs=1e-5)
