# SPDX-License-Identifier: BSD-3-Clause
"""Reports of a flight and a calibration whose names, labels, messages and files are hostile.

Beside the report of plain names no element, no attribute and no script is more, and what stands in
the page's data is JSON.
"""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Hashable
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
from mutation import check_message, check_printed, input_of, main, words_of

import sepcal
import sepcal.reporting
from hostile import hostile_words

COUNT = 9
ROWS = 200
FIELD = (19.7, -1.4, 49.4)


class Elements(HTMLParser):
    """Elements with their attributes' names, what scripts say, and where links lead."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: set[tuple[str, tuple[str, ...]]] = set()
        self.scripts: list[str] = []
        self.links: set[str] = set()
        self._inside = ""
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keeps them."""
        self._inside = tag
        self.found.add((tag, tuple(name for name, _ in attrs)))
        assert not any(name.startswith("on") for name, _ in attrs), attrs
        self.links |= {str(value) for name, value in attrs if name in ("href", "src", "action")}
        if tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        """Is out of it."""
        self._inside = ""

    def handle_data(self, data: str) -> None:
        """Of scripts."""
        if self._inside == "script":
            self.scripts[-1] += data

    def handle_comment(self, data: str) -> None:
        """There is none."""
        raise AssertionError(f"a comment: {data}")


@functools.cache
def flown() -> sepcal.SimulatedFlight:
    return sepcal.simulate(sepcal.Magnetometer(), rows=ROWS, seed=3)


@functools.cache
def fitted() -> dict[str, object]:
    """A calibration as JSON."""
    base = sepcal.fit(sepcal.Magnetometer(field=FIELD), flown())
    base.save("base.json")
    read: dict[str, object] = json.loads(Path("base.json").read_text())
    return read


def tags_in(pool: str) -> set[str]:
    """What Plotly would take for elements, of all texts in the page's data."""
    texts = json.dumps(json.loads(pool)["figures"], ensure_ascii=False)
    check_printed(texts)
    return set(re.findall(r"</?[A-Za-z][^>]*>", texts))


@functools.cache
def diagnosed() -> sepcal.Diagnosis:
    """Of the plain flight: most of a report's time is its own diagnosis."""
    return sepcal.fit(sepcal.Magnetometer(field=FIELD), flown()).diagnose()


def write_report(words: list[str], diagnosis: sepcal.Diagnosis | None = None) -> str:
    """Raises sepcal.Error for names that are refused. Without a diagnosis the report makes one."""
    first, second, leg, other, name, message, file, sha256, effect = words
    noise = np.random.default_rng(2)
    columns = {header: flown()[header] for header in flown()}
    columns |= {header: np.cumsum(noise.normal(size=ROWS)) for header in (first, second)}
    maneuvers = [leg if row < ROWS // 2 else other for row in range(ROWS)]
    flight = sepcal.Flight(columns, maneuver=maneuvers, name=name)
    told = json.loads(json.dumps(fitted()))
    told["message"], told["inputs"]["file"], told["inputs"]["sha256"] = message, file, sha256
    told["status"] = "not_identifiable"
    told["history"] = [{**step, "effect": effect} for step in (told["history"] or [])]
    Path("spoilt.json").write_text(json.dumps(told))
    chain = [sepcal.load("spoilt.json")]
    sepcal.report(chain, "report.html", flight, diagnosis=diagnosis, files=[file or "base.json"])
    return Path("report.html").read_text(encoding="utf-8")


@functools.cache
def plain() -> Elements:
    sepcal.reporting.read_plotly = lambda: ""  # nobody draws here
    return Elements(write_report(["c1", "c2", "leg", "other", "flight", "m; n", "f.csv", "", ""]))


def target(data: bytes) -> Hashable:
    """Of the report's answer."""
    expected = plain()
    words = words_of(data, COUNT)
    if len(data) % 8 > 0:  # else every report would be refused
        words[7] = ""
    try:
        page = write_report(words, diagnosed() if len(data) % 4 else None)
    except sepcal.Error as error:
        return check_message(str(error))
    shown = Elements(page)
    assert shown.found <= expected.found, shown.found - expected.found
    assert shown.links <= expected.links, shown.links - expected.links
    assert len(shown.scripts) == len(expected.scripts)
    assert (shown.scripts[0], shown.scripts[2]) == (expected.scripts[0], expected.scripts[2])
    assert tags_in(shown.scripts[1]) <= tags_in(expected.scripts[1])
    check_printed(page)
    return tuple(bool(word.isprintable()) for word in words)


SEEDS = [
    input_of(["c1", "c2", "leg", "other", "flight", "one; two", "f.csv", "0" * 64, "bias[c1]"]),
    *(input_of(hostile_words(60 + COUNT, seed)[-COUNT:]) for seed in range(10)),
]

if __name__ == "__main__":
    main(target, SEEDS)
