"""GDAL, which shares no code with what writes our files, reads the pieces at their size."""

from __future__ import annotations

import numpy as np
import pyogrio
import pytest
import shapely

from tests.pattern.piece.test_lettering import random_job
from tests.pattern.strips import dxf_bytes

KINDS = [
    ("cutter", None, "lines"),
    ("cutter", "R12", "lines"),
    ("cutter", "R2000", "arcs"),
    ("cutter", "R2010", "splines"),
    ("aama", None, "lines"),
    ("aama", "R2000", "lines"),
    ("astm", None, "lines"),
]
CUT_LAYER = {"cutter": "CUT", "aama": "1", "astm": "1"}
# Steps of a hundredth of a degree on arcs, else of four degrees.
pyogrio.set_gdal_config_options({"OGR_ARC_STEPSIZE": "0.01"})


def rings_in(path, layer):
    """The closed lines on a layer, blocks taken apart where they are inserted."""
    meta, _, geometries, columns = pyogrio.raw.read(path)
    layers = columns[list(meta["fields"]).index("Layer")]
    shapes = shapely.from_wkb(geometries)
    parts = [part for shape in shapes[layers == layer] for part in shapely.get_parts(shape)]
    return [part for part in parts if part.geom_type == "LineString" and part.is_closed]


@pytest.mark.parametrize(("profile", "version", "curves"), KINDS)
def test_gdal_reads_every_piece_with_its_area_and_place(profile, version, curves, tmp_path):
    pieces = random_job(1)
    path = tmp_path / "pieces.dxf"
    path.write_bytes(dxf_bytes(pieces, profile=profile, version=version, curves=curves))
    rings = rings_in(path, CUT_LAYER[profile])
    found = np.array([shapely.Polygon(ring.coords).area for ring in rings])
    for piece in pieces:
        outline = shapely.Polygon(piece.cut_line)
        # Arcs and splines may leave the polygon by half the chord tolerance.
        slack = 1e-4 if curves == "lines" else 0.5 * piece.tolerance * outline.length
        assert np.abs(found - outline.area).min() < slack
    if profile == "cutter":
        assert len(found) == len(pieces)
        first, second = shapely.STRtree(rings).query(rings, "intersects")
        assert first.tolist() == second.tolist()
