"""A script and the command line do the same where neither is told anything else."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path

import pytest

from wrinkle_cad import Pattern, WrinkleStrip, carve, wrinkle_profiles
from wrinkle_cad.job.job import Job
from wrinkle_cad.options.option import options_of
from wrinkle_cad.strip import triangulate

JOB = Job(input=Path("shoe.step"))
KEYS = {"version": "dxf_version", "seconds": "nest_seconds", "schema": "step_schema"}
"""Parameters that a job, where they stand beside those of other formats, calls otherwise."""
NOT_THE_JOBS = {
    "name": "a job's is its file's",
    "material": "a pattern's is a text on its pieces, a job's is looked up",
    "join": "carve joins faces of the upper that lie apart, a job the curves of a rail",
    "margin": "a job knows the height of the waves, and carve does not",
}
LEAST = {
    WrinkleStrip: 11,
    WrinkleStrip.pattern: 20,
    WrinkleStrip.export_step: 1,
    Pattern.export_dxf: 4,
    Pattern.nested: 1,
    triangulate: 5,
    wrinkle_profiles: 3,
    carve: 2,
}
"""How many of their parameters are options of a job, at least."""


def options_among(function: Callable[..., object]) -> dict[str, tuple[object, object]]:
    """Its own default and the job's, for each of its parameters that is an option of a job."""
    return {
        name: (parameter.default, getattr(JOB, KEYS.get(name, name)))
        for name, parameter in inspect.signature(function).parameters.items()
        if KEYS.get(name, name) in options_of(Job)
        and name not in NOT_THE_JOBS
        and parameter.default is not inspect.Parameter.empty
    }


@pytest.mark.parametrize("function", LEAST, ids=lambda function: function.__qualname__)
def test_what_a_script_calls_has_the_defaults_of_a_job(function: Callable[..., object]) -> None:
    found = options_among(function)
    assert len(found) >= LEAST[function]
    for name, (own, of_the_job) in found.items():
        meant = options_of(Job)[KEYS.get(name, name)].option.when_none
        if of_the_job is None and own is not None:
            # The job asks its material first.
            assert meant == f"the material's, or {own:g}", name
        else:
            assert own == of_the_job, name
