from __future__ import annotations

import math

import pytest

from wrinkle_cad.cad.kernel.colors import occ_color
from wrinkle_cad.errors import InputError


def test_colors_are_srgb_from_0_to_1() -> None:
    color = occ_color((1.0, 0.5, 0.0))
    assert color.Alpha() == 1.0
    # sRGB 0.5 is 0.2140 of full light.
    assert color.GetRGB().Green() == pytest.approx(0.2140, abs=1e-4)
    assert occ_color((0, 0, 0, 0.25)).Alpha() == 0.25
    for bad in ((1, 0), (0, 0, 2), (0, 0, 0, 0, 0), (0, math.nan, 0)):
        with pytest.raises(InputError, match="3 or 4 numbers from 0 to 1"):
            occ_color(bad)
