"""Every file read back without ezdxf, and passed through ezdxf's auditor."""

from __future__ import annotations

import io
from datetime import datetime

import ezdxf
import numpy as np
import pytest

from tests.pattern import strips
from tests.pattern.group_codes import area_of, perimeter_of, read_group_codes
from tests.pattern.strips import dxf_bytes, make_pieces
from wrinkle_cad.errors import ExportError, InputError
from wrinkle_cad.pattern.check.judging import judge_dxf
from wrinkle_cad.pattern.formats.dxf import dxf_file, write_dxf
from wrinkle_cad.pattern.piece.options import NotchRule, PieceSettings

VERSIONS = {"R12": "AC1009", "R2000": "AC1015", "R2010": "AC1024"}
FULL = PieceSettings(
    rulings=True,
    seam_allowance=(5.0, 8.0, 10.0, 0.0),
    lasting_margin=(0.0, 12.0, 0.0, 0.0),
    notches_p=NotchRule(count=4),
    notches_q=NotchRule(spacing=30.0),
    notch_kind="v",
    drill_holes=((0.3, 0.5), (0.6, 0.4)),
    ruling_spacing=8.0,
    material="Calf leather",
    stretch="across",
    size="38",
)


def pieces_of(made, name="vamp", settings=None):
    return make_pieces(*made, name=name, settings=settings)


def audit(content):
    document = ezdxf.read(io.StringIO(content.decode("ascii")))
    auditor = document.audit()
    assert not auditor.errors, auditor.errors
    assert not auditor.fixes, auditor.fixes
    return document


MADE = {
    "rectangle": strips.rectangle,
    "cylinder": strips.cylinder,
    "lens": strips.lens,
    "kinked": strips.kinked,
    "wavy": lambda: strips.random_strip(1),
    "tapering": lambda: strips.random_strip(10),
}


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("case", MADE)
def test_the_cut_line_is_one_closed_contour_as_large_as_the_strip(case, version):
    unrolling, triangulation = MADE[case]()
    pieces = pieces_of((unrolling, triangulation))
    content = dxf_bytes(pieces, version=version)
    audit(content)
    dxf = read_group_codes(content)
    assert dxf.header["$ACADVER"] == [(1, VERSIONS[version])]
    (contour,) = dxf.on("CUT")
    assert contour.kind == ("POLYLINE" if version == "R12" else "LWPOLYLINE")
    assert contour.is_closed
    assert contour.vertices[0] != contour.vertices[-1]
    length = unrolling.p_length + unrolling.q_length
    length += np.linalg.norm(unrolling.p[0] - unrolling.q[0])
    length += np.linalg.norm(unrolling.p[-1] - unrolling.q[-1])
    tolerance = pieces[0].tolerance
    assert perimeter_of(contour.vertices) == pytest.approx(length, abs=tolerance)
    assert area_of(contour.vertices) == pytest.approx(unrolling.area, abs=tolerance * length)
    assert min(map(min, contour.vertices)) == 0.0


@pytest.mark.parametrize("version", VERSIONS)
def test_units_are_millimetres_in_every_version(version):
    content = dxf_bytes(pieces_of(strips.rectangle()), version=version)
    dxf = read_group_codes(content)
    texts = [entity.text(1) for entity in dxf.on("TEXT", "TEXT")]
    assert any("UNITS MM" in text for text in texts)
    if version == "R12":
        assert "$INSUNITS" not in dxf.header
    else:
        assert dxf.header["$INSUNITS"] == [(70, "4")]
        assert dxf.header["$MEASUREMENT"] == [(70, "1")]


def test_r12_holds_nothing_newer_than_r12():
    content = dxf_bytes(pieces_of(strips.lens(), settings=FULL), version="R12")
    dxf = read_group_codes(content)
    kinds = {entity.kind for entity in dxf.entities}
    assert kinds <= {"POLYLINE", "LINE", "POINT", "TEXT"}
    assert not {100, 102, 330, 370} & {code for code, _ in dxf.tags}
    assert set(dxf.sections) <= {"HEADER", "TABLES", "BLOCKS", "ENTITIES"}


@pytest.mark.parametrize("profile", ["cutter", "aama", "astm"])
@pytest.mark.parametrize("version", [None, *VERSIONS])
def test_our_own_files_pass_our_own_check_and_the_auditor(profile, version, tmp_path):
    pieces = [
        *pieces_of(strips.lens(), "lens", FULL),
        *pieces_of(
            strips.random_strip(1), "wavy", PieceSettings(seam_allowance=(4.0,) * 4, rulings=False)
        ),
        *pieces_of(strips.kinked(), "kinked"),
    ]
    path = tmp_path / "pattern.dxf"
    write_dxf(path, pieces, profile=profile, version=version, test_square=True)
    report = judge_dxf(path)
    assert report.findings == ()
    assert report.is_clean
    assert report.format == ("drawing" if profile == "cutter" else "pieces")
    audit(path.read_bytes())


