"""Reading a page as a program: its elements with their attributes and texts."""

from __future__ import annotations

from dataclasses import dataclass, field
from html.parser import HTMLParser


@dataclass
class Part:
    tag: str
    attributes: dict[str, str | None]
    text: str = ""
    parents: list[str] = field(default_factory=list)


class PageReader(HTMLParser):
    """Every element of a page in its order; the text is that directly inside it."""

    def __init__(self, html: str) -> None:
        super().__init__(convert_charrefs=True)
        self.parts: list[Part] = []
        self._open: list[Part] = []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        part = Part(tag, dict(attrs), parents=[each.tag for each in self._open])
        self.parts.append(part)
        if tag not in ("meta", "link", "input", "img", "br"):
            self._open.append(part)

    def handle_endtag(self, tag: str) -> None:
        while self._open and self._open.pop().tag != tag:
            pass

    def handle_data(self, data: str) -> None:
        if self._open:
            self._open[-1].text += data

    def all(self, tag: str) -> list[Part]:
        return [part for part in self.parts if part.tag == tag]

    def by_id(self, name: str) -> Part:
        (part,) = (part for part in self.parts if part.attributes.get("id") == name)
        return part
