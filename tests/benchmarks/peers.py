"""The search beside others on the same strips, in one table: `python -m tests.benchmarks.peers`.

Each is run by itself in a process of its own: processor time of the least of three calls (one if it
takes long), and how much memory the process grew. Those that are not installed are named beneath
(`pip install "wrinkle-cad[peers]"`). Dijkstra's algorithm is SciPy's, on the graph of Wang and Tang
with two nodes a bridge, one number for both criteria; building the graph is not counted.
"""

from __future__ import annotations

import importlib
import math
import multiprocessing
import resource
import sys
import time
from collections.abc import Callable, Iterator
from itertools import product
from typing import Any, Final

import numpy as np

from wrinkle_cad.strip import triangulate
from wrinkle_cad.strip.convexity import judge_row
from wrinkle_cad.strip.folding import HINGE, cost_row, new_costs
from wrinkle_cad.strip.rails import default_planarity, round_off
from wrinkle_cad.strip.sightlines import VIEW_ROWS, bank_lengths, look_along, padded_banks
from wrinkle_cad.strip.triangulation import measured

Rails = tuple[np.ndarray, np.ndarray]
SIZES: Final = (60, 250, 1000, 4000)
LONG: Final = 2.0
"""Seconds: what takes longer is called once."""
VALIDITY: Final = 1e7
"""An invalid bridge in bending energies, where both are one number."""
LARGEST_GRAPH: Final = 2_500_000
"""Nodes; a larger graph takes more than 1 GB."""


def strips(count: int) -> dict[str, Rails]:
    t = np.linspace(0.0, 1.0, count)
    x, none = 100 * t, 0 * t
    arc = np.pi * t
    return {
        "twisted": (
            np.stack((x, none, none), axis=1),
            np.stack((x, 20 * np.cos(1.2 * t), 20 * np.sin(1.2 * t)), axis=1),
        ),
        "wrinkle": (
            np.stack((x, none, 3 * np.sin(25 * t)), axis=1),
            np.stack((x, none + 10, 3 * np.sin(25 * t + 1)), axis=1),
        ),
        "developable": (
            np.stack((30 * np.cos(3 * t), 30 * np.sin(3 * t), 4 * np.sin(5 * t)), axis=1),
            np.stack((30 * np.cos(3 * t), 30 * np.sin(3 * t), 40 + 4 * np.cos(4 * t)), axis=1),
        ),
        "ellipse": (
            np.stack((60 * np.cos(arc), 40 * np.sin(arc), none), axis=1),
            np.stack((30 * np.cos(arc), 50 * np.sin(arc), none + 45), axis=1),
        ),
    }


Timed = tuple[Callable[[], object], Callable[[object], np.ndarray | None]]
"""What is timed, and how its result becomes steps; None where it is no strip of bridges."""


def own(p: np.ndarray, q: np.ndarray) -> Timed:
    return lambda: triangulate(p, q), lambda found: found.steps  # type: ignore[attr-defined]


def own_without_price(p: np.ndarray, q: np.ndarray) -> Timed:
    return lambda: triangulate(p, q, price=None), lambda found: found.steps  # type: ignore[attr-defined]


