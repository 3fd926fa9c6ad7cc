"""What a script is told when it says something wrong, by its text."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
from build123d import Edge, Face

import wrinkle_cad
from wrinkle_cad import Job, WrinkleStrip, carve, stitch, wrinkle_profiles
from wrinkle_cad.cad.upper.opening import Opening
from wrinkle_cad.errors import ExportError, InputError

UPPER = Face.make_rect(100, 60)
P, Q = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))


@pytest.fixture(scope="module")
def strip() -> WrinkleStrip:
    return WrinkleStrip(P, Q)


@pytest.fixture(scope="module")
def opening() -> Opening:
    return carve(UPPER, P, Q, margin=2)


def test_one_allowance_stands_for_all_four(strip: WrinkleStrip) -> None:
    assert strip.pattern(seam_allowance=6).pieces[0].widths == (6.0, 6.0, 6.0, 6.0)


Make = Callable[[WrinkleStrip, Opening], object]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda strip, _: strip.pattern(notches_p=5),
            "notches_p cannot be 5: give a NotchRule, such as NotchRule(count=5), or the option"
            " notches for both rails and notch_at_p for places.",
        ),
        (
            lambda *_: WrinkleStrip(P, Q, thickness="1.2"),
            "thickness cannot be '1.2': give a number from 0 to 1000 mm.",
        ),
        (
            lambda *_: WrinkleStrip(P, Q, tolerance="0.05"),
            "tolerance cannot be '0.05': give a number from 1e-09 to 1000 mm.",
        ),
        (
            lambda *_: WrinkleStrip(P, Q, tolerence=0.05),
            "WrinkleStrip() has no option 'tolerence': did you mean tolerance?",
        ),
        (
            lambda strip, _: strip.pattern(seam_alowance=6),
            "pattern() has no option 'seam_alowance': did you mean seam_allowance?",
        ),
        (lambda *_: carve(UPPER, P, Q, margin="2"), "margin cannot be '2': give a number."),
        (
            lambda *_: carve(UPPER, P, Q, margn=2),
            "carve() has no option 'margn': did you mean margin?",
        ),
        (
            lambda _, opening: stitch(WrinkleStrip(P, Q), opening),
            "stitch() was given an opening in place of a strip: pass the opening first and the"
            " strip second, stitch(opening, strip).",
        ),
        (
            lambda _, opening: stitch(opening, None),
            "A strip cannot be a NoneType: pass a WrinkleStrip between the opening's profiles.",
        ),
        (
            lambda strip, _: stitch(strip, strip),
            "An opening cannot be a WrinkleStrip: pass what carve() returned.",
        ),
        (
            lambda strip, opening: stitch(opening, strip, tolerance="0.05"),
            "tolerance cannot be '0.05': give a number.",
        ),
        (
            lambda _, opening: wrinkle_profiles(opening, waves="3", height=2),
            "waves cannot be '3': give a number.",
        ),
        (
            lambda _, opening: wrinkle_profiles(opening, waves=3, height=2, phase=90),
            "wrinkle_profiles() has no option 'phase': did you mean phase_deg?",
        ),
        (
            lambda strip, _: wrinkle_profiles(strip, waves=3, height=2),
            "The opening cannot be a WrinkleStrip: pass what carve() returned.",
        ),
        (
            lambda *_: Job(input=Path("shoe.step"), tolerance="1"),
            "tolerance cannot be '1': give a number from 1e-09 to 1000 mm.",
        ),
        (
            lambda *_: Job(input=Path("shoe.step"), tolerence=1),
            "Job() has no option 'tolerence': did you mean tolerance?",
        ),
        (
            lambda *_: carve(P, UPPER, Q),
            "Rail P cannot be a face: pass a curve, such as one of its edges or wires.",
        ),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(
    strip: WrinkleStrip, opening: Opening, make: Make, message: str
) -> None:
    with pytest.raises(InputError, match=f"^{re.escape(message)}$"):
        make(strip, opening)


def test_an_unknown_name_of_the_package_has_a_nearest_one() -> None:
    with pytest.raises(AttributeError, match=r"'WrinkelStrip': did you mean WrinkleStrip\?"):
        _ = wrinkle_cad.WrinkelStrip


def test_every_result_shows_itself_in_less_than_200_characters(
    strip: WrinkleStrip, opening: Opening
) -> None:
    wrinkle = WrinkleStrip(*wrinkle_profiles(opening, waves=3, height=2))
    stitched, pattern = stitch(opening, wrinkle), strip.pattern(notches=9, seam_allowance=6)
    shown = [strip, opening, stitched, stitched.report, pattern, *pattern.pieces, strip.p]
    shown += [strip.report, strip.triangulation, strip.unrolling, strip.p_samples, strip.ruled]
    for result in shown:
        assert len(repr(result)) < 200, type(result)


def test_a_notebook_shows_the_drawing_of_a_pattern(strip: WrinkleStrip) -> None:
    shown = strip.pattern(seam_allowance=6)._repr_html_()
    assert shown.startswith("<div>")
    assert shown.count("<svg ") == shown.count("</svg>") == 1
    assert "<?xml" not in shown


def test_a_notebook_shows_figures_and_a_drawing_of_strips_and_uppers(opening: Opening) -> None:
    wrinkle = WrinkleStrip(*wrinkle_profiles(opening, waves=3, height=2), name="toe <1> & co")
    stitched = stitch(opening, wrinkle)
    for shown in (wrinkle._repr_html_(), stitched._repr_html_()):
        root = ElementTree.fromstring(shown)
        assert [part.tag.rpartition("}")[2] for part in root] == ["table", "svg"]
        assert len(shown) < 60_000
    cells = [cell.text for cell in ElementTree.fromstring(stitched._repr_html_()).iter("td")]
    assert cells[cells.index("area") + 1] == f"{stitched.report.area_mm2:.2f} mm2"
    told = [cell.text for cell in ElementTree.fromstring(wrinkle._repr_html_()).iter("td")]
    assert told[told.index("largest fold") + 1] == f"{wrinkle.report.max_fold_deg:.2f} degrees"


def test_the_page_of_a_script_is_that_of_a_run(strip: WrinkleStrip, tmp_path: Path) -> None:
    page = tmp_path / "strip.html"
    strip.export_html(page, pattern=strip.pattern(seam_allowance=6), max_strain_percent=2)
    root = page.read_text()
    (summary,) = re.findall(r'<script type="application/json" id="summary">(.*?)</script>', root)
    told = json.loads(summary)
    assert told["verdict"]["passed"] is True
    assert told["strips"][0]["area_3d_mm2"] == pytest.approx(1280.0)
    assert told["settings"]["max_strain_percent"] == 2
    with pytest.raises(InputError, match="'max_strain': did you mean max_strain_percent"):
        strip.export_html(page, max_strain=2)
    with pytest.raises(ExportError, match="Cannot write HTML"):
        strip.export_html(tmp_path / "none" / "strip.html")
