"""BREP, the kernel's own format -> shapes without names; edges and wires stay as they are."""

from __future__ import annotations

import io
import re
from typing import Final

from OCP.BinTools import BinTools
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.kernel.steps import KERNEL_ERRORS, kernel_words

from .brep_geometry import geometry_sizes
from .brep_shapes import check_shapes
from .collect import listed, take_apart
from .shapes import CadFile
from .sniff import BREP, Source
from .units import check_unit, unit_words
from .xde import silence_kernel

_BINARY: Final = b"Open CASCADE Topology V"
_SECTIONS: Final = (b"Locations", b"Curve2ds", b"Curves", b"Surfaces", b"TShapes")
# The last line of a text file refers to the shape that the file is about.
_LAST_LINE: Final = re.compile(rb"\n\s*[-+]\d+\s+\d+\s*\Z")


def read(source: Source, unit: str | None) -> CadFile:
    """Reads the content of a BREP file, text or binary.

    Args:
        source: the file.
        unit: its unit; the format has no place for one.

    Raises:
        InputError: as for ``read_cad``.
    """
    is_binary = source.content.lstrip().startswith(_BINARY)
    if not is_binary:
        _check_text(source)
    shape = _shape(source, is_binary=is_binary)
    shapes = listed(source, take_apart(shape), check_unit(source, (), unit))
    if not shapes:
        raise source.fail("no geometry: the shape in it is empty. Save it again.")
    return CadFile(
        source.path, BREP, unit_words((), unit), shapes, source.is_compressed, source.sha256
    )


def _check_text(source: Source) -> None:
    text = source.content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    missing = [name.decode() for name in _SECTIONS if b"\n" + name + b" " not in text]
    if missing or not _LAST_LINE.search(text[-4096:]):
        what = f"section {missing[0]} is missing" if missing else "its last line is missing"
        raise source.fail(f"truncated: {what}. Copy or save it again.")
    try:
        check_shapes(text, geometry_sizes(text))
    except ValueError as fault:
        raise source.fail(f"damaged: {fault}. Save it again.") from None


def _shape(source: Source, *, is_binary: bool) -> TopoDS_Shape:
    silence_kernel()
    shape = TopoDS_Shape()
    content = source.content if is_binary else source.content.replace(b"\r\n", b"\n")
    try:
        if is_binary:
            BinTools.Read_s(shape, io.BytesIO(content))
        else:
            BRepTools.Read_s(shape, io.BytesIO(content.replace(b"\r", b"\n")), BRep_Builder())
    except KERNEL_ERRORS as error:
        raise source.fail(
            f"damaged: the CAD kernel fails on it ({kernel_words(error)}). Export it again."
        ) from error
    if shape.IsNull():
        raise source.fail(
            "damaged: not readable as BREP although its frame is whole. Export it again."
        )
    return shape