def dijkstra(p: np.ndarray, q: np.ndarray) -> Timed:
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra as shortest

    m, n = len(p), len(q)
    if 2 * m * n > LARGEST_GRAPH:
        raise MemoryError("too large")
    starts, ends, costs = [], [], []
    p_banks, q_banks, columns = padded_banks(p), padded_banks(q), np.ascontiguousarray(q.T)
    view, valid, leaving = np.empty((VIEW_ROWS, n)), np.empty(n, dtype=np.bool_), new_costs(n)
    p_lengths, q_lengths = bank_lengths(p_banks), bank_lengths(q_banks)
    banks = np.empty((4, n))
    banks[2], banks[3] = q_lengths[:-1], q_lengths[1:]
    planarity, nothing, j = default_planarity(p, q), round_off(p, q), np.arange(n)
    for i in range(m):
        banks[0], banks[1] = p_lengths[i], p_lengths[i + 1]
        look_along(p[i], p_banks[:, i : i + 2], columns, q_banks, view)
        judge_row(view, planarity, valid)
        cost_row(view, banks, nothing, planarity, HINGE, leaving)
        for turn in range(4):
            kept = j < n - 1 if turn % 2 else np.full(n, i < m - 1)
            cost = leaving.bending[turn] + VALIDITY * (~valid * leaving.bent[turn])
            cost += VALIDITY**1.5 * leaving.fold_backs[turn] + 1e-12
            starts.append((2 * (i * n + j) + turn // 2)[kept])
            step = 2 * np.array([n, 1])[turn % 2]
            ends.append((2 * (i * n + j) + step + turn % 2)[kept])
            costs.append(cost[kept])
    pairs = np.concatenate(starts), np.concatenate(ends)
    graph = csr_array((np.concatenate(costs), pairs), shape=(2 * m * n, 2 * m * n))

    def steps_of(found: object) -> np.ndarray:
        _, before = found  # type: ignore[misc]
        node, taken = 2 * m * n - 2, []
        node += int(found[0][node + 1] < found[0][node])  # type: ignore[index]
        while node > 1:
            taken.append(node % 2)
            node = int(before[node])
        return np.array(taken[::-1], dtype=np.int8)

    return lambda: shortest(graph, indices=0, return_predecessors=True), steps_of


def steps_of_triangles(triangles: np.ndarray, m: int, n: int) -> np.ndarray | None:
    """The steps through the bridges of triangles of vstack((p, q)); None where they are not."""
    bridges = {
        (int(min(a, b)), int(max(a, b)) - m)
        for triangle in triangles
        for a, b in zip(triangle, np.roll(triangle, 1), strict=True)
        if (a < m) != (b < m)
    }
    path = np.array(sorted(bridges, key=lambda bridge: (sum(bridge), bridge)))
    if len(path) != m + n - 1 or (np.diff(path.sum(axis=1)) != 1).any():
        return None
    steps = np.diff(path[:, 1])
    return steps.astype(np.int8) if set(steps.tolist()) <= {0, 1} else None


def cgal(p: np.ndarray, q: np.ndarray) -> Timed:
    kernel = importlib.import_module("CGAL.CGAL_Kernel")
    processing = importlib.import_module("CGAL.CGAL_Polygon_mesh_processing")
    order = np.concatenate((np.arange(len(p)), len(p) + np.arange(len(q))[::-1]))
    ring = np.concatenate((p, q[::-1]))
    if len(ring) > 2000:
        raise MemoryError("too slow")

    def run() -> object:
        points = processing.Point_3_Vector()
        for x, y, z in ring.tolist():
            points.append(kernel.Point_3(x, y, z))
        out: list[Any] = []
        processing.triangulate_hole_polyline(points, out)
        return [(one.first, one.second, one.third) for one in out]

    return run, lambda found: steps_of_triangles(
        order[np.array(found, dtype=np.int64).reshape(-1, 3)], len(p), len(q)
    )


def vtk_ruled(p: np.ndarray, q: np.ndarray) -> Timed:
    vtk = importlib.import_module("vtk")
    convert = importlib.import_module("vtk.util.numpy_support")

    def run() -> object:
        points, lines = vtk.vtkPoints(), vtk.vtkCellArray()
        points.SetData(convert.numpy_to_vtk(np.concatenate((p, q)), deep=True))
        for first, count in ((0, len(p)), (len(p), len(q))):
            lines.InsertNextCell(count)
            for number in range(first, first + count):
                lines.InsertCellPoint(number)
        data, ruled = vtk.vtkPolyData(), vtk.vtkRuledSurfaceFilter()
        data.SetPoints(points)
        data.SetLines(lines)
        ruled.SetInputData(data)
        ruled.SetRuledModeToPointWalk()
        triangles = vtk.vtkTriangleFilter()
        triangles.SetInputConnection(ruled.GetOutputPort())
        triangles.Update()
        cells = convert.vtk_to_numpy(triangles.GetOutput().GetPolys().GetConnectivityArray())
        return cells.reshape(-1, 3)

    return run, lambda found: steps_of_triangles(np.asarray(found), len(p), len(q))


def meshlib(p: np.ndarray, q: np.ndarray) -> Timed:
    mesh_py = importlib.import_module("meshlib.mrmeshpy")
    numpy_py = importlib.import_module("meshlib.mrmeshnumpy")
    # A hole needs a mesh around it: a rim of triangles that stands on the ring.
    m, n = len(p), len(q)
    ring = np.concatenate((p, q[::-1]))
    count = len(ring)
    rim = ring + (ring - ring.mean(axis=0)) * 0.05
    here, after = np.arange(count), np.roll(np.arange(count), -1)
    faces = np.concatenate(
        (
            np.stack((here, after, here + count), 1),
            np.stack((after, after + count, here + count), 1),
        )
    ).astype(np.int32)
    order = np.concatenate((np.arange(m), m + np.arange(n)[::-1]))

    def run() -> object:
        mesh = numpy_py.meshFromFacesVerts(faces, np.concatenate((ring, rim)))
        for edge in mesh.topology.findHoleRepresentiveEdges():
            if mesh.topology.org(edge).get() < count:
                mesh_py.fillHole(mesh, edge)
        return numpy_py.getNumpyFaces(mesh.topology)[len(faces) :]

    return run, lambda found: steps_of_triangles(order[np.asarray(found)], m, n)


PEERS: Final[dict[str, Callable[[np.ndarray, np.ndarray], Timed]]] = {
    "this search": own,
    "this search, price=None": own_without_price,
    "SciPy Dijkstra": dijkstra,
    "CGAL triangulate_hole_polyline": cgal,
    "VTK vtkRuledSurfaceFilter": vtk_ruled,
    "MeshLib fillHole": meshlib,
}


def run_one(name: str, kind: str, count: int) -> tuple[float, float, str, str]:
    """Seconds, megabytes, valid bridges and energy."""
    p, q = strips(count)[kind]
    run, steps_of = PEERS[name](p, q)
    run_small, _ = PEERS[name](*strips(20)[kind])
    run_small()
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    times: list[float] = []
    while not times or (len(times) < 3 and times[0] < LONG):
        start = time.process_time()
        found = run()
        times.append(time.process_time() - start)
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory) / 1024
    steps = steps_of(found)
    if steps is None:
        return min(times), grown, "no strip", ""
    made = measured(
        p,
        q,
        steps,
        planarity=default_planarity(p, q),
        criteria=("invalid", "bending"),
        search="global",
        energy="hinge",
    )
    valid = f"{made.interior_count - made.counted_invalid_count} of {made.interior_count}"
    folds = f" and {made.fold_back_count} fold-backs" if made.fold_back_count else ""
    return min(times), grown, valid, f"{made.bending:.4g}{folds}"


def answer(name: str, kind: str, count: int, connection: object) -> None:
    try:
        found: object = run_one(name, kind, count)
    except ImportError:
        found = "not installed"
    except MemoryError as error:
        found = str(error) or "out of memory"
    except Exception as error:  # another program's; the table goes on
        found = f"failed ({type(error).__name__})"
    connection.send(found)  # type: ignore[attr-defined]


def in_a_process(name: str, kind: str, count: int) -> object:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=answer, args=(name, kind, count, theirs))
    process.start()
    theirs.close()
    try:
        return ours.recv()
    except EOFError:
        return "crashed"
    finally:
        process.join()


