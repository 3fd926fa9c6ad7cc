"""The hash of a job's settings: what decides, with its input's, whether it must be done again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

from wrinkle_cad.files.regular import hash_regular
from wrinkle_cad.job.job import Job
from wrinkle_cad.options.option import options_of

_NOT_A_SETTING: Final = frozenset({"input", "output_dir"})


def hash_settings(job: Job, versions: Mapping[str, str]) -> str:
    """SHA-256 of everything but the input's content that the outputs of a job depend on.

    The name of the input file counts, since outputs mention it; its folder does not. A setting that
    is a file (a material, a table of layers) counts by its content.

    Args:
        job: the settings.
        versions: of every package at work, as `installed_versions` gives them.

    Raises:
        OSError: a file among the settings cannot be read.
    """
    values: dict[str, Any] = {"input": job.input.name, "versions": dict(versions)}
    settings = options_of(type(job))
    for field in fields(job):
        if field.name not in _NOT_A_SETTING:
            value = getattr(job, field.name)
            is_file = value is not None and settings[field.name].is_path(value)
            values[field.name] = {"file": hash_regular(Path(value))} if is_file else value
    text = json.dumps(values, sort_keys=True, ensure_ascii=True, default=str)
    return hashlib.sha256(text.encode("ascii")).hexdigest()
