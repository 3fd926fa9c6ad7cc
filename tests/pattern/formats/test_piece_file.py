"""Pieces come back from their file as they were, to the last bit; other files are refused."""

from __future__ import annotations

import json
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.formats.dxf import dxf_file
from wrinkle_cad.pattern.formats.piece_file import pieces_text, read_pieces, write_pieces
from wrinkle_cad.pattern.piece.options import PieceSettings

FULL = PieceSettings(
    seam_allowance=(6.0, 4.0, 3.0, 2.0),
    notches=4,
    rulings=True,
    stretch="across",
    drill_holes=((0.5, 0.5),),
    bend_table=True,
    hand="left",
    material="Calf, 1.2 mm",
)


def check_equal(one, other):
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype
        assert np.array_equal(one, other)
        assert not other.flags.writeable
    elif is_dataclass(one):
        for field in fields(one):
            if field.name != "findings":
                check_equal(getattr(one, field.name), getattr(other, field.name))
    elif isinstance(one, tuple):
        assert len(one) == len(other)
        for part, its in zip(one, other, strict=True):
            check_equal(part, its)
    else:
        assert one == other


@pytest.mark.parametrize("seed", range(4))
def test_pieces_come_back_as_they_were(seed, tmp_path):
    settings = FULL if seed % 2 else PieceSettings()
    pieces = make_pieces(*strips.random_strip(seed), name="é", settings=settings)
    path = tmp_path / "s.pieces"
    write_pieces(path, pieces)
    back = read_pieces(path)
    check_equal(pieces, back)
    assert dxf_file(back).content == dxf_file(pieces).content


@pytest.mark.parametrize(
    "spoil",
    [
        lambda content: content.update(schema="another"),
        lambda content: content.update(version=99),
        lambda content: content["pieces"][0].pop("name"),
        lambda content: content["pieces"][0]["cut"]["points"].pop(),
        lambda content: content["pieces"][0].update(grain_line=[[0, 0]]),
        lambda content: content["pieces"][0].update(grain_line=[[0, 0], [1, "x"]]),
        lambda content: content.update(pieces=7),
    ],
)
def test_what_is_no_file_of_pieces_is_refused(spoil, tmp_path):
    content = json.loads(pieces_text(make_pieces(*strips.rectangle(), name="s")))
    spoil(content)
    path = tmp_path / "s.pieces"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=r"s\.pieces is no file of pieces"):
        read_pieces(path)
    path.unlink()
    with pytest.raises(InputError, match="cannot be read"):
        read_pieces(path)
