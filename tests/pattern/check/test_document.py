"""What is no DXF, or a hostile one, ends in one sentence, quickly and in little memory."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from tests.pattern import strips
from tests.pattern.strips import dxf_bytes, make_pieces
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.check import limits
from wrinkle_cad.pattern.check.judging import judge_dxf

SQUARE = ((0, 0), (100, 0), (100, 50), (0, 50))
CUT = {"layer": "CUT"}
CASES = Path(__file__).parent / "cases"


def refusal(path):
    """The one sentence that a file is refused with, None if it is judged."""
    began = time.process_time()
    try:
        judge_dxf(path)
        message = None
    except InputError as error:
        message = str(error)
        assert message.startswith(path.name)
        assert message.endswith(".")
        assert "\n" not in message
    assert time.process_time() - began < 5.0
    return message


@pytest.mark.parametrize(
    ("name", "content"),
    {
        "empty": b"",
        "text": b"this is no drawing\n" * 30,
        "binary": bytes(range(256)) * 20,
        "step": b"ISO-10303-21;\nHEADER;\nENDSEC;\nEND-ISO-10303-21;\n",
        "noise with a section": b"SECTION" + bytes(range(256)) * 2000,
        "binary mark alone": b"AutoCAD Binary DXF\r\n\x1a\x00SECTION",
    }.items(),
)
def test_what_is_no_dxf_is_one_sentence(name, content, tmp_path):
    path = tmp_path / "broken.dxf"
    path.write_bytes(content)
    assert refusal(path)


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    assert refusal(tmp_path / "none.dxf")
    assert refusal(tmp_path)


def test_a_pipe_is_refused_without_waiting_for_a_writer(tmp_path):
    path = tmp_path / "pipe.dxf"
    os.mkfifo(path)
    assert "regular file" in refusal(path)


def test_a_file_without_end_is_refused_unread(tmp_path):
    path = tmp_path / "huge.dxf"
    with path.open("wb") as stream:
        stream.truncate(2**40)
    assert "MiB" in refusal(path)


@pytest.fixture
def document():
    made = ezdxf.new("R2000", units=4)
    made.layers.add("CUT")
    return made


def saved(document, tmp_path):
    path = tmp_path / "made.dxf"
    document.saveas(path)
    return path


def test_blocks_that_insert_each_other_are_refused(document, tmp_path):
    document.blocks.new("A").add_blockref("B", (0, 0))
    document.blocks.new("B").add_blockref("A", (0, 0))
    document.modelspace().add_blockref("A", (0, 0))
    assert "contains itself" in refusal(saved(document, tmp_path))


def test_blocks_that_double_forty_times_are_refused(document, tmp_path):
    document.blocks.new("B0").add_line((0, 0), (1, 1), dxfattribs=CUT)
    for i in range(1, 40):
        block = document.blocks.new(f"B{i}")
        block.add_blockref(f"B{i - 1}", (0, 0))
        block.add_blockref(f"B{i - 1}", (1, 0))
    document.modelspace().add_blockref("B39", (0, 0))
    assert "more than 50,000" in refusal(saved(document, tmp_path))


@pytest.mark.parametrize("depth", [150, 600])
def test_deeply_nested_blocks_are_refused(depth, document, tmp_path):
    document.blocks.new("B0").add_line((0, 0), (1, 1), dxfattribs=CUT)
    for i in range(1, depth):
        document.blocks.new(f"B{i}").add_blockref(f"B{i - 1}", (0, 0))
    document.modelspace().add_blockref(f"B{depth - 1}", (0, 0))
    # ezdxf itself gives up on the deeper one.
    assert refusal(saved(document, tmp_path))


@pytest.mark.parametrize("empty", [False, True])
def test_a_block_inserted_by_the_million_is_refused(empty, document, tmp_path):
    block = document.blocks.new("A")
    if not empty:
        block.add_lwpolyline(SQUARE, close=True, dxfattribs=CUT)
    insert = document.modelspace().add_blockref("A", (0, 0))
    insert.dxf.row_count, insert.dxf.column_count = 30_000, 30_000
    assert "more than 50,000" in refusal(saved(document, tmp_path))


def test_copies_of_a_long_line_are_counted_by_its_vertices(document, tmp_path):
    block = document.blocks.new("A")
    block.add_lwpolyline([(i, (i * i) % 7) for i in range(1000)], dxfattribs=CUT)
    insert = document.modelspace().add_blockref("A", (0, 0))
    insert.dxf.row_count, insert.dxf.column_count = 10, 10
    assert "more than 50,000 lines, marks and vertices" in refusal(saved(document, tmp_path))


def thousands_of_circles(space):
    for i in range(4000):
        space.add_circle((100 * (i % 200), 100 * (i // 200)), 45, dxfattribs=CUT)


def a_spline_through_thousands_of_points(space):
    space.add_spline([(i % 97, (i * i) % 89, 0) for i in range(3000)], dxfattribs=CUT)


@pytest.mark.parametrize("draw", [thousands_of_circles, a_spline_through_thousands_of_points])
def test_curves_that_take_too_many_points_to_follow_are_refused(draw, document, tmp_path):
    draw(document.modelspace())
    assert refusal(saved(document, tmp_path))


def contours_that_all_cross(space):
    for k in range(80):
        rows = [((i * 7919 + k) % 10007, (i * 104729 + k) % 9973) for i in range(60)]
        space.add_lwpolyline(rows, close=True, dxfattribs=CUT)


def one_tangle(space):
    rows = [((i * 7919) % 10007, (i * 104729) % 9973) for i in range(5000)]
    space.add_lwpolyline(rows, close=True, dxfattribs=CUT)


def the_same_triangle_by_the_thousand(space):
    for i in range(300):
        space.add_lwpolyline(((0, 0), (100 + 1e-4 * i, 0), (50, 80)), close=True, dxfattribs=CUT)


@pytest.mark.parametrize(
    ("draw", "code"),
    [
        (contours_that_all_cross, "contours-touch"),
        (one_tangle, "self-intersection"),
        (the_same_triangle_by_the_thousand, "doubled-contour"),
    ],
)
def test_contours_that_all_meet_are_judged_in_time(draw, code, document, tmp_path):
    draw(document.modelspace())
    path = saved(document, tmp_path)
    began = time.process_time()
    assert code in [finding.code for finding in judge_dxf(path).findings]
    assert time.process_time() - began < 5.0


def test_a_binary_file_with_a_layout_whose_block_is_gone_is_one_sentence():
    assert "contradicts itself" in refusal(CASES / "destroyed_layout.dxf")


def test_nothing_but_our_own_sentences_reaches_the_screen(document, tmp_path):
    document.modelspace().add_lwpolyline(SQUARE, close=True, dxfattribs=CUT)
    path = saved(document, tmp_path)
    # ezdxf logs a warning for each number that it mends.
    path.write_text(path.read_text().replace("\n 10\n0.0\n", "\n 10\n0.q0\n"))
    script = (
        "import sys; from pathlib import Path\n"
        "from wrinkle_cad.pattern.check.judging import judge_dxf\n"
        "print(judge_dxf(Path(sys.argv[1])).findings[0].code)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=True
    )
    assert (done.stdout, done.stderr) == ("structure\n", "")


@pytest.mark.parametrize("number", ["nan", "inf", "-1e300", "1e308"])
def test_numbers_that_are_none_are_named_and_the_rest_is_judged(number, document, tmp_path):
    space = document.modelspace()
    space.add_lwpolyline(SQUARE, close=True, dxfattribs=CUT)
    bad = 77.125
    space.add_lwpolyline(((200, 0), (bad, 10), (250, 10)), close=True, dxfattribs=CUT)
    space.add_line((300, 0), (bad, 9), dxfattribs=CUT)
    space.add_circle((bad, 0), 5, dxfattribs=CUT)
    space.add_circle((400, 0), bad, dxfattribs=CUT)
    space.add_lwpolyline(
        ((500, 0, bad), (600, 0, 0), (550, 30, 0)), "xyb", close=True, dxfattribs=CUT
    )
    space.add_spline([(bad, 0), (1, 1), (2, 5), (3, 0)], dxfattribs=CUT)
    space.add_text("MM", dxfattribs={"layer": "TEXT"}).set_placement((bad, 0))
    path = saved(document, tmp_path)
    path.write_text(path.read_text().replace("77.125", number))
    began = time.process_time()
    report = judge_dxf(path)
    assert time.process_time() - began < 5.0
    counts = {finding.code: n for finding, n in zip(report.findings, report.counts, strict=True)}
    assert counts["coordinates"] >= 5
    assert report.contour_count >= 1
    assert not report.is_clean


def test_a_thousand_lines_on_top_of_each_other_are_judged_in_time(document, tmp_path):
    for i in range(1500):
        x = 1e-3 * i
        document.modelspace().add_line((x, 0), (x + 500, 0), dxfattribs=CUT)
    path = saved(document, tmp_path)
    began = time.process_time()
    assert "overlap" in [finding.code for finding in judge_dxf(path).findings]
    assert time.process_time() - began < 5.0


def test_a_hostile_file_is_refused_in_little_memory(document, tmp_path):
    document.blocks.new("B0").add_line((0, 0), (1, 1), dxfattribs=CUT)
    for i in range(1, 60):
        block = document.blocks.new(f"B{i}")
        for x in range(8):
            block.add_blockref(f"B{i - 1}", (x, 0))
    document.modelspace().add_blockref("B59", (0, 0))
    path = saved(document, tmp_path)
    script = (
        "import sys; from pathlib import Path\n"
        "from wrinkle_cad.pattern.check.judging import judge_dxf\n"
        "try:\n    judge_dxf(Path(sys.argv[1]))\nexcept ValueError:\n"
        # Not ru_maxrss, which a process takes over from the one that started it.
        "    status = Path('/proc/self/status').read_text().split()\n"
        "    print(status[status.index('VmHWM:') + 1])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=True
    )
    assert 0 < int(done.stdout) < 500 * 1024


def test_any_prefix_of_a_sound_file_is_judged_or_refused(tmp_path):
    whole = dxf_bytes(make_pieces(*strips.rectangle(), name="part"), profile="astm")
    path = tmp_path / "cut.dxf"
    for end in range(50, len(whole), len(whole) // 12):
        path.write_bytes(whole[:end])
        if refusal(path) is None:
            assert "structure" in [finding.code for finding in judge_dxf(path).findings]


def test_the_limit_lets_a_binary_file_through(document, tmp_path):
    document.modelspace().add_lwpolyline(SQUARE, close=True, dxfattribs=CUT)
    path = tmp_path / "binary.dxf"
    document.saveas(path, fmt="bin")
    assert path.stat().st_size < limits.FILE_LIMIT
    assert judge_dxf(path).is_clean
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    assert refusal(path)


def many_lines(path, count):
    """Contours of a thousand loose lines each, as some programs write them, in the plainest DXF."""
    turn = 2.0 * np.pi * np.arange(1001) / 1000
    rows = []
    for number in range(count // 1000):
        x = (300 * (number % 10) + 100 * np.cos(turn)).round(4).tolist()
        y = (300 * (number // 10) + 100 * np.sin(turn)).round(4).tolist()
        x[-1], y[-1] = x[0], y[0]
        rows += [
            f"0\nLINE\n8\nCUT\n10\n{x[i]}\n20\n{y[i]}\n11\n{x[i + 1]}\n21\n{y[i + 1]}\n"
            for i in range(1000)
        ]
    path.write_text("0\nSECTION\n2\nENTITIES\n" + "".join(rows) + "0\nENDSEC\n0\nEOF\n")


@pytest.mark.slow
def test_a_large_honest_drawing_is_judged_quickly(tmp_path):
    path = tmp_path / "large.dxf"
    many_lines(path, 60_000)
    began = time.process_time()
    report = judge_dxf(path)
    # 5 s, where ezdxf's reader that mends takes as long for the reading alone.
    assert time.process_time() - began < 10.0
    assert report.contour_count == 60_000
    assert [finding.severity for finding in report.findings] == ["warning"]


def test_more_than_can_be_read_in_time_and_memory_is_refused_at_once(tmp_path):
    path = tmp_path / "vast.dxf"
    path.write_text(
        "0\nSECTION\n2\nENTITIES\n" + "  0\nPOINT\n8\nCUT\n" * 60_001 + "0\nENDSEC\n0\nEOF\n"
    )
    began = time.process_time()
    with pytest.raises(InputError, match=r"vast\.dxf holds more than 60,000 lines"):
        judge_dxf(path)
    assert time.process_time() - began < 2.0
