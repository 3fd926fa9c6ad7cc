from __future__ import annotations

import gc

import pytest

from wrinkle_cad.cad.kernel.loading import kernel_importable
from wrinkle_cad.errors import CadError


def test_a_missing_library_is_one_line_that_says_what_to_do() -> None:
    with pytest.raises(CadError, match="libGL") as caught, kernel_importable():
        raise ImportError("libGL.so.1: cannot open shared object file:\n No such file")
    assert "\n" not in str(caught.value)
    assert "doctor" in str(caught.value)


def test_the_collector_rests_meanwhile_and_works_again_afterwards() -> None:
    assert gc.isenabled()
    with kernel_importable():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_a_collector_that_was_off_stays_off() -> None:
    gc.disable()
    try:
        with kernel_importable():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
