from __future__ import annotations

import math
import re
import threading
import warnings

import build123d as b3d
import numpy as np
import pytest

from wrinkle_cad import WrinkleStrip, WrinkleWarning, settings
from wrinkle_cad.cad.kernel import measures
from wrinkle_cad.errors import CadError
from wrinkle_cad.wrinkle.loudness import findings_in_the_result
from wrinkle_cad.wrinkle.strip_findings import area_findings


def loop(y: float) -> b3d.Edge:
    t = np.linspace(-1.0, 1.0, 41)
    rows = np.column_stack((60.0 * t**3 - 40.0 * t, np.full(41, y), 30.0 * (1.0 - t * t)))
    return b3d.Spline(*[tuple(row) for row in rows.tolist()])


def flat_spiral(radius: float, turns: float) -> b3d.Edge:
    angle = np.linspace(0.0, 2.0 * math.pi * turns, 60)
    rows = np.column_stack((radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle))
    return b3d.Spline(*[tuple(row) for row in rows.tolist()])


def codes(strip: WrinkleStrip) -> list[str]:
    return [finding.code for finding in strip.findings]


def test_a_sound_strip_has_no_findings_and_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", WrinkleWarning)
        strip = WrinkleStrip(b3d.Line((0, 0, 0), (100, 0, 0)), b3d.Line((0, 20, 0), (100, 20, 3)))
        assert strip.findings == ()
        assert strip.report.name == "strip"


def test_a_strip_that_passes_through_itself_says_where() -> None:
    with pytest.warns(WrinkleWarning, match="passes through itself") as caught:
        strip = WrinkleStrip(loop(0.0), loop(15.0), name="loop")
    assert len(caught) == 1
    assert caught[0].filename == __file__
    (finding,) = strip.findings
    assert (finding.code, finding.severity) == ("passes-through-itself", "warning")
    found = re.search(r"loop passes through itself at \((.*), (.*), (.*)\) mm", finding.message)
    assert found is not None
    x, y, z = (float(number) for number in found.groups())
    assert abs(x) <= 0.1
    assert 0.0 <= y <= 15.0
    assert z == pytest.approx(10.0, abs=0.1)
    assert strip.shell().is_valid
    assert strip.report.state == "folded"


def test_rails_that_were_turned_are_a_warning() -> None:
    with pytest.warns(WrinkleWarning, match="Q was turned round") as caught:
        strip = WrinkleStrip(b3d.Line((0, 0, 0), (100, 0, 0)), b3d.Line((100, 20, 0), (0, 20, 0)))
    assert len(caught) == 1
    assert codes(strip) == ["rails-turned-alike"]


def test_a_pattern_that_must_be_split_is_a_finding_and_a_warning_when_it_is_laid_flat() -> None:
    p, q = b3d.Helix(10, 25, 30), b3d.Helix(10, 25, 20)
    with warnings.catch_warnings():
        warnings.simplefilter("error", WrinkleWarning)
        strip = WrinkleStrip(p, q)
    with pytest.warns(WrinkleWarning, match="covers itself when laid flat") as caught:
        assert len(strip.pattern().pieces) > 1
    assert len(caught) == 1
    assert codes(strip) == ["flat-overlaps"]


def test_a_strip_warns_once_however_much_is_found() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        strip = WrinkleStrip(flat_spiral(50.0, 1.2), flat_spiral(70.0, 1.2))
        assert strip.findings
        assert strip.pattern().pieces
        assert strip.report.overlaps
    assert len(caught) == 1
    assert codes(strip) == ["passes-through-itself", "flat-overlaps"]


def test_a_strip_that_cannot_but_fold_back_says_where() -> None:
    # Two rails of points, one of which goes to and fro along the other.
    p = np.array([(0, 0, 0), (30, 0, 0), (10, 0.5, 0), (40, 1, 0)], dtype=float)
    q = np.array([(0, 20, 0), (40, 20, 0)], dtype=float)
    with pytest.warns(WrinkleWarning, match="folds back on itself at"):
        strip = WrinkleStrip(p, q, name="tongue")
    finding = strip.findings[0]
    assert finding.code == "folded-back"
    found = re.match(r"tongue folds back on itself at \((.*), (.*), 0.00\) mm", finding.message)
    assert found is not None
    assert 0.0 <= float(found[1]) <= 40.0
    assert 0.0 <= float(found[2]) <= 20.0
    assert strip.report.state == "folded"


