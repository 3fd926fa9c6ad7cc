"""Strips as shells: rails to start from, and what a STEP file keeps of them."""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPControl import STEPControl_Reader
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape, TopoDS_Shell

from tests.cad.measuring import area_of
from wrinkle_cad.cad.exchange.shapes import Part
from wrinkle_cad.cad.exchange.write import write_step
from wrinkle_cad.cad.faces.shell import build_shell
from wrinkle_cad.cad.kernel.curves import edge_curve
from wrinkle_cad.cad.kernel.measures import is_valid, tolerance_of
from wrinkle_cad.cad.kernel.mesh import binary_stl, mesh_of
from wrinkle_cad.cad.kernel.splines import make_curve
from wrinkle_cad.cad.kernel.topology import faces_of, free_edges, shells_of
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix, orient_alike, sample_directrix
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.triangulation import Triangulation, triangulate

Floats = NDArray[np.float64]


def edge_of(
    poles: object, degree: int, weights: object = None, inner: tuple[int, ...] | None = None
) -> TopoDS_Edge:
    """A B-spline edge over [0, 1] with simple inner knots, or of the multiplicities given."""
    count = len(np.asarray(poles))
    inner = (1,) * (count - degree - 1) if inner is None else inner
    knots = np.linspace(0.0, 1.0, len(inner) + 2)
    curve = make_curve(poles, knots, (degree + 1, *inner, degree + 1), degree, weights)
    return BRepBuilderAPI_MakeEdge(curve).Edge()


def random_edge(
    rng: np.random.Generator,
    y: float,
    degree: int,
    *,
    start: object = None,
    end: object = None,
    is_rational: bool = False,
    inner: tuple[int, ...] | None = None,
) -> TopoDS_Edge:
    """A wavy edge over x from 0 to 80 near the given y, perhaps between given ends."""
    count = degree + 1 + sum(inner) if inner is not None else max(degree + 1, 8)
    poles = np.column_stack(
        (np.linspace(0.0, 80.0, count), rng.normal(y, 4.0, count), rng.normal(0.0, 4.0, count))
    )
    poles[0] = poles[0] if start is None else start
    poles[-1] = poles[-1] if end is None else end
    weights = rng.uniform(0.5, 2.0, count) if is_rational else None
    return edge_of(poles, degree, weights, inner)


def lens_edges(height: float = 8.0) -> tuple[TopoDS_Edge, TopoDS_Edge]:
    """Two edges over x from 0 to 100 that meet at both ends."""
    x = np.linspace(0.0, 100.0, 11)
    bulge = np.sin(np.pi * x / 100.0)
    p = np.column_stack((x, -15.0 * bulge, height * bulge * np.sin(x / 15.0)))
    q = np.column_stack((x, 15.0 * bulge, height * bulge * np.cos(x / 13.0)))
    return edge_of(p, 3), edge_of(q, 3)


@dataclass(frozen=True)
class Strip:
    triangulation: Triangulation
    p: Directrix
    q: Directrix
    p_samples: Samples
    q_samples: Samples

    def shell(self, kind: str = "cones") -> TopoDS_Shell:
        return build_shell(
            self.triangulation,
            self.p,
            self.q,
            self.p_samples,
            self.q_samples,
            kind,
        )


def strip_between(p: object, q: object, tolerance: float = 0.05) -> Strip:
    first, second, _ = orient_alike(make_directrix(p, name="P"), make_directrix(q, name="Q"))
    samples = [sample_directrix(rail, tolerance) for rail in (first, second)]
    triangulation = triangulate(samples[0].points, samples[1].points)
    return Strip(triangulation, first, second, *samples)


def reread(shape: TopoDS_Shape, path: Path) -> TopoDS_Shape:
    """What the kernel's own reader, which is not ours, finds in our STEP file of a shape."""
    write_step(path, [Part(shape, "strip")])
    reader = STEPControl_Reader()
    assert reader.ReadFile(str(path)) == IFSelect_RetDone
    reader.TransferRoots()
    return reader.OneShape()


def faults_after_step(
    shell: TopoDS_Shell,
    path: Path,
    *,
    area_error: float = 1e-6,
    tolerance: float = 2e-6,
) -> list[str]:
    """What a STEP file loses of a shell; empty if nothing."""
    found = reread(shell, path)
    counts = [
        (len(shells_of(shape)), len(faces_of(shape)), len(free_edges(shape)))
        for shape in (shell, found)
    ]
    areas = [area_of(shape, relative_error=1e-8) for shape in (shell, found)]
    faults = [] if is_valid(found) else ["not valid"]
    if counts[0] != counts[1] or counts[1][0] != 1:
        faults.append(f"shells, faces, free edges: {counts}")
    if abs(areas[0] - areas[1]) > area_error * areas[0]:
        faults.append(f"areas {areas}")
    if tolerance_of(found) > tolerance:
        faults.append(f"edge tolerance {tolerance_of(found)}")
    return faults


def points_on_edge(edge: TopoDS_Edge, count: int = 9) -> tuple[Floats, Floats]:
    """Parameters (count,) of an edge's own curve, and the points (count, 3) there."""
    curve = edge_curve(edge)
    parameters = np.linspace(curve.FirstParameter(), curve.LastParameter(), count)
    points = [curve.Value(float(u)) for u in parameters]
    return parameters, np.array([(at.X(), at.Y(), at.Z()) for at in points])


def freecad_judgement(
    program: str, paths: list[Path], folder: Path
) -> list[tuple[int, int, bool, float]]:
    """Shells, faces, validity and length of the border of each STEP file, as FreeCAD sees them."""
    script = folder / "judge.py"
    script.write_text(
        "import Part\n"
        f"for path in {[str(path) for path in paths]!r}:\n"
        "    shape = Part.read(path)\n"
        "    uses = {}\n"
        "    for face in shape.Faces:\n"
        "        for edge in face.Edges:\n"
        "            if not edge.Degenerated:\n"
        "                uses.setdefault(edge.hashCode(), []).append(edge.Length)\n"
        "    border = sum(edge[0] for edge in uses.values() if len(edge) == 1)\n"
        "    print('SEEN', len(shape.Shells), len(shape.Faces), int(shape.isValid()), border)\n"
    )
    done = subprocess.run(
        [program, str(script)], capture_output=True, text=True, timeout=300, check=True
    )
    rows = [row.split()[1:] for row in done.stdout.splitlines() if row.startswith("SEEN")]
    return [(int(row[0]), int(row[1]), row[2] == "1", float(row[3])) for row in rows]


def stl_faults(shell: TopoDS_Shape, tolerance: float = 0.05) -> list[str]:
    """What a slicer would not like in the STL file of a flat strip; empty if nothing."""
    records = np.frombuffer(
        binary_stl(*mesh_of(shell, tolerance=tolerance))[84:],
        dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("tag", "<u2")],
    )
    corners = records["corners"].astype(np.float64)
    sides = np.roll(corners, -1, axis=1) - corners
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    across = np.cross(sides[:, 0], sides[:, 1])
    doubled = np.linalg.norm(across, axis=1)
    faults = []
    if (doubled <= 1e-6 * longest**2).any():
        faults.append(f"{(doubled <= 1e-6 * longest**2).sum()} triangles without area")
    keys = {tuple(sorted(map(tuple, triangle))) for triangle in corners.tolist()}
    if len(keys) != len(corners):
        faults.append(f"{len(corners) - len(keys)} triangles twice")
    if (across @ across[0] <= 0.0).any():
        faults.append(f"{(across @ across[0] <= 0.0).sum()} triangles face the other way")
    return faults
