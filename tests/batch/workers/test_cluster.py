"""A batch on an existing Dask cluster: two worker processes on the loopback address."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dask
import pytest
from distributed import LocalCluster

from tests.batch.conftest import Bench
from tests.batch.stand_ins import KINDS, job_by_content
from wrinkle_cad.batch.executor import make_pool
from wrinkle_cad.batch.folder.conversion import ConversionOptions, convert
from wrinkle_cad.batch.folder.events import BatchSummary, FileFinished
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.cluster import Tls, cluster_executor
from wrinkle_cad.errors import InputError


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """The address of a cluster that gives a task up with its first worker."""
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        LocalCluster(
            n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
        ) as cluster,
    ):
        yield cluster.scheduler_address


def run(bench: Bench, scheduler: str, *, ship_bytes: bool) -> BatchSummary:
    bench.events = []
    planned = plan_batch(find_sources([str(bench.inputs)], bench.outputs).files, bench.outputs)
    options = ConversionOptions(job_function=job_by_content, ship_bytes=ship_bytes)
    with cluster_executor(scheduler) as (executor, in_flight):
        assert in_flight == 4
        pool = make_pool(
            executor=executor, workers=None, timeout=None, memory=None, in_flight=in_flight
        )
        return convert(planned, bench.outputs, pool, bench.events.append, options)


@pytest.mark.parametrize("ship_bytes", [False, True])
def test_a_cluster_does_a_batch_and_resumes_it(
    bench: Bench, scheduler: str, ship_bytes: bool
) -> None:
    bench.put(**{f"f{number}": f"content {number}" for number in range(8)})
    bench.put(bad="fail@read", bug="raise@write", **{"x/deep": "1"})
    summary = run(bench, scheduler, ship_bytes=ship_bytes)
    assert (summary.done, summary.failed) == (9, 2)
    names = {f"f{number}.{kind}" for number in range(8) for kind in KINDS}
    assert set(bench.files()) == names | {f"x/deep.{kind}" for kind in KINDS}
    assert run(bench, scheduler, ship_bytes=not ship_bytes).skipped == 9


def test_bytes_that_travel_give_the_same_files(
    bench: Bench, scheduler: str, tmp_path: Path
) -> None:
    bench.put(a="1", b="2")
    run(bench, scheduler, ship_bytes=True)
    shipped = bench.files()
    bench.outputs = tmp_path / "other"
    run(bench, scheduler, ship_bytes=False)
    assert bench.files() == shipped


def test_a_worker_of_the_cluster_that_is_killed_costs_the_file_that_it_had(
    bench: Bench, scheduler: str
) -> None:
    bench.put(a="1", b="SIGKILL@write", c="3")
    summary = run(bench, scheduler, ship_bytes=False)
    failed = [
        event.record
        for event in bench.events
        if isinstance(event, FileFinished) and not event.record.is_done
    ]
    assert "WorkerKilled" in {record.error for record in failed}
    assert "b.step" in {record.input for record in failed}
    assert summary.done + summary.failed == 3


def test_a_scheduler_that_does_not_answer_is_told_in_one_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("wrinkle_cad.batch.workers.cluster._CONNECT_S", 1)
    with (
        pytest.raises(InputError, match=r"reached at tcp://127\.0\.0\.1:9"),
        cluster_executor("tcp://127.0.0.1:9"),
    ):
        pass


def test_an_address_that_is_none_is_told_in_one_line() -> None:
    with (
        pytest.raises(InputError, match="No running Dask scheduler was reached at no such"),
        cluster_executor("no such: address"),
    ):
        pass


def test_a_missing_extra_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(InputError, match=r"install wrinkle-cad\[cluster\]"),
        cluster_executor("tcp://127.0.0.1:9"),
    ):
        pass


def certificates(folder: Path) -> Tls:
    paths = [folder / name for name in ("ca.pem", "cert.pem", "key.pem")]
    for path in paths:
        path.write_text("pem")
    return Tls(ca_file=paths[0], cert=paths[1], key=paths[2])


def test_certificates_reach_the_connection(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def refuse(address: str, *, security: Any, **_: object) -> None:
        asked.append(security)
        raise OSError("no such host")

    monkeypatch.setattr("distributed.Client", refuse)
    tls = certificates(tmp_path)
    with pytest.raises(InputError), cluster_executor("tls://127.0.0.1:9", tls):
        pass
    (security,) = asked
    assert security.require_encryption
    assert security.tls_ca_file == str(tls.ca_file)
    assert security.get_tls_config_for_role("client")["cert"] == str(tls.cert)
    assert security.get_tls_config_for_role("client")["key"] == str(tls.key)


def test_certificates_that_are_not_there_or_not_used_are_told(tmp_path: Path) -> None:
    tls = certificates(tmp_path)
    with pytest.raises(InputError, match="no tls://"), cluster_executor("tcp://127.0.0.1:9", tls):
        pass
    tls.key.unlink()
    with (
        pytest.raises(InputError, match=r"There is no file .*key\.pem"),
        cluster_executor("tls://127.0.0.1:9", tls),
    ):
        pass
