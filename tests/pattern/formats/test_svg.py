from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from tests.pattern import strips
from tests.pattern.group_codes import area_of
from tests.pattern.strips import make_pieces
from wrinkle_cad.errors import ExportError, InputError
from wrinkle_cad.pattern.formats.svg import svg_bytes, write_svg
from wrinkle_cad.pattern.piece.options import PieceSettings
from wrinkle_cad.pattern.piece.stacking import laid_out

from .test_dxf import FULL

SVG = "{http://www.w3.org/2000/svg}"


def read(content):
    root = ET.fromstring(content)
    groups = {group.get("id"): group for group in root.iter(SVG + "g")}
    return root, groups


def points_of(element):
    return [tuple(map(float, pair.split(","))) for pair in element.get("points").split()]


def test_one_user_unit_is_one_millimetre():
    root, _ = read(svg_bytes(make_pieces(*strips.rectangle(), name="part")))
    _, _, width, height = map(float, root.get("viewBox").split())
    assert root.get("width") == f"{width:g}mm"
    assert root.get("height") == f"{height:g}mm"


def test_the_cut_line_has_its_size_and_is_not_mirrored():
    pieces = make_pieces(*strips.random_strip(1), name="part")
    _, groups = read(svg_bytes(pieces))
    (cut,) = groups["layer-CUT"].findall(SVG + "polygon")
    drawn = np.array(points_of(cut)) * (1.0, -1.0)
    (piece,) = laid_out(pieces)
    shift = drawn[0] - piece.cut_line[0]
    assert np.allclose(drawn - shift, piece.cut_line, atol=1e-5)
    assert area_of([tuple(point) for point in drawn]) > 0.0


@pytest.mark.parametrize("profile", ["cutter", "aama", "astm"])
def test_cut_sew_and_fold_lines_are_told_apart_without_color(profile):
    layers = {"cutter": ("CUT", "SEW", "RULING")}.get(profile, ("1", "14", "8"))
    wanted = PieceSettings(seam_allowance=(6.0,) * 4, rulings=True)
    pieces = make_pieces(*strips.random_strip(2), name="part", settings=wanted)
    _, groups = read(svg_bytes(pieces, profile=profile))
    cut, sew, folds = (
        {line.get("stroke-dasharray") for line in groups[f"layer-{layer}"]} - {None}
        for layer in layers
    )
    assert not cut
    assert len(sew) == 1
    assert len(folds) == 2
    assert not sew & folds


def test_everything_lies_on_the_sheet():
    pieces = make_pieces(*strips.random_strip(1), name="part", settings=FULL)
    root, _ = read(svg_bytes(pieces))
    _, _, width, height = map(float, root.get("viewBox").split())
    for element in (*root.iter(SVG + "polygon"), *root.iter(SVG + "polyline")):
        points = np.array(points_of(element))
        assert points.min() >= 0.0
        assert np.all(points <= (width, height))


def test_layers_are_those_of_the_dxf_file():
    pieces = make_pieces(*strips.lens(), name="part", settings=FULL)
    _, groups = read(svg_bytes(pieces))
    expected = {"CUT", "SEW", "NOTCH", "GRAIN", "STRETCH", "RULING", "PUNCH", "TEXT"}
    assert set(groups) == {f"layer-{layer}" for layer in expected} | {"scale-bar"}
    _, groups = read(svg_bytes(pieces, profile="aama"))
    assert {"layer-1", "layer-14", "layer-4", "layer-8"} <= set(groups)


def test_the_scale_bar_is_100_mm_long():
    _, groups = read(svg_bytes(make_pieces(*strips.rectangle(30.0, 20.0), name="part")))
    path = groups["scale-bar"].find(SVG + "path").get("d")
    assert "h100M" in path
    assert groups["scale-bar"].find(SVG + "text").text == "100 mm"


def test_the_same_pieces_give_the_same_bytes():
    pieces = make_pieces(*strips.lens(), name="part", settings=FULL)
    assert svg_bytes(pieces) == svg_bytes(pieces)


def test_no_pieces_and_no_folder_are_refused(tmp_path):
    with pytest.raises(InputError, match="no pieces"):
        svg_bytes([])
    with pytest.raises(ExportError, match=r"write SVG a\.svg"):
        write_svg(tmp_path / "none" / "a.svg", make_pieces(*strips.rectangle(), name="part"))
