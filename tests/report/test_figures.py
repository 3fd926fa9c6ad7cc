"""The figures on matplotlib axes: drawn where they belong, returned, never shown."""

from __future__ import annotations

from collections.abc import Iterator

import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

from matplotlib import pyplot as plt
from matplotlib.axes import Axes

from tests.pattern.strips import make_pieces
from tests.report.strips import planar_rails, view_of, wavy_rails
from wrinkle_cad.pattern.piece.options import PieceSettings
from wrinkle_cad.report.figures import along, plot_energy, plot_pattern, plot_validity
from wrinkle_cad.report.views import StripView


@pytest.fixture(scope="module")
def view() -> StripView:
    return view_of(wavy_rails(50, 56))


@pytest.fixture
def ax() -> Iterator[Axes]:
    figure, axes = plt.subplots()
    yield axes
    figure.canvas.draw()
    plt.close(figure)


def line_labelled(ax: Axes, start: str) -> np.ndarray:
    (line,) = (line for line in ax.lines if str(line.get_label()).startswith(start))
    return np.column_stack(line.get_data())


def test_the_validity_figure_shows_matrix_and_path(view: StripView, ax: Axes) -> None:
    assert view.valid is not None
    assert view.local is not None
    drawn = plot_validity(ax, view.valid, view.triangulation, others=[view.local])
    assert drawn is ax
    (image,) = ax.images
    assert np.array_equal(image.get_array(), view.valid)
    assert image.origin == "lower"
    path = line_labelled(ax, "global, least invalid + bending")
    assert np.array_equal(path, view.triangulation.bridges[:, ::-1])
    invalid = line_labelled(ax, "not locally convex")
    inflection = line_labelled(ax, "inflection")
    assert len(inflection) == view.triangulation.inflection_count
    assert len(invalid) + len(inflection) == view.triangulation.invalid_count
    assert np.array_equal(line_labelled(ax, "local"), view.local.bridges[:, ::-1])


def test_the_validity_figure_needs_no_path(view: StripView, ax: Axes) -> None:
    assert view.valid is not None
    plot_validity(ax, view.valid)
    assert len(ax.lines) == 0


def test_the_energy_figure_shows_each_bridge(view: StripView, ax: Axes) -> None:
    assert view.local is not None
    assert view.least_bending is not None
    assert plot_energy(ax, view.triangulation, [view.local, view.least_bending]) is ax
    shown = line_labelled(ax, "global, least invalid + bending")
    assert np.allclose(shown[:, 1], view.triangulation.bending_at)
    assert np.all(np.diff(shown[:, 0]) >= 0.0)
    assert shown[:, 1].sum() == pytest.approx(view.triangulation.bending)
    assert len(line_labelled(ax, "local")) == len(shown)


def test_a_flat_strip_has_an_energy_figure(ax: Axes) -> None:
    plot_energy(ax, view_of(planar_rails()).triangulation)
    assert ax.get_yscale() == "linear"


def test_bridges_stand_along_both_rails(view: StripView) -> None:
    at = along(view.triangulation)
    p, q = view.triangulation.p, view.triangulation.q
    whole = sum(np.linalg.norm(np.diff(rail, axis=0), axis=1).sum() for rail in (p, q)) / 2
    assert at[0] == 0.0
    assert at[-1] == pytest.approx(whole)


def test_the_pattern_figure_is_to_scale(view: StripView, ax: Axes) -> None:
    settings = PieceSettings(seam_allowance=(5.0,) * 4, drill_holes=((0.5, 0.5),), hand="left")
    pieces = make_pieces(view.unrolling, view.triangulation, name="a$b_c$", settings=settings)
    assert len(pieces) == 2
    assert plot_pattern(ax, pieces) is ax
    assert ax.get_aspect() == 1.0
    for piece in pieces:
        size = np.ptp(piece.cut_line, axis=0)
        assert any(
            np.allclose(np.ptp(np.column_stack(line.get_data()), axis=0), size) for line in ax.lines
        )
    bottoms = [line.get_ydata().min() for line in ax.lines]
    assert min(bottoms) < -np.ptp(pieces[0].cut_line[:, 1])


def test_nothing_is_shown(view: StripView, ax: Axes, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a figure was shown")

    monkeypatch.setattr(plt, "show", refuse)
    monkeypatch.setattr(plt, "figure", refuse)
    assert view.valid is not None
    plot_validity(ax, view.valid, view.triangulation)
    plot_energy(ax, view.triangulation)
    plot_pattern(ax, view.pieces)
