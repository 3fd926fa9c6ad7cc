"""Every numeric flag with every odd number: one sentence or a right result."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import pytest

from wrinkle_cad.cli.job_arguments import add_job_arguments, job_keywords
from wrinkle_cad.cli.main import main
from wrinkle_cad.errors import InputError
from wrinkle_cad.job.job import Job, make_job
from wrinkle_cad.options.option import Kind, OptionField, options_of
from wrinkle_cad.options.text import is_repeatable

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "shoe_examples" / "vamp_strip" / "vamp_strip.step"
ODD = ("0", "-1", "1e-300", "1e300", "nan", "inf", "", "abc", "1" + 400 * "0")
ALSO_NEEDED = {"waves": ("--height=1",), "height": ("--waves=2",)}


def numbers_of(kind: Kind) -> int:
    """How many numbers a value has; 0 where it has none."""
    if kind.part is not None:
        return numbers_of(kind.part) * (kind.count or 1)
    return int(kind.base in (float, int))


def numeric_options() -> list[OptionField]:
    fields = options_of(Job).values()
    return [field for field in fields if field.flag is not None and numbers_of(field.kind)]


def flag_with(field: OptionField, odd: str) -> str:
    """The flag, the odd number in place of all of its numbers."""
    return f"{field.flag}={','.join([odd] * numbers_of(field.kind))}"


def job_with(flags: list[str]) -> Job:
    parser = argparse.ArgumentParser()
    add_job_arguments(parser)
    return make_job(EXAMPLE, job_keywords(parser.parse_args(flags), {}))


def test_every_numeric_option_states_its_range() -> None:
    for field in numeric_options():
        assert -1e10 <= field.option.least <= field.option.most <= 1e10, field.name


def test_there_are_many_numeric_flags() -> None:
    assert len(numeric_options()) > 25


@pytest.mark.parametrize("odd", ODD, ids=lambda odd: odd[:6] or "nothing")
def test_an_odd_number_is_a_value_in_its_range_or_one_sentence(
    odd: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for field in numeric_options():
        try:
            job = job_with([flag_with(field, odd), *ALSO_NEEDED.get(field.name, ())])
        except InputError as error:
            said = [str(error)]
        except SystemExit:
            said = [line for line in capsys.readouterr().err.splitlines() if "error:" in line]
        else:
            # The number was taken, so it is finite and in the range that the option states.
            assert odd in ("0", "-1", "1e-300", ""), field.name
            for number in _numbers(getattr(job, field.name)):
                assert field.option.least <= number <= field.option.most, field.name
            continue
        assert len(said) == 1, (field.name, odd, said)
        assert len(said[0].splitlines()) == 1
        assert field.name in said[0] or str(field.flag) in said[0], (field.name, odd)
        assert "_value" not in said[0]
        assert len(said[0]) < 500


def _numbers(value: object) -> Iterator[float]:
    if isinstance(value, int | float):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _numbers(part)


@pytest.mark.parametrize("odd", ODD, ids=lambda odd: odd[:6] or "nothing")
@pytest.mark.parametrize("flag", ["--timeout", "--memory", "--workers"])
def test_an_odd_limit_is_one_sentence(
    flag: str, odd: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["batch", str(EXAMPLE), "-o", str(tmp_path), f"{flag}={odd}"]
    try:
        code = main(command)
    except SystemExit as error:
        code = int(str(error.code))
    assert code == 2, odd
    said = capsys.readouterr().err.splitlines()
    assert said
    assert flag in said[-1]
    assert len(said[-1]) < 300
    assert not list(tmp_path.iterdir())


def commands_with(flag: str) -> list[str]:
    """The commands that have a flag."""
    parser = command_line()
    (commands,) = (each for each in parser._actions if isinstance(each, argparse._SubParsersAction))
    return [name for name, own in commands.choices.items() if flag in own._option_string_actions]


def command_line() -> argparse.ArgumentParser:
    """The parser of the whole command line, as `main` makes it."""
    made: list[argparse.ArgumentParser] = []
    real = argparse.ArgumentParser.parse_args

    def kept(parser: argparse.ArgumentParser, *_: object) -> argparse.Namespace:
        made.append(parser)
        raise KeyboardInterrupt

    argparse.ArgumentParser.parse_args = kept  # type: ignore[method-assign, assignment]
    try:
        with pytest.raises(KeyboardInterrupt):
            main([])
    finally:
        argparse.ArgumentParser.parse_args = real  # type: ignore[method-assign]
    return made[0]


def test_every_number_of_every_command_is_in_one_of_these_tables() -> None:
    parser = command_line()
    (commands,) = (each for each in parser._actions if isinstance(each, argparse._SubParsersAction))
    known = {str(field.flag) for field in numeric_options()} | {"--timeout", "--memory"}
    for name, own in commands.choices.items():
        for action in own._actions:
            is_number = getattr(action.type, "__name__", "") in ("_number", "_whole_number")
            is_number |= action.type in (int, float)
            flags = set(action.option_strings)
            assert not is_number or flags & (known | {"--workers"}), (name, flags)


@pytest.mark.parametrize("flag", ["--timeout", "--memory"])
@pytest.mark.parametrize("command", ["run", "inspect", "check", "compare"])
def test_an_odd_limit_of_one_file_is_one_sentence(
    command: str, flag: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert {"run", "inspect", "check", "compare", "batch"} == set(commands_with(flag))
    for odd in ODD:
        out = ["-o", str(tmp_path)] if command in ("run", "compare") else []
        try:
            code = main([command, str(EXAMPLE), *out, f"{flag}={odd}"])
        except SystemExit as error:
            code = int(str(error.code))
        said = capsys.readouterr().err.splitlines()
        assert code in (1, 2), odd
        assert flag in said[-1], said
        assert len(said[-1]) < 300
        assert "defect" not in said[-1]
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("odd", ODD, ids=lambda odd: odd[:6] or "nothing")
@pytest.mark.parametrize("field", numeric_options(), ids=lambda field: field.name)
def test_a_run_with_an_odd_number_ends_in_time(
    field: OptionField, odd: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    name = "one_wrinkle" if field.name in ("waves", "height", "margin", "fade") else "vamp_strip"
    source = ROOT / "shoe_examples" / name / f"{name}.step"
    flags = [flag_with(field, odd), *ALSO_NEEDED.get(field.name, ())]
    command = ["run", str(source), "-o", str(tmp_path), "--timeout", "25", "--quiet", *flags]
    try:
        code = main(command)
    except SystemExit as error:
        code = int(str(error.code))
    said = capfd.readouterr().err
    assert "defect" not in said
    assert "internal" not in said
    assert "The time was up" not in said
    assert (code == 0) == ((tmp_path / f"{name}.dxf").exists())
    assert is_repeatable(field) or code in (0, 1, 2)
