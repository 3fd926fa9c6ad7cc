"""What a batch is going to do with each file."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from wrinkle_cad.batch.folder import plan as planning
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.plan import PlannedJob, plan_batch
from wrinkle_cad.errors import JobError


def plan(
    folder: Path, mask: str | None = None, keywords: dict[str, object] | None = None
) -> dict[str, PlannedJob]:
    found = find_sources([str(folder / "in")], folder / "out")
    planned = plan_batch(found.files, folder / "out", keywords=keywords, mask=mask)
    return {entry.source.label: entry for entry in planned}


def put(folder: Path, **contents: str) -> None:
    for name, content in contents.items():
        path = folder / "in" / name.replace("__", "/").replace("_toml", ".toml")
        path = path if path.suffix == ".toml" else path.with_name(path.name + ".step")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)


def test_output_folders_mirror_input_folders(tmp_path: Path) -> None:
    put(tmp_path, a="", x__y__b="")
    planned = plan(tmp_path)
    assert planned["a.step"].job.output_dir == tmp_path / "out"
    assert planned["x/y/b.step"].job.output_dir == tmp_path / "out/x/y"
    assert planned["x/y/b.step"].key == "x/y/b"


def test_settings_come_from_flags_then_the_file_then_its_folder(tmp_path: Path) -> None:
    put(tmp_path, a="", b="", job_toml='tolerance = 0.2\nsearch = "local"\nmax_chord = 9.0')
    (tmp_path / "in/a.job.toml").write_text("tolerance = 0.3")
    planned = plan(tmp_path, keywords={"max_chord": 5.0, "planarity": None})
    a, b = planned["a.step"].job, planned["b.step"].job
    assert (a.tolerance, a.search, a.max_chord) == (0.3, "local", 5.0)
    assert (b.tolerance, b.search, b.max_chord) == (0.2, "local", 5.0)


def test_common_settings_hold_where_a_file_has_none_of_its_own(tmp_path: Path) -> None:
    put(tmp_path, a="", x__b="", x__job_toml="tolerance = 0.2")
    found = find_sources([str(tmp_path / "in")], tmp_path / "out")
    common = {"tolerance": 0.4, "max_chord": 3.0, "output_dir": Path("/etc")}
    a, b = (entry.job for entry in plan_batch(found.files, tmp_path / "out", common=common))
    assert (a.tolerance, a.max_chord) == (0.4, 3.0)
    assert (b.tolerance, b.max_chord) == (0.2, 3.0)
    assert a.output_dir == tmp_path / "out"


def test_settings_that_name_an_input_hold_for_that_file_only(tmp_path: Path) -> None:
    put(tmp_path, a="", b="", job_toml='input = "a.step"\ntolerance = 0.2')
    planned = plan(tmp_path)
    assert planned["a.step"].job.tolerance == 0.2
    assert planned["b.step"].job.tolerance == 0.05


def test_a_file_cannot_choose_its_output_folder(tmp_path: Path) -> None:
    put(tmp_path, a="", job_toml='output_dir = "/etc"')
    assert plan(tmp_path)["a.step"].job.output_dir == tmp_path / "out"


def test_a_file_can_choose_its_name_but_a_mask_goes_before(tmp_path: Path) -> None:
    put(tmp_path, a="")
    (tmp_path / "in/a.job.toml").write_text('name = "../vamp"')
    assert plan(tmp_path)["a.step"].job.name == "_._vamp"
    assert plan(tmp_path, mask="{stem}-{number}")["a.step"].job.name == "a-0001"


def test_broken_settings_cost_the_files_they_are_for(tmp_path: Path) -> None:
    put(tmp_path, a="", x__b="", x__job_toml="tolerance = -1")
    planned = plan(tmp_path)
    assert planned["a.step"].refusal == ""
    assert "tolerance" in planned["x/b.step"].refusal


@pytest.mark.parametrize(
    "line",
    [
        "criteria = 5",
        "criteria = [1]",
        'criteria = "invalid"',
        'source_date_epoch = "now"',
        "p = 1",
        'rulings = "yes"',
        "tolerance = true",
        "tolerance = {a = 1}",
        "search = 1979-05-27",
        'novelty = "x"',
        "tolerance =",
    ],
)
def test_settings_of_the_wrong_type_cost_the_files_they_are_for(tmp_path: Path, line: str) -> None:
    put(tmp_path, a="", x__b="", x__job_toml=line)
    planned = plan(tmp_path)
    assert planned["a.step"].refusal == ""
    assert planned["x/b.step"].refusal


def test_of_two_files_with_the_same_outputs_the_second_is_refused(tmp_path: Path) -> None:
    put(tmp_path, a="", A="")
    (tmp_path / "in/a.stp").write_text("")
    refusals = {label: entry.refusal for label, entry in plan(tmp_path).items()}
    assert sum(not refusal for refusal in refusals.values()) == 1
    assert all("A.step" in refusal for refusal in refusals.values() if refusal)
    apart = plan(tmp_path, mask="{stem}-{suffix}-{number}")
    assert not any(entry.refusal for entry in apart.values())


def test_a_broken_mask_stops_the_plan(tmp_path: Path) -> None:
    put(tmp_path, a="")
    with pytest.raises(JobError, match="has no field"):
        plan(tmp_path, mask="{nonsense}")


def test_a_link_that_leads_out_of_the_output_folder_is_refused(tmp_path: Path) -> None:
    put(tmp_path, x__a="")
    (tmp_path / "out").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "out/x").symlink_to(tmp_path / "elsewhere", target_is_directory=True)
    assert "leads out" in plan(tmp_path)["x/a.step"].refusal


def test_settings_on_a_share_that_does_not_answer_cost_the_file_they_are_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answered, real = threading.Event(), os.path.lexists

    def stalled(path: Path) -> bool:
        if "away" in Path(path).parts:
            answered.wait(30.0)
        return real(path)

    monkeypatch.setattr(os.path, "lexists", stalled)
    monkeypatch.setattr(planning, "STALL_S", 0.2)
    for name in ("here", "away"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "a.step").write_text("1")
    found = find_sources([str(tmp_path / "here"), str(tmp_path / "away")], tmp_path / "out")
    refusals = {
        entry.source.folder.name: entry.refusal
        for entry in plan_batch(found.files, tmp_path / "out")
    }
    answered.set()
    assert refusals["here"] == ""
    assert "nothing for 0.2 s" in refusals["away"]


def test_a_mark_of_the_encoding_before_settings_is_no_part_of_them(tmp_path: Path) -> None:
    (tmp_path / "a.step").write_text("1")
    (tmp_path / "a.job.toml").write_bytes(b"\xef\xbb\xbftolerance = 0.25")
    (entry,) = plan_batch(find_sources([str(tmp_path)], tmp_path / "out").files, tmp_path / "out")
    assert entry.job.tolerance == 0.25


@pytest.mark.parametrize("line", ["name = 5", 'name = ["a"]', "input = 5", 'input = ["a"]'])
def test_a_name_or_an_input_that_is_no_text_is_one_sentence(tmp_path: Path, line: str) -> None:
    (tmp_path / "a.step").write_text("1")
    (tmp_path / "a.job.toml").write_text(line)
    (entry,) = plan_batch(find_sources([str(tmp_path)], tmp_path / "out").files, tmp_path / "out")
    assert entry.refusal.startswith(f"{line.split()[0]} cannot be ")


def test_a_name_that_settings_choose_yields_to_the_file_that_is_called_so(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.step").write_text("1")
    (tmp_path / "a.job.toml").write_text('name = "b"')
    first, second = plan_batch(
        find_sources([str(tmp_path)], tmp_path / "out").files, tmp_path / "out"
    )
    assert "b.step would be called b too" in first.refusal
    assert (second.key, second.refusal) == ("b", "")
