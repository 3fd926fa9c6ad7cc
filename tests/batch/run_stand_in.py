"""A batch with a stand-in job in a process of its own, to be killed.

Usage: python -m tests.batch.run_stand_in INPUTS OUTPUTS FUNCTION WORKERS
"""

from __future__ import annotations

import sys
from pathlib import Path

from tests.batch import stand_ins
from wrinkle_cad.batch.folder.conversion import ConversionOptions, convert
from wrinkle_cad.batch.folder.events import BatchEvent
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import WorkerPool


def main(inputs: str, outputs: str, function: str, workers: str) -> None:
    folder = Path(outputs)
    planned = plan_batch(find_sources([inputs], folder).files, folder)
    options = ConversionOptions(job_function=getattr(stand_ins, function))

    def listen(event: BatchEvent) -> None:
        sys.stdout.write(f"{type(event).__name__}\n")
        sys.stdout.flush()

    convert(planned, folder, WorkerPool(int(workers), WorkerLimits()), listen, options)


if __name__ == "__main__":
    main(*sys.argv[1:])