def rows(sizes: tuple[int, ...]) -> Iterator[str]:
    """The table line by line, as it is measured; then how times grow, and what is not installed."""
    yield "| strip | search | samples | seconds | MB | valid | bending |"
    yield "|---|---|--:|--:|--:|--:|--:|"
    absent, growth = set(), []
    for kind, name in product(strips(3), PEERS):
        known: list[tuple[int, float]] = []
        for count in sizes:
            found = "not installed" if name in absent else in_a_process(name, kind, count)
            if found == "not installed":
                absent.add(name)
            elif isinstance(found, str):
                yield f"| {kind} | {name} | {count:,} | {found} | | | |"
            else:
                seconds, grown, valid, energy = found  # type: ignore[misc]
                known.append((count, seconds))
                own = f"{count:,} | {seconds:.4f} | {grown:.0f} | {valid} | {energy}"
                yield f"| {kind} | {name} | {own} |"
        if len(known) > 1:
            (first, fast), (last, slow) = known[-2:]
            exponent = math.log(slow / max(fast, 1e-9)) / math.log(last / first)
            growth.append(f"{name} on {kind} {exponent:.2f}")
    yield ""
    if growth:
        yield "Between the two largest sizes, times grow with the samples to the power of:"
        yield f"{'; '.join(growth)}."
    if absent:
        yield f"Not installed: {', '.join(sorted(absent))}."


if __name__ == "__main__":
    for row in rows(tuple(map(int, sys.argv[1:])) or SIZES):
        sys.stdout.write(f"{row}\n")
        sys.stdout.flush()