@pytest.mark.parametrize("is_turned", [False, True])
def test_a_strip_with_wrong_ends_says_where_its_end_bridge_runs_into_a_rail(
    is_turned: bool,
) -> None:
    hook, straight = [(0, 0), (10, 30), (20, 0), (100, 0)], [(20, 12), (100, 12)]
    way = -1 if is_turned else 1
    with pytest.warns(WrinkleWarning) as caught:
        strip = WrinkleStrip(b3d.Polyline(*hook[::way]), b3d.Line(*straight[::way]), name="hook")
    assert len(caught) == 1
    bridge = "last bridge, between the ends" if is_turned else "first bridge, between the starts"
    assert strip.findings[0].message == (
        "hook folds back on itself at (15.0, 21.0, 0.0) mm: between these rails there is no strip"
        f" that does not. Its {bridge} of P and Q, runs into P at (16.7, 10.0, 0.0) mm: trim the"
        " rails there."
    )


def test_a_strip_whose_area_the_kernel_cannot_settle_says_so_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    settled = measures.face_areas

    def unsettled(faces: object, *, relative_error: float) -> list[float]:
        if relative_error < 1e-5:
            raise CadError("integrate the area", "it does not settle.")
        return settled(faces, relative_error=relative_error)  # type: ignore[arg-type]

    monkeypatch.setattr(measures, "face_areas", unsettled)
    strip = WrinkleStrip(b3d.Line((0, 0, 0), (100, 0, 0)), b3d.Line((0, 20, 0), (100, 20, 0)))
    with pytest.warns(WrinkleWarning, match="The area of strip is known to 1e-04") as caught:
        assert strip.report.area_3d_mm2 == pytest.approx(2000.0)
    assert codes(strip) == ["area-uncertain"]
    assert strip.area_error > 1e-6
    assert len(caught) == 1


def test_an_area_is_unsure_from_a_millionth_on() -> None:
    assert area_findings("strip", settings.AREA_RELATIVE_ERROR) == ()
    assert area_findings("strip", 1e-6) == ()
    (finding,) = area_findings("vamp", 1e-4)
    assert finding.code == "area-uncertain"
    assert finding.message.startswith("The area of vamp is known to 1e-04 of it only")


def test_where_findings_stand_in_a_result_nothing_is_warned_of() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", WrinkleWarning)
        with findings_in_the_result():
            strip = WrinkleStrip(loop(0.0), loop(15.0))
        assert codes(strip) == ["passes-through-itself"]


def test_other_threads_stay_as_loud_as_before() -> None:
    heard: list[str] = []

    def make() -> None:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            WrinkleStrip(loop(0.0), loop(15.0))
        heard.extend(str(warning.message) for warning in caught)

    with findings_in_the_result():
        thread = threading.Thread(target=make)
        thread.start()
        thread.join()
    assert len(heard) == 1


def test_a_creased_strip_says_where_and_by_how_much() -> None:
    fold = b3d.Polyline((0, 0, 0), (40, 0, 0), (70, 30, 0))
    strip = WrinkleStrip(fold, b3d.Pos(0, 0, 20) * fold, name="fold")
    (finding,) = strip.findings
    assert (finding.code, finding.severity) == ("creased", "warning")
    assert finding.message == (
        "fold is creased by 45.0 degrees at 40.0 mm of P and 40.0 mm of Q, where a rail has a"
        " corner."
    )
    with pytest.warns(WrinkleWarning, match="fold is creased by 45.0 degrees") as caught:
        assert strip.report.state == "creased"
    assert caught[0].filename == __file__


def test_a_strip_that_stretches_a_sheet_says_by_how_much() -> None:
    rails = (b3d.Line((0, 0, 0), (100, 0, 0)), b3d.Line((0, 20, 0), (100, 20, 53)))
    finding, other = WrinkleStrip(*rails, name="skew").findings
    assert (finding.code, finding.severity) == ("stretched", "warning")
    assert other.code == "cut-differs"  # the piece folds by 70 degrees instead
    assert re.match(
        r"skew stretches a flat sheet by at most 2\.9\d%, over \d+\.\d mm", finding.message
    )
