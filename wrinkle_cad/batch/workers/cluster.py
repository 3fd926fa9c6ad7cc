"""An existing Dask cluster as an executor; its workers need this package and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.files.names import printable

_CONNECT_S: Final = 10
_TASKS_PER_THREAD: Final = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Tls:
    """PEM files with which a connection to a cluster is encrypted and both ends are known."""

    ca_file: Path
    """Certificates of whoever vouches for the scheduler."""
    cert: Path
    """This machine's own certificate."""
    key: Path
    """Its key."""


@contextmanager
def cluster_executor(address: str, tls: Tls | None = None) -> Iterator[tuple[Executor, int]]:
    """Connects to a Dask scheduler, and disconnects at the end; the cluster stays as it is.

    Args:
        address: of the scheduler ("tcp://host:8786", "tls://host:8786").
        tls: files that this machine shows and trusts; those of Dask's own configuration when None.

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
        client = Client(
            address, timeout=_CONNECT_S, set_as_default=False, security=_security(address, tls)
        )
    except (OSError, TimeoutError, ValueError, TypeError) as error:
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


def _security(address: str, tls: Tls | None) -> Any:
    if tls is None:
        return None
    if not address.startswith("tls://"):
        raise InputError(
            f"Certificates are given, but {printable(address)} is no tls:// address. Give"
            " tls://HOST:PORT, or leave the certificates out."
        )
    for path in (tls.ca_file, tls.cert, tls.key):
        if not path.is_file():
            raise InputError(
                f"There is no file {printable(str(path))} with a certificate or key. Check the"
                " path."
            )
    from distributed.security import Security

    return Security(
        require_encryption=True,
        tls_ca_file=str(tls.ca_file),
        tls_client_cert=str(tls.cert),
        tls_client_key=str(tls.key),
    )
