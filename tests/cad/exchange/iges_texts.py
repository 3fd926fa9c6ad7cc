"""IGES files made of records, as their specification (5.3) describes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Entity:
    """One entity; pointers among its parameters are written as ``{2}``, by place in the list."""

    kind: int
    parameters: str
    form: int = 0
    level: int = 0
    label: str = ""
    status: str = "00000000"


def line(length: float, y: float, **options: object) -> Entity:
    return Entity(110, f"0.,{y},0.,{length},{y},0.", **options)  # type: ignore[arg-type]


def name_property(name: str) -> Entity:
    return Entity(406, f"1,{len(name)}H{name}", form=15, status="00010000")


def level_name(level: int, name: str) -> Entity:
    return Entity(406, f"2,0,{len(name)}H{name}", form=3, level=level, status="00010000")


def _record(text: str, section: str, number: int) -> str:
    return f"{text:<72}{section}{number:7d}\n"


def iges_text(entities: Sequence[Entity], *, separator: str = ",", end: str = ";") -> str:
    header = f"1H{separator}{separator}1H{end}{separator}4Htest{separator}8Htest.igs{separator}"
    rest = "4Htest,4H0.1_,32,38,6,308,15,4Htest,1.,2,2HMM,1,0.01,13H251125.100000,1E-06,100.,"
    header += (
        (rest + "4Hnone,4Hnone,11,0,13H251125.100000;").replace(",", separator).replace(";", end)
    )
    globals_ = [header[i : i + 72] for i in range(0, len(header), 72)]
    numbers = [2 * i + 1 for i in range(len(entities))]
    directory, parameters = "", ""
    count = 0
    for entity, number in zip(entities, numbers, strict=True):
        text = f"{entity.kind},{entity.parameters.format(*numbers)};"
        text = text.replace(",", separator).replace(";", end)
        rows = [text[i : i + 64] for i in range(0, len(text), 64)]
        first = f"{entity.kind:8d}{count + 1:8d}{0:8d}{0:8d}{entity.level:8d}{0:8d}{0:8d}{0:8d}"
        second = f"{entity.kind:8d}{0:8d}{0:8d}{len(rows):8d}{entity.form:8d}{'':16}"
        directory += _record(first + entity.status, "D", number)
        directory += _record(f"{second}{entity.label:>8}{0:8d}", "D", number + 1)
        for row in rows:
            count += 1
            parameters += _record(f"{row:<64}{number:8d}", "P", count)
    start = _record("written by a test", "S", 1)
    head = "".join(_record(row, "G", i + 1) for i, row in enumerate(globals_))
    counts = f"S{1:7d}G{len(globals_):7d}D{2 * len(entities):7d}P{count:7d}"
    return start + head + directory + parameters + _record(counts, "T", 1)
