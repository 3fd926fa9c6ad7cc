"""An existing Dask cluster as an executor; its workers need this package and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Final

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.files.names import printable

_CONNECT_S: Final = 10
_TASKS_PER_THREAD: Final = 2


@contextmanager
def cluster_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """Connects to a Dask scheduler, and disconnects at the end; the cluster stays as it is.

    Args:
        address: of the scheduler ("tcp://host:8786").

    Yields:
        The executor, and how many tasks keep its workers busy.

    Raises:
        InputError: the extra is not installed, nobody answers, or there are no workers.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise InputError(
            "--scheduler needs the package distributed, which is not installed. It comes with an"
            " extra: install wrinkle-cad[cluster]."
        ) from error
    try:
        client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        reason = printable(" ".join(str(error).split()))
        raise InputError(
            f"No running Dask scheduler was reached at {printable(address)} ({reason})."
            " Check the address."
        ) from error
    try:
        threads = sum(client.nthreads().values())
        if not threads:
            raise InputError(
                f"The Dask scheduler at {printable(address)} has no workers, at least one is"
                " needed. Start one with 'dask worker ADDRESS --nthreads 1'."
            )
        yield (
            client.get_executor(pure=False, retries=0),
            min(_TASKS_PER_THREAD * threads, settings.BATCH_CLUSTER_IN_FLIGHT),
        )
    finally:
        client.close()
