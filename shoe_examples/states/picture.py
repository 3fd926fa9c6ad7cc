"""Draws picture.png: a strip of each state that a verdict may have, with its figures.

Run it with: python picture.py
"""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from build123d import Edge, Polyline, Pos, Spline
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from OCP.BRepMesh import BRepMesh_IncrementalMesh

from wrinkle_cad import WrinkleStrip, WrinkleWarning

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from picture import face_triangles, shaded  # noqa: E402 - the tool of all examples lies above

VIEW = (28.0, -62.0)
"""Elevation and azimuth in degrees."""


def spline(x: np.ndarray, y: np.ndarray | float, z: np.ndarray | float) -> Edge:
    points = np.stack(np.broadcast_arrays(x, y, z), axis=1)
    return Spline(*[tuple(point) for point in points.tolist()])


def rails() -> dict[str, tuple[object, object]]:
    """P and Q of a strip of each state, by the state."""
    x = np.linspace(0.0, 100.0, 41)
    turn, t = 1.5 * x / 100.0 - 0.75, np.linspace(-1.0, 1.0, 41)
    fold = Polyline((0, 0, 0), (50, 0, 0), (86, 0, 36))
    loop = spline(48.0 * t**3 - 32.0 * t + 40.0, 0.0, 24.0 * (1.0 - t * t))
    return {
        "developable": (spline(x, 0.0, 8 * np.sin(x / 14)), spline(x, 26.0, 8 * np.sin(x / 14))),
        "stretched": (
            spline(x, -13.0 * np.cos(turn), -13.0 * np.sin(turn)),
            spline(x, 13.0 * np.cos(turn), 13.0 * np.sin(turn)),
        ),
        "creased": (fold, Pos(0, 26, 0) * fold),
        "folded": (loop, Pos(0, 22, 0) * loop),
    }


def words(strip: WrinkleStrip) -> str:
    """The figures that decide the state of a strip."""
    report = strip.report
    if report.state == "folded":
        return "passes through itself"
    if report.state == "creased":
        (crease,) = report.creases
        return f"by {crease.angle_deg:.0f}° at {crease.p_mm:.0f} mm of P, bend radius 0"
    if report.state == "stretched":
        return f"by at most {report.max_strain_percent:.1f}%, over {report.stretched_mm:.0f} mm"
    radius = report.smallest_bend_radius_mm
    return f"strain {report.max_strain_percent:.0f}%, bend radius {radius:.0f} mm"


def draw_strip(axes: object, strip: WrinkleStrip) -> None:
    """Draws a strip shaded, with its bridges."""
    faces = [face.wrapped for face in strip.shell("facets").faces()]
    BRepMesh_IncrementalMesh(strip.shell("facets").wrapped, 0.1, False, 0.1, False)
    triangles = np.concatenate([face_triangles(face) for face in faces])
    e, a = np.radians(VIEW)
    toward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    colors = shaded(triangles, strip.color, toward)
    axes.add_collection3d(
        Poly3DCollection(triangles, facecolors=colors, edgecolors="#0002", clip_on=False)
    )
    i, j = strip.triangulation.bridges.T
    for rail in (strip.triangulation.p, strip.triangulation.q):
        axes.plot(*rail.T, color="#17202b", linewidth=1.2, clip_on=False)
    for ends in zip(strip.triangulation.p[i], strip.triangulation.q[j], strict=True):
        axes.plot(*np.array(ends).T, color="#17202b", linewidth=0.3, clip_on=False)
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(tuple(high - low), zoom=1.0)
    axes.view_init(*VIEW)
    axes.set_axis_off()


def main() -> None:
    figure = plt.figure(figsize=(9.0, 6.0), dpi=80)
    for at, (state, (p, q)) in enumerate(rails().items()):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", WrinkleWarning)
            strip = WrinkleStrip(p, q, name=state, criteria=("bending",))
            assert strip.report.state == state, strip.report
        axes = figure.add_subplot(2, 2, at + 1, projection="3d", proj_type="ortho")
        draw_strip(axes, strip)
        axes.set_title(f"{state.capitalize()}: {words(strip)}", fontsize=11, y=1.0)
    figure.subplots_adjust(0.03, 0.03, 0.97, 0.93, 0.08, 0.16)
    figure.savefig(HERE / "picture.png", metadata={"Software": None})
    plt.close(figure)
    print("picture.png: developable, stretched, creased, folded")


if __name__ == "__main__":
    main()
