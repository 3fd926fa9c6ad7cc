"""STEP -> named shapes, through the kernel's document of names, colors and placements."""

from __future__ import annotations

import io
import re
from typing import Final

from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.exchange.step.links import link_fault
from wrinkle_cad.cad.exchange.step.names import (
    item_names,
    mark_of,
    marked_text,
)
from wrinkle_cad.cad.exchange.step.readable import with_construction, with_wires
from wrinkle_cad.cad.exchange.step.text import check_step, length_units, plain_text, why_no_shape
from wrinkle_cad.cad.kernel.steps import KERNEL_ERRORS, kernel_words
from wrinkle_cad.files.names import printable

from .collect import listed
from .naming import Marker, found_in
from .shapes import (
    CadFile,
    NamedShape,
)
from .sniff import STEP, Source
from .units import check_unit, unit_words
from .unread import are_styles_whole, unread_shape
from .xde import Leaf, kernel_parameters, leaves_of, new_document, silence_kernel

_NAMED_SURFACE: Final = re.compile(
    rb"\b(?:ADVANCED_FACE|FACE_SURFACE|OPEN_SHELL|CLOSED_SHELL)\s*\(\s*'(?!'|NONE'|Unnamed')"
)


def read(source: Source, unit: str | None) -> CadFile:
    """Reads the content of a STEP file.

    Args:
        source: the file.
        unit: the unit of a file that declares none.

    Raises:
        InputError: as for ``read_cad``.
    """
    text = with_wires(plain_text(source.content))
    check_step(source, text)
    fault = link_fault(text)
    if fault is not None:
        raise source.fail(f"damaged: {fault}. Export it again.")
    declared = length_units(text)
    mm_per_unit = check_unit(source, declared, unit)
    shapes = _shapes(source, text, mm_per_unit)
    if not any(shape.is_curve for shape in shapes):
        # Supplemental geometry helps to construct; where the file has no other curve, it counts.
        whole = with_construction(text)
        shapes = shapes if whole == text else _shapes(source, whole, mm_per_unit)
    if not any(shape.measure > 0.0 for shape in shapes):
        raise source.fail(why_no_shape(text))
    words = unit_words(declared, unit)
    return CadFile(source.path, STEP, words, shapes, source.is_compressed, source.sha256)


def _shapes(source: Source, text: bytes, mm_per_unit: float) -> tuple[NamedShape, ...]:
    names = item_names(text)
    leaves, number_of = _leaves(source, marked_text(text, names), text)
    return listed(source, found_in(leaves, number_of, names), mm_per_unit)


def _leaves(source: Source, marked: bytes, text: bytes) -> tuple[list[Leaf], Marker]:
    silence_kernel()
    document = new_document()
    try:
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        has_names = int(bool(_NAMED_SURFACE.search(text)))
        with kernel_parameters(
            {"xstep.cascade.unit": "MM", "read.stepcaf.subshapes.name": has_names}
        ):
            if reader.ReadStream(source.path.name, io.BytesIO(marked)) != IFSelect_RetDone:
                raise source.fail(
                    "damaged: not readable as STEP although its frame is whole. Export it again."
                )
            fault = unread_shape(reader)
            if fault is not None:
                raise source.fail(
                    f"damaged: entity {fault.rank} of its data cannot be read"
                    f" ({printable(fault.complaint)}). Export it again."
                )
            reader.SetColorMode(are_styles_whole(reader))
            if reader.NbRootsForTransfer() == 0 or not reader.Transfer(document):
                return [], lambda _: None
        return leaves_of(document), _marker(reader)
    except KERNEL_ERRORS as error:
        raise source.fail(
            f"damaged: the CAD kernel fails on it ({kernel_words(error)}). Export it again."
        ) from error


def _marker(reader: STEPCAFControl_Reader) -> Marker:
    """Returns a function that tells the number of the item that a shape was made from."""

    def number_of(shape: TopoDS_Shape) -> int | None:
        # Asked anew each time: what the reader has made goes when the reader does.
        transfer = reader.Reader().WS().TransferReader()
        entity = transfer.EntityFromShapeResult(shape.Located(TopLoc_Location()), -1)
        name = entity.Name() if hasattr(entity, "Name") else None
        return None if name is None else mark_of(str(name.ToCString()))

    return number_of
