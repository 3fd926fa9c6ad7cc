"""Writing the page of a strip of 500 triangles with its upper: below 2 s."""

from __future__ import annotations

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from tests.report.strips import dome, summary_of, view_of, wavy_rails
from wrinkle_cad.report.page import write_page

LIMIT_SECONDS = 2.0
LIMIT_BYTES = 3_000_000


@pytest.mark.parametrize(("m", "n"), [(250, 252), (5000, 5000)])
def test_the_page_is_written_in_time(benchmark: BenchmarkFixture, m: int, n: int) -> None:
    view = view_of(wavy_rails(m, n))
    summary, upper = summary_of([view]), dome(160)
    html = benchmark.pedantic(write_page, (summary, [view], upper), rounds=5, warmup_rounds=1)
    assert len(html.encode()) <= LIMIT_BYTES
    if benchmark.stats is not None:
        assert benchmark.stats.stats.max < LIMIT_SECONDS
