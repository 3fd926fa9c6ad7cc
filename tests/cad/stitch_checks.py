"""Independent measures of a stitched shell, shared by the tests of stitching."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray
from OCP.BOPAlgo import BOPAlgo_ArgumentAnalyzer, BOPAlgo_InvalidCurveOnSurface
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.STEPControl import STEPControl_Reader
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.exchange.shapes import Part
from wrinkle_cad.cad.exchange.write import write_step, write_stl
from wrinkle_cad.cad.kernel.measures import is_valid, length_of
from wrinkle_cad.cad.kernel.topology import (
    faces_of,
    free_edges,
    make_compound,
    make_vertex,
    shells_of,
    vertex_point,
    vertices_of,
)
from wrinkle_cad.cad.upper.projection import UpperFaces
from wrinkle_cad.cad.upper.stitch import Stitched

Floats = NDArray[np.float64]


def reread(path: Path) -> TopoDS_Shape:
    """The shape in a STEP file as the kernel's plain reader gives it."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()


def border_length(shape: TopoDS_Shape) -> float:
    return sum(length_of(edge) for edge in free_edges(shape))


def shell_faults(shape: TopoDS_Shape, face_count: int, upper: TopoDS_Shape) -> list[str]:
    """What is wrong with a shape that should be one shell with the border of the upper."""
    faults = []
    if len(shells_of(shape)) != 1:
        faults.append(f"{len(shells_of(shape))} shells")
    if len(faces_of(shape)) != face_count:
        faults.append(f"{len(faces_of(shape))} faces of {face_count}")
    if not is_valid(shape):
        faults.append("not valid")
    if abs(border_length(shape) - border_length(upper)) > 1e-3:
        faults.append(f"border {border_length(shape)} of {border_length(upper)} mm")
    held = make_compound(free_edges(upper))
    for vertex in vertices_of(make_compound(free_edges(shape))):
        if BRepExtrema_DistShapeShape(vertex, held).Value() > 1e-3:
            faults.append(f"border at {vertex_point(vertex)}")
    return faults


def step_faults(stitched: Stitched, upper: TopoDS_Shape, folder: Path) -> list[str]:
    """What is wrong with the stitched shell after it went through a STEP file."""
    path = folder / "stitched.step"
    write_step(path, [Part(stitched.shell_shape, "upper")])
    return shell_faults(reread(path), stitched.report.face_count, upper)


def stl_faults(
    stitched: Stitched, upper: TopoDS_Shape, folder: Path, *, tolerance: float = 0.05
) -> list[str]:
    """What is wrong with the mesh: edges with three triangles, other borders, wrong normals."""
    path = folder / "stitched.stl"
    write_stl(path, stitched.shell_shape, tolerance=tolerance)
    mesh = trimesh.load_mesh(path)
    # Vertices of one edge are equal to the bit; flat needles must stay, they fill the mesh.
    mesh.merge_vertices()
    corners = mesh.faces
    mesh.update_faces((corners != np.roll(corners, 1, axis=1)).all(axis=1))
    edges, count = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    faults = []
    if count.max() > 2:
        faults.append(f"{int((count > 2).sum())} edges with more than two triangles")
    border = mesh.vertices[edges[count == 1]]
    held = make_compound(free_edges(upper))
    astray = [
        pair
        for pair in border
        if free_edges(upper) == []
        or BRepExtrema_DistShapeShape(make_vertex(pair.mean(axis=0)), held).Value()
        > 2.0 * tolerance
    ]
    if astray:
        faults.append(f"{len(astray)} edges of a border that is not the upper's, at {astray[0][0]}")
    if not mesh.is_winding_consistent:
        faults.append("triangles face both ways")
    return faults + _normal_faults(mesh, upper)


def _normal_faults(mesh: trimesh.Trimesh, upper: TopoDS_Shape) -> list[str]:
    """Compares normals, signs included, at some triangles that lie on the upper."""
    faces = UpperFaces(upper)
    sides = np.linalg.norm(np.diff(mesh.triangles[:, [0, 1, 2, 0]], axis=1), axis=2)
    # Needles have no normal to compare: their corners are rounded in the file.
    areas = np.where(mesh.area_faces > 0.01 * sides.max(axis=1), mesh.area_faces, 0.0)
    largest = np.argsort(-areas, kind="stable")[:: max(1, len(areas) // 400)]
    turned = checked = 0
    for i in largest[areas[largest] > 0.0]:
        foot = faces.feet(np.asarray(mesh.triangles_center[i])[None])
        if foot.distances[0] < 0.05 and abs(float(mesh.face_normals[i] @ foot.normals[0])) > 0.9:
            checked += 1
            turned += float(mesh.face_normals[i] @ foot.normals[0]) < 0.0
    # Near a sharp edge the nearest face may be the one behind.
    is_sound = checked > 50 and turned <= 0.01 * checked
    return [] if is_sound else [f"{turned} of {checked} normals turned"]


def freecad_report(freecadcmd: str, paths: list[Path], folder: Path) -> list[str]:
    """One line per STEP file: shells, faces, validity and border length as FreeCAD sees them."""
    script = folder / "judge.py"
    script.write_text(
        "import Part\n"
        f"for path in {[str(path) for path in paths]!r}:\n"
        "    shape = Part.Shape()\n"
        "    shape.read(path)\n"
        "    free = {}\n"
        "    for face in shape.Faces:\n"
        "        for wire in face.Wires:\n"
        "            for edge in wire.OrderedEdges:\n"
        "                free.setdefault(edge.hashCode(), []).append(edge)\n"
        "    border = sum(e[0].Length for e in free.values() if len(e) == 1)\n"
        "    found = len(shape.Shells), len(shape.Faces), shape.isValid(), round(border, 2)\n"
        "    print('JUDGED', *found)\n"
    )
    done = subprocess.run(
        [freecadcmd, str(script)], capture_output=True, text=True, timeout=300, check=False
    )
    return [line[7:] for line in done.stdout.splitlines() if line.startswith("JUDGED")]


def freecad_boolean_faults(freecadcmd: str, path: Path, folder: Path) -> list[str]:
    """What FreeCAD's own check of a STEP file for boolean operations finds."""
    script = folder / "check.py"
    script.write_text(
        "import Part\n"
        "shape = Part.Shape()\n"
        f"shape.read({str(path)!r})\n"
        "try:\n"
        "    shape.check(True)\n"
        "except ValueError as error:\n"
        "    print(error)\n"
        "print('CHECKED', len(shape.Faces))\n"
    )
    done = subprocess.run(
        [freecadcmd, str(script)], capture_output=True, text=True, timeout=1800, check=False
    )
    assert "CHECKED" in done.stdout, done.stdout + done.stderr
    return [line for line in done.stdout.splitlines() if "BOPAlgo" in line]


def edges_off_their_faces(shape: TopoDS_Shape) -> int:
    """How many edges the kernel's check for boolean operations finds off one of their faces."""
    check = BOPAlgo_ArgumentAnalyzer()
    check.SetShape1(shape)
    check.CurveOnSurfaceMode = True
    check.Perform()
    found = [item.GetCheckStatus() for item in check.GetCheckResult()]
    return found.count(BOPAlgo_InvalidCurveOnSurface)
