from __future__ import annotations

import numpy as np

from wrinkle_cad.strip.corridor import corridor_of_rows, whole_corridor


def test_a_corridor_holds_the_bridges_of_its_rows_and_no_others() -> None:
    random = np.random.default_rng(5)
    for _ in range(50):
        m, n = random.integers(2, 20, 2)
        left = np.sort(random.integers(0, n, m))
        left[0] = 0
        right = np.maximum.accumulate(np.maximum(random.integers(1, n + 1, m), left + 1))
        right = np.maximum(right, np.append(left[1:], n - 1) + 1)
        right[-1] = n
        right = np.maximum.accumulate(np.minimum(right, n))
        found = corridor_of_rows(left, right)
        held = {(i, d - i) for d in range(m + n - 1) for i in range(found.low[d], found.high[d])}
        assert held == {(i, j) for i in range(m) for j in range(left[i], right[i])}
        assert found.bridge_count == len(held)
        for stretch in (found.low, found.high):
            assert set(np.diff(stretch).tolist()) <= {0, 1}


def test_the_whole_corridor_takes_a_quarter_of_a_byte_per_bridge() -> None:
    found = whole_corridor(400, 300)
    assert found.bridge_count == 120_000
    assert found.first[-1] <= 120_000 / 4 + 700
