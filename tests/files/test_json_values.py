from __future__ import annotations

import json
import math
from types import MappingProxyType

from wrinkle_cad.files.json_values import finite


def test_numbers_that_json_has_no_word_for_become_null() -> None:
    value = {
        1: (1.5, math.inf, -math.inf),
        "b": [math.nan, {"c": MappingProxyType({"d": math.inf})}],
    }
    assert json.dumps(finite(value), allow_nan=False) == (
        '{"1": [1.5, null, null], "b": [null, {"c": {"d": null}}]}'
    )


def test_texts_flags_and_nothing_stay_as_they_are() -> None:
    assert finite(["inf", True, None, 3, 2.5]) == ["inf", True, None, 3, 2.5]
