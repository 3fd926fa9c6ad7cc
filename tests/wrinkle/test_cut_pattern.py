from __future__ import annotations

import itertools
from copy import copy
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from wrinkle_cad import NotchRule, Pattern, PieceSettings, WrinkleStrip
from wrinkle_cad.cad.exchange.choose import choose_inputs
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.errors import InputError
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.parts import limits_of, piece_settings_of
from wrinkle_cad.job.wrinkled_upper import WrinkledUpper, wrinkle_upper
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.wrinkle.cut_pattern import pattern_of_strips

ON_UPPER = Path(__file__).parents[2] / "shoe_examples" / "one_wrinkle" / "one_wrinkle.step"
JOB = Job(input=ON_UPPER, waves=5, height=3, margin=4)
P, Q = 0, 1


@pytest.fixture(scope="module")
def upper() -> WrinkledUpper:
    return wrinkle_upper(JOB, choose_inputs(read_cad(ON_UPPER)))


def pattern_with(upper: WrinkledUpper, **options: object) -> Pattern:
    job = Job(input=ON_UPPER, **options)
    return pattern_of_strips([*upper.strips, *upper.bands], piece_settings_of(job, limits_of(job)))


def test_every_strip_and_band_has_its_pieces(upper: WrinkledUpper) -> None:
    pattern = pattern_with(upper)
    assert [piece.name for piece in pattern.pieces] == [
        "one_wrinkle",
        "one_wrinkle band P",
        "one_wrinkle band Q",
    ]
    assert [pattern.pieces_of(index)[0].name for index in range(3)] == [
        piece.name for piece in pattern.pieces
    ]


def test_positions_given_for_a_rail_hold_on_all_that_is_sewn_along_it(
    upper: WrinkledUpper,
) -> None:
    pattern = pattern_with(upper, notch_at_p=(20.0, 60.0), notch_at_q=(33.0,))
    wrinkle, band_p, band_q = range(3)
    for strip, side in ((wrinkle, P), (band_p, P), (band_p, Q)):
        assert pattern.notch_arcs(strip, side) == pytest.approx((20.0, 60.0))
    for strip, side in ((wrinkle, Q), (band_q, P), (band_q, Q)):
        assert pattern.notch_arcs(strip, side) == pytest.approx((33.0,))


def test_sewn_pieces_have_notches_at_the_same_arcs(upper: WrinkledUpper) -> None:
    pattern = pattern_with(upper, notches=6)
    wrinkle, band_p, band_q = range(3)
    assert len(pattern.notch_arcs(wrinkle, P)) == 6
    assert pattern.notch_arcs(wrinkle, P) == pytest.approx(pattern.notch_arcs(band_p, Q))
    assert pattern.notch_arcs(wrinkle, Q) == pytest.approx(pattern.notch_arcs(band_q, P))


def test_a_band_that_has_samples_of_its_own_on_a_profile_is_sewn_to_it_all_the_same(
    upper: WrinkledUpper,
) -> None:
    band = copy(upper.bands[0])
    band.q_samples = Samples(band.q_samples.parameters, band.q_samples.points)
    options = PieceSettings(notches_p=NotchRule(at=(20.0, 60.0)))
    pattern = pattern_of_strips([*upper.strips, band], options)
    assert pattern.notch_arcs(0, P) == pytest.approx((20.0, 60.0))
    assert pattern.notch_arcs(1, Q) == pytest.approx((20.0, 60.0))


def test_drill_holes_go_into_the_wrinkle_only(upper: WrinkledUpper) -> None:
    pattern = pattern_with(upper, drill_holes=((0.5, 0.5), (0.25, 0.5)))
    assert [len(piece.drill_holes) for piece in pattern.pieces] == [2, 0, 0]


def test_pieces_lie_apart_at_one_scale(upper: WrinkledUpper) -> None:
    boxes = [
        (piece.cut_line.min(axis=0), piece.cut_line.max(axis=0))
        for piece in pattern_with(upper, seam_allowance=6).pieces
    ]
    for (_, top), (bottom, _) in itertools.pairwise(boxes):
        assert bottom[1] > top[1]


def test_dxf_svg_and_pdf_are_written_from_a_script(tmp_path: Path) -> None:
    along = np.linspace(0.0, 80.0, 20)
    strip = WrinkleStrip(
        np.column_stack((along, 0 * along, 0 * along)),
        np.column_stack((along, 0 * along + 15, 3 * np.sin(along / 20))),
        surface="facets",
    )
    pattern = strip.pattern(PieceSettings(seam_allowance=(5, 5, 5, 5)))
    pattern.export_dxf(tmp_path / "a.dxf", profile="aama")
    pattern.export_svg(tmp_path / "a.svg")
    pattern.export_pdf(tmp_path / "a.pdf")
    assert (tmp_path / "a.svg").read_text().startswith("<?xml")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")
    assert "Piece Name:" in (tmp_path / "a.dxf").read_text()


def test_an_export_carries_todays_date_unless_one_is_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    strip = WrinkleStrip([(0, 0, 0), (90, 0, 0)], [(0, 30, 0), (90, 30, 0)])
    path = tmp_path / "a.dxf"

    def stated(timestamp: datetime | None = None) -> str:
        strip.pattern().export_dxf(path, profile="aama", timestamp=timestamp)
        return path.read_text().split("Creation Date: ")[1][:10]

    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    days = {datetime.now(UTC).strftime("%d-%m-%Y")}
    today = stated()
    assert today in days | {datetime.now(UTC).strftime("%d-%m-%Y")}
    assert stated(datetime(2024, 2, 29, tzinfo=UTC)) == "29-02-2024"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    assert stated() == "01-01-1970"
    for wrong in ("yesterday", "253402300800", "9" * 30):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", wrong)
        with pytest.raises(InputError, match="SOURCE_DATE_EPOCH is"):
            stated()
