# SPDX-License-Identifier: BSD-3-Clause
"""What is said of the fuzzers is what there is; mutator and judges of text do their part."""

from __future__ import annotations

import random
import re
import subprocess
import sys
from pathlib import Path

import pytest

from hostile import PIECES, find_unprintable

ROOT = Path(__file__).resolve().parents[2]
FUZZ = ROOT / "tests" / "fuzz"
WORDS = {"nine": 9, "ten": 10, "eleven": 11, "twelve": 12, "thirteen": 13}

sys.path.insert(0, str(FUZZ))

import mutation  # noqa: E402


def fuzzers(pattern: str) -> list[str]:
    return sorted(file.stem.removeprefix("fuzz_") for file in FUZZ.glob(pattern))


def test_the_documents_count_them() -> None:
    page = (ROOT / "docs" / "testing.md").read_text()
    counted = re.search(r"\[(\w+) fuzzers\]", page)
    assert counted
    assert WORDS[counted[1]] == len(fuzzers("fuzz_*.*"))
    rows = re.findall(r"^\| (\w+) \|", page[page.index("| fuzzer |") :], re.MULTILINE)
    assert sorted(rows[1:]) == fuzzers("fuzz_*.*")
    assert rows[1:7] == [name for name in rows[1:] if name in fuzzers("fuzz_*.cpp")]


def test_all_of_them_run() -> None:
    script = (ROOT / "scripts" / "fuzz").read_text()
    in_python = re.search(r"^for target in (.*); do start python", script, re.MULTILINE)
    assert in_python
    assert sorted(in_python[1].split()) == fuzzers("fuzz_*.py")
    assert sorted(re.findall(r"^start cpp (\w+)", script, re.MULTILINE)) == fuzzers("fuzz_*.cpp")
    built = re.search(r"^build \$folder (.*)$", script, re.MULTILINE)
    assert built
    assert sorted(name.removeprefix("fuzz_") for name in built[1].split()) == fuzzers("fuzz_*.cpp")


def for_seconds(seconds: int, folder: Path) -> tuple[str | Path, ...]:
    return str(seconds), folder / "kept", folder / "findings"


def run_fuzzer(folder: Path, body: str, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """A fuzzer of a target of these lines; it stops at a finding, long before its 30 s."""
    script = folder / "fuzz_planted.py"
    script.write_text(f"import sys\nsys.path.insert(0, {str(FUZZ)!r})\nimport mutation\n{body}\n")
    command = [sys.executable, script, *(arguments or for_seconds(30, folder))]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)


@pytest.mark.parametrize(("fault", "said"), [
    ("assert b'*/' not in data", "AssertionError"),
    ("b'\\x1b' in data and sys.exit(0)", "SystemExit"),
    ("mutation.check_printed(data.decode('utf-8', 'replace'))", "AssertionError"),
    ("b'<' not in data or bytearray(3 * 2**30)", "MemoryError"),
])  # fmt: skip
def test_a_planted_fault_is_found(tmp_path: Path, fault: str, said: str) -> None:
    body = f"def target(data):\n    {fault}\nmutation.main(target, [b'plain'])"
    done = run_fuzzer(tmp_path, body)
    assert done.returncode == 1, done
    assert said in done.stderr
    (finding,) = (tmp_path / "findings").iterdir()
    again = run_fuzzer(tmp_path, body, str(finding))
    assert again.returncode == (0 if said == "SystemExit" else 1)


def test_a_hang_is_found(tmp_path: Path) -> None:
    body = "mutation.LONGEST = 0.5\ndef target(data):\n    while True: pass\n"
    done = run_fuzzer(tmp_path, body + "mutation.main(target, [b'plain'])")
    assert done.returncode == 1
    assert "TooSlow" in done.stderr


def test_what_finds_nothing_says_how_much_it_tried(tmp_path: Path) -> None:
    body = "mutation.main(lambda data: len(data) % 7, [b'plain'])"
    done = run_fuzzer(tmp_path, body, *for_seconds(1, tmp_path))
    assert done.returncode == 0, done.stderr
    tried = re.search(r"^stat::number_of_executed_units: (\d+)$", done.stdout, re.MULTILINE)
    assert tried
    assert int(tried[1]) > 20
    assert len([*(tmp_path / "kept").iterdir()]) == 6  # an input of each new kind but the seed's
    assert [*(tmp_path / "findings").iterdir()] == []


def test_mutations_are_many_and_the_same_by_their_seed() -> None:
    def mutations(seed: int) -> list[bytes]:
        draw = random.Random(seed)
        return [mutation.mutate(b"plain text", [b"another"], draw) for _ in range(300)]

    assert mutations(1) == mutations(1)
    assert len(set(mutations(1))) > 200
    assert mutation.mutate(b"", [b""], random.Random(1)) is not None


def test_words_come_back() -> None:
    words = ["a", "ü\n", "", "\udcff"]
    assert mutation.words_of(mutation.input_of(words[:3]), 4) == ["a", "ü\n", "", ""]
    stray = mutation.input_of([*words, "x" * ((1 - len(mutation.input_of([*words, ""]))) % 8)])
    assert mutation.words_of(stray, 4) == words


def test_what_may_not_be_printed() -> None:
    """Unicode's Cc, Zl, Zp and Bidi_Control; letters of all kinds may."""
    assert find_unprintable("aü名\U0001f680e\u0301\n \u200b") == []
    steering = "\0\t\r\x1b\x7f\x85\x9b\u061c\u200e\u2028\u202e\u2066\u2069\ud800"
    assert all(find_unprintable(character) for character in steering)
    assert len(PIECES) > 80
