"""What NAME.json holds: the result of a job as plain values."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wrinkle_cad.errors import Finding
from wrinkle_cad.files.json_values import finite
from wrinkle_cad.report.versions import installed_versions

from .job import Job
from .outputs import SCHEMA, SCHEMA_VERSION

if TYPE_CHECKING:
    from wrinkle_cad.cad.exchange.choose import Chosen
    from wrinkle_cad.cad.exchange.shapes import CadFile
    from wrinkle_cad.report.limits import Limits


def summary_of(
    job: Job,
    file: CadFile,
    chosen: Chosen,
    entries: Sequence[dict[str, Any]],
    findings: Sequence[Finding],
    limits: Limits,
) -> dict[str, Any]:
    """Collects what is known before the outputs are written.

    Args:
        job: the settings.
        file: what was read.
        chosen: what was taken from the file.
        entries: one per strip, as ``entries_of`` gives them.
        findings: what was noticed.
        limits: what the strips are judged by.
    """
    from wrinkle_cad.report.verdict import judge

    verdict = judge(entries, limits)
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "input": {
            "file": job.input.name,
            "format": file.format,
            "unit": file.unit,
            "sha256": file.sha256,
            "reasons": list(chosen.reasons),
        },
        "settings": settings_as_json(job),
        "versions": installed_versions(),
        "strips": list(entries),
        "verdict": verdict.as_json(),
        "findings": [asdict(finding) for finding in findings],
    }


def settings_as_json(job: Job) -> dict[str, Any]:
    """The settings that shape the result: no folders, which differ between machines."""
    left_out = {"input", "output_dir", "source_date_epoch"}
    return {
        key: value.name if isinstance(value, Path) else value
        for key, value in asdict(job).items()
        if key not in left_out
    }


def to_json(summary: Mapping[str, Any]) -> str:
    """JSON text of a summary; what is not finite stands as null."""
    return json.dumps(finite(summary), ensure_ascii=False, indent=1, allow_nan=False) + "\n"
