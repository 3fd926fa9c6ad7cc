"""Numbers shapes, so that the same one is found again in another place."""

from __future__ import annotations

from collections.abc import Iterable

from OCP.TopoDS import TopoDS_Shape

from .versions import ShapeMap


class ShapeIndex:
    """Shapes numbered from 0; a shape and its reverse are the same."""

    def __init__(self, shapes: Iterable[TopoDS_Shape] = ()) -> None:
        self._map = ShapeMap()
        for shape in shapes:
            self.add(shape)

    def add(self, shape: TopoDS_Shape) -> int:
        """Returns the number of a shape, a new one if it has none yet."""
        return int(self._map.Add(shape)) - 1

    def find(self, shape: TopoDS_Shape) -> int:
        """Returns the number of a shape, -1 if it has none."""
        return int(self._map.FindIndex(shape)) - 1
