"""STEP -> named shapes, through the kernel's document of names, colors and placements."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Final

from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.exchange.step.links import link_fault
from wrinkle_cad.cad.exchange.step.names import ItemNames, item_names, mark_of, marked_text
from wrinkle_cad.cad.exchange.step.text import check_step, length_units, plain_text, why_no_shape
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.steps import KERNEL_ERRORS
from wrinkle_cad.cad.kernel.topology import as_edge, edges_of, faces_of, kind_name
from wrinkle_cad.files.names import error_words

from .collect import Found, listed, take_apart
from .loose_edges import chain_edges
from .shapes import CURVE_KINDS, UPPER, CadFile, has_role, rail_role
from .sniff import STEP, Source
from .units import check_unit, unit_words
from .xde import Leaf, kernel_parameters, leaves_of, new_document, proper_name, silence_kernel

Marker = Callable[[TopoDS_Shape], int | None]

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
    text = plain_text(source.content)
    check_step(source, text)
    fault = link_fault(text)
    if fault is not None:
        raise source.fail(f"damaged: {fault}. Export it again.")
    declared = length_units(text)
    mm_per_unit = check_unit(source, declared, unit)
    names = item_names(text)
    shapes = listed(
        source, _found(*_leaves(source, marked_text(text, names), text), names), mm_per_unit
    )
    if not any(shape.measure > 0.0 for shape in shapes):
        raise source.fail(why_no_shape(text))
    words = unit_words(declared, unit)
    return CadFile(source.path, STEP, words, shapes, source.is_compressed)


def _leaves(source: Source, marked: bytes, text: bytes) -> tuple[list[Leaf], Marker]:
    silence_kernel()
    document = new_document()
    try:
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        reader.SetColorMode(True)
        has_names = int(bool(_NAMED_SURFACE.search(text)))
        with kernel_parameters(
            {"xstep.cascade.unit": "MM", "read.stepcaf.subshapes.name": has_names}
        ):
            if reader.ReadStream(source.path.name, io.BytesIO(marked)) != IFSelect_RetDone:
                raise source.fail(
                    "damaged: not readable as STEP although its frame is whole. Export it again."
                )
            if reader.NbRootsForTransfer() == 0 or not reader.Transfer(document):
                return [], lambda _: None
        return leaves_of(document), _marker(reader)
    except KERNEL_ERRORS as error:
        raise source.fail(
            f"damaged: the CAD kernel fails on it ({error_words(error)}). Export it again."
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


def _found(leaves: list[Leaf], number_of: Marker, names: ItemNames) -> list[Found]:
    """Returns what can be chosen: per named occurrence the edges that belong together joined."""
    found: list[Found] = []
    for _, group in groupby(leaves, key=lambda leaf: leaf.named_at):
        found += _found_in_group(list(group), number_of, names)
    curves = [item for item in found if kind_name(item.shape) in CURVE_KINDS]
    return _loosened(found) if len(curves) == 1 else found


def _found_in_group(leaves: list[Leaf], number_of: Marker, names: ItemNames) -> list[Found]:
    pieces = [
        _renamed(item, number_of, names)
        for leaf in leaves
        for part in take_apart(leaf.shape, leaf.name, leaf.color, leaf.faces)
        for item in _by_edge(part, number_of, names)
    ]
    is_loose = [kind_name(item.shape) == "edge" for item in pieces]
    loose = [item for item, is_edge in zip(pieces, is_loose, strict=True) if is_edge]
    rest = [item for item, is_edge in zip(pieces, is_loose, strict=True) if not is_edge]
    solids = [item.shape for item in pieces if kind_name(item.shape) == "solid"]
    inner = [item for leaf in leaves for item in _inner(leaf, solids)]
    return [*rest, *_chained(loose), *inner]


def _by_edge(item: Found, number_of: Marker, names: ItemNames) -> list[Found]:
    """Takes a wire apart whose edges have different roles by their own names."""
    if not names.candidates or kind_name(item.shape) != "wire":
        return [item]
    edges = [replace(item, shape=edge) for edge in edges_of(item.shape)]
    roles = {edge.name for edge in (_renamed(edge, number_of, names) for edge in edges)}
    return edges if len(roles) > 1 and all(has_role(role) for role in roles) else [item]


def _renamed(item: Found, number_of: Marker, names: ItemNames) -> Found:
    """Gives a curve or surface the most specific of its names, those that tell its role first."""
    if not names.candidates or kind_name(item.shape) not in (*CURVE_KINDS, "face", "shell"):
        return item
    number = number_of(item.shape)
    if number is None or number not in names.candidates:
        return item
    given = [(proper_name(name), carrier) for name, carrier in names.candidates[number]]
    at_product = next((i for i, (_, word) in enumerate(given) if word == "layer"), len(given))
    given.insert(at_product, (item.name, "product"))
    fits = [(name, word) for name, word in given if name]
    chosen = next((pair for pair in fits if _suits(item, pair[0])), None)
    own = [pair for pair in fits if pair[1] not in ("representation", "layer")]
    name, carrier = chosen or (own or fits or [("", "")])[0]
    return replace(item, name=name, named_by=carrier, is_hidden=number in names.hidden)


def _suits(item: Found, name: str) -> bool:
    is_curve = kind_name(item.shape) in CURVE_KINDS
    return (rail_role(name) is not None) if is_curve else name.casefold() == UPPER


def _inner(leaf: Leaf, solids: Sequence[TopoDS_Shape]) -> Iterator[Found]:
    """Yields the named shells and faces of solids; of shells only the faces named for a role.

    A shell is chosen as a whole, and may have hundreds of faces under a few names.
    """
    if not leaf.named_surfaces:
        return
    own = ShapeIndex(face for solid in solids for face in faces_of(solid))
    for name, shape, color in leaf.named_surfaces:
        if kind_name(shape) == "shell" or has_role(name) or own.find(shape) >= 0:
            yield Found(shape, name, color or leaf.color, is_free=False)


def _chained(loose: list[Found]) -> list[Found]:
    alike: dict[tuple[str, bool], list[Found]] = {}
    for item in loose:
        alike.setdefault((item.name, item.is_hidden), []).append(item)
    return [
        replace(items[0], shape=chain)
        for items in alike.values()
        for chain in chain_edges([as_edge(item.shape) for item in items])
    ]


def _loosened(found: list[Found]) -> list[Found]:
    """Takes a wire of two edges, the only curve, apart: they are two rails that meet at an end."""
    apart: list[Found] = []
    for item in found:
        edges = edges_of(item.shape) if kind_name(item.shape) == "wire" else []
        if len(edges) == 2 and not has_role(item.name):
            apart += [replace(item, shape=edge) for edge in edges]
        else:
            apart.append(item)
    return apart