@pytest.mark.parametrize("profile", ["cutter", "aama"])
@pytest.mark.parametrize("version", VERSIONS)
def test_the_same_pieces_give_the_same_bytes(profile, version):
    pieces = pieces_of(strips.lens(), settings=FULL)
    first, second = (dxf_bytes(pieces, profile=profile, version=version) for _ in range(2))
    assert first == second
    later = dxf_bytes(
        pieces, profile=profile, version=version, timestamp=datetime(2024, 2, 29, 13, 5)
    )
    assert later != first
    assert later == dxf_bytes(
        pieces, profile=profile, version=version, timestamp=datetime(2024, 2, 29, 13, 5)
    )


def test_every_role_has_its_layer_in_a_cutters_file():
    content = dxf_bytes(pieces_of(strips.lens(), settings=FULL))
    dxf = read_group_codes(content)
    used = {entity.layer for entity in dxf.entities}
    assert used == {"CUT", "SEW", "NOTCH", "GRAIN", "STRETCH", "RULING", "PUNCH", "TEXT"}
    assert set(dxf.layers) == used | {"0", "Defpoints"}
    assert len(dxf.on("PUNCH", "POINT")) == 2
    assert len(dxf.on("SEW")) == 1
    assert [e.text(1) for e in dxf.on("TEXT", "TEXT")][:5] == [
        "vamp",
        "SIZE 38",
        "QUANTITY 1",
        "RIGHT SIDE UP",
        "MATERIAL Calf leather",
    ]


def test_mountains_and_valleys_have_their_own_line_types():
    for inward, line_type in ((False, "DASHDOT"), (True, "DASHED")):
        for version in VERSIONS:
            drawn = pieces_of(strips.cylinder(inward=inward), settings=PieceSettings(rulings=True))
            dxf = read_group_codes(dxf_bytes(drawn, version=version))
            rulings = dxf.on("RULING", "LINE")
            # Those at the texts and at the grain line are broken in two.
            assert 58 <= len(rulings) <= 2 * 58
            assert {entity.text(6) for entity in rulings} == {line_type}
            assert line_type in dxf.line_types


def test_rulings_can_be_left_out():
    off = PieceSettings(rulings=False)
    dxf = read_group_codes(dxf_bytes(pieces_of(strips.cylinder(), settings=off)))
    assert not dxf.on("RULING")
    assert "RULING" not in dxf.layers


def test_pieces_lie_apart_at_one_scale():
    pieces = [
        *pieces_of(strips.rectangle(120.0, 40.0), "one"),
        *pieces_of(strips.rectangle(60.0, 20.0), "two"),
    ]
    dxf = read_group_codes(dxf_bytes(pieces))
    first, second = dxf.on("CUT")
    assert area_of(first.vertices) == pytest.approx(4800.0)
    assert area_of(second.vertices) == pytest.approx(1200.0)
    assert max(y for _, y in first.vertices) + 10.0 <= min(y for _, y in second.vertices) + 1e-6


def test_the_test_square_is_100_mm_wide():
    for version in VERSIONS:
        content = dxf_bytes(pieces_of(strips.rectangle()), version=version, test_square=True)
        (square,) = read_group_codes(content).on("TEST", None)
        xs, ys = zip(*square.vertices, strict=True)
        assert (max(xs) - min(xs), max(ys) - min(ys)) == (100.0, 100.0)
    content = dxf_bytes(pieces_of(strips.rectangle()), profile="astm", test_square=True)
    (boundary,) = read_group_codes(content).on("1", "POLYLINE", "TEST_SQUARE_100_MM_M")
    assert area_of(boundary.vertices) == pytest.approx(10_000.0)


def test_arcs_and_splines_come_only_on_request():
    pieces = pieces_of(strips.random_strip(1), settings=FULL)
    plain = read_group_codes(dxf_bytes(pieces))
    assert not any(any(e.bulges) for e in plain.entities)
    arcs = read_group_codes(dxf_bytes(pieces, curves="arcs"))
    (contour,) = arcs.on("CUT")
    assert any(contour.bulges)
    assert len(contour.vertices) < len(plain.on("CUT")[0].vertices)
    splines = read_group_codes(dxf_bytes(pieces, curves="splines"))
    assert {entity.kind for entity in splines.on("CUT")} == {"SPLINE"}
    for curves in ("arcs", "splines"):
        audit(dxf_bytes(pieces, curves=curves))


