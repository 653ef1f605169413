# SPDX-License-Identifier: BSD-3-Clause
"""Memory, threads and files that are refused: some calls of those that scripts/failures tries."""

from pathlib import Path

import pytest

import failing_calls
from failing_calls import APP, LIBRARY, Verb

pytestmark = pytest.mark.skipif(not LIBRARY.exists(), reason=f"{LIBRARY} is not built")

VERBS = ("fit", "apply", "export")


@pytest.fixture(scope="module")
def verbs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Verb]:
    """What is run, by name."""
    return {verb.name: verb for verb in failing_calls.prepare(tmp_path_factory.mktemp("failing"))}


def assert_kept(verb: Verb, failing: list[str], *, unreached: int = 0) -> failing_calls.Tally:
    """Each run succeeds or ends in one line, with the old output or the whole new one."""
    counted = failing_calls.tally(verb, failing, jobs=2)
    assert counted.faults == []
    assert counted.unreached <= unreached
    return counted


@pytest.mark.parametrize("name", VERBS)
def test_memory_refused_once(name: str, verbs: dict[str, Verb]) -> None:
    counted = assert_kept(verbs[name], [f"allocation:{n}" for n in range(1, 1000, 37)])
    assert counted.refused > 0


@pytest.mark.parametrize("name", VERBS)
def test_memory_refused_from_a_call_on(name: str, verbs: dict[str, Verb]) -> None:
    counted = assert_kept(verbs[name], [f"allocations:{n}" for n in range(1, 1000, 71)])
    assert counted.succeeded == 0


@pytest.mark.parametrize("name", VERBS)
def test_memory_refused_to_a_call_stack(name: str, verbs: dict[str, Verb]) -> None:
    stacks = failing_calls.list_stacks(verbs[name])
    assert len(stacks) > 1000
    assert_kept(
        verbs[name], [f"stack:{stack}" for stack in stacks[:: len(stacks) // 25]], unreached=2
    )


@pytest.mark.parametrize("first", [1, 2])
def test_threads_that_do_not_start(first: int, verbs: dict[str, Verb], tmp_path: Path) -> None:
    """Those that run do all the work, with the same result."""
    verb = verbs["fit"]
    many = Verb(
        verb.name, (*verb.command, "--threads", "4"), verb.output, verb.folder, verb.text, verb.said
    )
    ending = failing_calls.run_failing(many, f"thread:{first}")
    assert ending.reached
    assert (ending.code, ending.err) == (0, "")


@pytest.mark.parametrize("name", VERBS)
def test_files_refused(name: str, verbs: dict[str, Verb]) -> None:
    """Every call that opens, writes, names or closes a file, one a run."""
    counted = assert_kept(verbs[name], [f"file:{n}" for n in range(1, 13)], unreached=6)
    assert counted.refused >= 5


def test_a_fault_is_seen(verbs: dict[str, Verb]) -> None:
    """What judges a run, on runs that never were."""
    verb = verbs["apply"]
    old, new = failing_calls.OLD_OUTPUT.encode(), verb.text
    line = f"{APP}: memory ran out\n"

    def judge(code: int, err: str, output: bytes, **more: bytes) -> str:
        return failing_calls.find_fault(
            verb, code, verb.said, err, {**verb.inputs, verb.output: output, **more}
        )

    assert judge(0, "", new) == ""
    assert judge(2, line, old) == ""
    assert judge(2, line, new) == ""
    assert judge(0, "", old) == "success without the output"
    assert judge(2, line, new[:-1]) == "the output is neither the old nor the new one"
    assert judge(2, line + line, old) == "not one line on standard error"
    assert judge(2, "", old) == "not one line on standard error"
    assert judge(-11, line, old) == "crash: signal 11"
    assert judge(1, line, old) == "exit code 1"
    assert "left in the folder" in judge(2, line, old, part=b"")


def test_a_library_is_told_from_the_app() -> None:
    """By the innermost frame of a crash that is not the C library's."""

    def crash(*frames: str) -> failing_calls.Ending:
        log = (
            "failed\n  libfailing_calls.so malloc+0x9\ncrashed: signal 11\n  libc.so.6 abort+0xd3\n"
        )
        log += "".join(f"  {frame}\n" for frame in frames)
        return failing_calls.Ending("allocation:1", -11, "", True, "crash: signal 11", log)

    own, main = f"{APP} _ZN6sepcal8read_csvEv+0x9", f"{APP} main+0x4"
    eigen = f"{APP} _ZN5Eigen6ResizeEv+0x4"
    vector = f"{APP} _ZNSt6vectorIdSaIdEED2Ev+0x4"
    assert crash("libgomp.so.1 ?+0x31", main).in_library
    assert crash(eigen, own, main).in_library
    assert not crash(own, eigen, main).in_library
    assert not crash(vector, own, main).in_library
    assert not crash("libceres.so.3 ?+0x1", own, main).in_library
