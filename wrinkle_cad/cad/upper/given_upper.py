"""An upper as its user has it, as one shape of the kernel: any object of build123d or CadQuery."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from OCP.BRepClass3d import BRepClass3d
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Shape

from wrinkle_cad.cad.kernel.topology import faces_of, make_compound, unwrap
from wrinkle_cad.errors import InputError


def upper_shape(source: object) -> TopoDS_Shape:
    """Returns the shape in an upper; of a solid its outer shell.

    Args:
        source: a face, shell, solid, part, sketch, compound or list of such; a builder of build123d
            or a workplane of CadQuery that holds one; or a shape of the kernel.

    Raises:
        InputError: something else, or no face in it.

    Example:
        >>> from build123d import Box
        >>> len(faces_of(upper_shape([Box(1, 2, 3)])))
        6
    """
    found = _shapes_in(source)
    shape = found[0] if len(found) == 1 else make_compound(found)
    if not faces_of(shape):
        raise InputError(
            f"There is no face in the upper, a {type(source).__name__}. Pass a face, a shell, a"
            " solid, or several faces."
        )
    return _without_hollows(shape)


def upper_object(source: object) -> object:
    """Returns the object whose name and color the upper has: of a builder, what it has built."""
    held = _held_by(source)
    return held[0] if isinstance(held, list) and len(held) == 1 else source


def _shapes_in(source: object) -> list[TopoDS_Shape]:
    if isinstance(source, TopoDS_Shape) or isinstance(
        getattr(source, "wrapped", None), TopoDS_Shape
    ):
        return [unwrap(source)]
    held = _held_by(source)
    if isinstance(held, Iterable) and not isinstance(held, str | bytes):
        return [shape for item in held for shape in _shapes_in(item)]
    raise InputError(
        f"The upper cannot be a {type(source).__name__}. Pass a face, a shell, a solid or several"
        " faces of build123d or CadQuery."
    )


def _held_by(source: Any) -> Any:
    """What a workplane of CadQuery or a builder of build123d has made; else the source itself."""
    if callable(getattr(source, "vals", None)):
        return list(source.vals())
    for attribute in ("part", "sketch"):
        made = getattr(source, attribute, None)
        if isinstance(getattr(made, "wrapped", None), TopoDS_Shape):
            return [made]
    return source


def _without_hollows(shape: TopoDS_Shape) -> TopoDS_Shape:
    """Returns a shape with the outer shell in place of each solid; one without solids as it is."""
    shells: list[TopoDS_Shape] = []
    solids = TopExp_Explorer(shape, TopAbs_SOLID)
    while solids.More():
        shells.append(BRepClass3d.OuterShell_s(TopoDS.Solid(solids.Current())))
        solids.Next()
    if not shells:
        return shape
    loose = TopExp_Explorer(shape, TopAbs_FACE, TopAbs_SOLID)
    while loose.More():
        shells.append(loose.Current())
        loose.Next()
    return shells[0] if len(shells) == 1 else make_compound(shells)