def test_options_that_do_not_go_together_are_refused():
    pieces = pieces_of(strips.rectangle())
    for wrong, message in (
        ({"profile": "gerber"}, "profile 'gerber' is not known"),
        ({"version": "R13"}, "DXF version is 'R13'"),
        ({"curves": "circles"}, "curves are 'circles'"),
        ({"profile": "aama", "curves": "arcs"}, "contours of the profile aama are polylines"),
        ({"version": "R12", "curves": "splines"}, "R12 has no splines"),
    ):
        with pytest.raises(InputError, match=message):
            dxf_bytes(pieces, **wrong)
    with pytest.raises(InputError, match="no pieces"):
        dxf_bytes([])


def test_blocks_in_a_newer_version_come_with_a_warning():
    made = dxf_file(pieces_of(strips.rectangle()), profile="astm", version="R2000")
    assert [finding.code for finding in made.findings] == ["layout-blocks"]
    assert dxf_file(pieces_of(strips.rectangle()), profile="astm").findings == ()


def test_a_file_that_cannot_be_written_is_an_export_error(tmp_path):
    with pytest.raises(ExportError, match=r"write DXF x\.dxf"):
        write_dxf(tmp_path / "none" / "x.dxf", pieces_of(strips.rectangle()))


def test_writing_tells_the_screen_nothing(capfd):
    for profile in ("cutter", "aama"):
        dxf_bytes(pieces_of(strips.rectangle()), profile=profile, version="R12")
    assert capfd.readouterr() == ("", "")


def ring_sector(radius=100.0, width=30.0, turn=1.5, tolerance=0.05):
    """A flat ring sector, sampled as finely as flat rails are."""
    count = int(np.ceil(turn / (2.0 * np.arccos(1.0 - 0.2 * tolerance / radius)))) + 1
    angle = np.linspace(0.0, turn, count)
    ring = np.column_stack((np.cos(angle), np.sin(angle), 0.0 * angle))
    return strips.unrolled((radius + width) * ring, radius * ring)


@pytest.mark.parametrize("curves", ["lines", "arcs", "splines"])
def test_curves_of_any_kind_stay_within_the_one_tolerance(curves):
    from ezdxf.path import make_path

    tolerance = 0.05
    settings = PieceSettings(seam_allowance=(6.0,) * 4, tolerance=tolerance)
    pieces = make_pieces(*ring_sector(), name="ring", settings=settings)
    space = ezdxf.read(io.StringIO(dxf_bytes(pieces, curves=curves).decode())).modelspace()
    for layer, radii in (("CUT", (94.0, 136.0)), ("SEW", (100.0, 130.0))):
        (contour,) = space.query(f"*[layer=='{layer}']")
        points = np.array([tuple(p)[:2] for p in make_path(contour).flattening(1e-3)])
        shift = offset_of(pieces[0], space)
        corners = pieces[0].cut_line[pieces[0].cut.corners] + shift
        points = points[np.hypot(*(points[:, None] - corners).T).min(axis=0) > 15.0]
        away = np.hypot(*(points - fitted_centre(pieces[0]) - shift).T)
        for radius in radii:
            near = away[np.abs(away - radius) < 0.5]
            assert len(near) > 20
            assert np.abs(near - radius).max() <= tolerance + 1e-3


def fitted_centre(piece):
    """The centre of a ring sector's sew line: where normals of its outer seam meet."""
    seam = piece.sew_line[: np.flatnonzero(piece.sew.sides == 0)[-1] + 1]
    rows = np.column_stack((2.0 * seam, np.ones(len(seam))))
    answer = np.linalg.lstsq(rows, (seam**2).sum(axis=1), rcond=None)[0]
    return answer[:2]


def offset_of(piece, space):
    (cut,) = space.query("*[layer=='CUT']")
    from ezdxf.path import make_path

    points = np.array([tuple(p)[:2] for p in make_path(cut).flattening(1e-3)])
    return points.min(axis=0) - piece.cut_line.min(axis=0)


@pytest.mark.parametrize("profile", ["cutter", "aama", "astm"])
def test_our_files_pass_our_check_in_every_version_and_kind_of_curve(profile, tmp_path):
    settings = PieceSettings(seam_allowance=(6.0,) * 4, hand="left", notches=3, rulings=True)
    pieces = make_pieces(*strips.random_strip(3), name="s", settings=settings)
    for version in (None, *VERSIONS):
        for curves in ("lines", "arcs", "splines") if profile == "cutter" else ("lines",):
            if version == "R12" and curves == "splines":
                continue
            path = tmp_path / "made.dxf"
            write_dxf(path, pieces, profile=profile, version=version, curves=curves)
            report = judge_dxf(path)
            assert report.is_clean, (version, curves, report.findings)
