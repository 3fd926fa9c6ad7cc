"""Entities of a STEP file that the kernel could not take in, from its own list of complaints.

An entity with a parameter too many, too few or of another kind stays in the kernel's model without
its values, and whoever makes a shape of it follows a pointer to nowhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

from OCP.STEPCAFControl import STEPCAFControl_Reader

_SHAPED: Final = ("StepGeom_", "StepShape_")
_DRAWN: Final = ("StepVisual_",)
_HARMLESS: Final = "(name)"
"""A name that is no text: some programs leave names out, and nothing else is amiss."""


class Unread(NamedTuple):
    """An entity whose values are not all there."""

    rank: int
    """Which it is of the entities of the file, from 1."""
    kind: str
    """The kernel's name for what it is."""
    complaint: str
    """What the kernel says."""


def unread_shape(reader: STEPCAFControl_Reader) -> Unread | None:
    """Returns the first piece of geometry or topology without its values, None if all have them."""
    return next((each for each in _unread(reader) if each.kind.startswith(_SHAPED)), None)


def are_styles_whole(reader: STEPCAFControl_Reader) -> bool:
    """Whether everything about colors and layers has its values."""
    return not any(each.kind.startswith(_DRAWN) for each in _unread(reader))


def _unread(reader: STEPCAFControl_Reader) -> Iterator[Unread]:
    model = reader.Reader().StepModel()
    for rank in range(1, model.NbEntities() + 1):
        if not model.IsReportEntity(rank, False):
            continue
        check = model.ReportEntity(rank, False).Check()
        said = (str(check.CFail(i)) for i in range(1, check.NbFails() + 1))
        complaint = next((line for line in said if _HARMLESS not in line), None)
        if complaint is not None:
            yield Unread(rank, model.Value(rank).DynamicType().Name(), complaint)
