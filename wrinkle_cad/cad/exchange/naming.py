"""From the leaves of a document to what can be chosen: names told, edges of one name joined.

A shape has the most specific of all names that it could have, and those that tell its role go
first. An edge that went through a file as a piece of a wire is joined to the others of its name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby

from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.exchange.step.names import ItemNames
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import as_edge, edges_of, faces_of, kind_name, make_compound

from .collect import Found, take_apart
from .loose_edges import chain_edges
from .shapes import CURVE_KINDS, SURFACE_KINDS, UPPER, Holder, has_role, rail_role
from .xde import Leaf, proper_name

Marker = Callable[[TopoDS_Shape], int | None]


def found_in(leaves: Sequence[Leaf], number_of: Marker, names: ItemNames) -> list[Found]:
    """Returns what can be chosen: per named occurrence the edges that belong together joined.

    Args:
        leaves: of the document, in the file's order.
        number_of: tells the number of the item that a shape was made from.
        names: what the file calls its items, by number.
    """
    found: list[Found] = []
    for _, group in groupby(leaves, key=lambda leaf: leaf.named_at):
        found += _found_in_group(list(group), number_of, names)
    found = _uppers_as_one(found)
    curves = [item for item in found if kind_name(item.shape) in CURVE_KINDS]
    return _loosened(found) if len(curves) == 1 else found


def _found_in_group(leaves: list[Leaf], number_of: Marker, names: ItemNames) -> list[Found]:
    pieces = [
        _renamed(item, number_of, names)
        for leaf in leaves
        for part in take_apart(leaf.shape, leaf.name, leaf.color, leaf.faces)
        for item in _by_edge(replace(part, holders=leaf.holders), number_of, names)
    ]
    is_loose = [kind_name(item.shape) == "edge" for item in pieces]
    loose = [item for item, is_edge in zip(pieces, is_loose, strict=True) if is_edge]
    rest = [item for item, is_edge in zip(pieces, is_loose, strict=True) if not is_edge]
    solids = [item.shape for item in pieces if kind_name(item.shape) == "solid"]
    inner = [item for leaf in leaves for item in _inner(leaf, solids)]
    return [*rest, *_chained(loose), *inner]


def _uppers_as_one(items: list[Found]) -> list[Found]:
    """Puts the surfaces together that something holds which is called upper, as a layer may."""
    held: dict[str, list[Found]] = {}
    for item in items:
        if kind_name(item.shape) in SURFACE_KINDS and item.name.casefold() == UPPER:
            at = next((one.at for one in item.holders if one.name == item.name), "")
            held.setdefault(at, []).append(item)
    joined: dict[int, Found] = {}
    for at, parts in held.items():
        if at and len(parts) > 1:
            whole = make_compound([part.shape for part in parts])
            faces = [face for part in parts for face in part.faces]
            hidden = all(part.is_hidden for part in parts)
            one = replace(parts[0], shape=whole, faces=faces, is_hidden=hidden)
            joined.update({id(part): one for part in parts})
    return list({id(one): one for one in (joined.get(id(item), item) for item in items)}.values())


def _by_edge(item: Found, number_of: Marker, names: ItemNames) -> list[Found]:
    """Takes a wire apart whose edges have different roles by their own names."""
    if not names.candidates or kind_name(item.shape) != "wire":
        return [item]
    edges = [replace(item, shape=edge) for edge in edges_of(item.shape)]
    roles = {edge.name for edge in (_renamed(edge, number_of, names) for edge in edges)}
    return edges if len(roles) > 1 and all(has_role(role) for role in roles) else [item]


def _renamed(item: Found, number_of: Marker, names: ItemNames) -> Found:
    """Gives a shape the most specific of its names, those that tell its role first."""
    number = number_of(item.shape) if names.candidates else None
    given = [
        Holder(proper_name(name), carrier, f"{carrier} {at}")
        for name, carrier, at in names.candidates.get(-1 if number is None else number, ())
    ]
    # A product holds what a representation does, and a layer may hold several of either.
    at_product = next((i for i, one in enumerate(given) if one.carrier == "layer"), len(given))
    given[at_product:at_product] = item.holders
    fits = tuple(one for one in given if one.name)
    chosen = next((one for one in fits if _suits(item, one.name)), None)
    own = [one for one in fits if one.carrier not in ("representation", "layer")]
    named = chosen or next(iter(own or fits), Holder("", "", ""))
    return replace(
        item,
        name=named.name,
        named_by=named.carrier,
        holders=fits,
        is_hidden=number is not None and number in names.hidden,
    )


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
        is_whole = name.casefold() == UPPER == leaf.name.casefold()
        is_told = kind_name(shape) == "shell" or (has_role(name) and not is_whole)
        if is_told or own.find(shape) >= 0:
            yield Found(shape, name, color or leaf.color, is_free=False)


def _chained(loose: list[Found]) -> list[Found]:
    named: dict[str, set[str]] = {}
    for item in loose:
        for holder in item.holders:
            named.setdefault(holder.at, set()).add(item.name)
    alike: dict[tuple[object, ...], list[Found]] = {}
    for item in loose:
        # What holds curves of several names may be a strip, whose rails end there.
        strips = tuple(holder.at for holder in item.holders if len(named[holder.at]) > 1)
        alike.setdefault((item.name, item.is_hidden, strips), []).append(item)
    return [
        replace(items[first], shape=chain)
        for items in alike.values()
        for first, chain in chain_edges([as_edge(item.shape) for item in items])
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
