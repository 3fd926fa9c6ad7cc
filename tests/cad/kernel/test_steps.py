from __future__ import annotations

import pytest
from OCP.gp import gp_Dir

from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.errors import CadError, InputError


def test_what_the_kernel_throws_names_the_step() -> None:
    message = r"point somewhere.* the CAD kernel failed .*zero norm"
    with pytest.raises(CadError, match=message), kernel_step("point somewhere"):
        gp_Dir(0, 0, 0)


def test_errors_of_our_own_pass_through_a_step() -> None:
    with pytest.raises(InputError, match="mine"), kernel_step("anything"):
        raise InputError("mine")
