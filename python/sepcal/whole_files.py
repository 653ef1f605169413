# SPDX-License-Identifier: BSD-3-Clause
"""Files that appear whole or not at all, several of them together."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping

from sepcal import _core
from sepcal.printing import in_line


def name_of(file: str | bytes | os.PathLike[str] | os.PathLike[bytes]) -> str:
    """A file's name as the engine takes it. Raises Error for one that is no UTF-8."""
    name = os.fsdecode(file)
    try:
        name.encode()
    except UnicodeEncodeError:
        raise _core.Error(f"{in_line(name)}: the file's name is no UTF-8; rename it") from None
    return name


def write_whole(texts: Mapping[str, str]) -> None:
    """Writes each file's text; raises Error, with nothing written or altered, where it can't."""
    drafts: dict[str, str] = {}
    writing = ""
    try:
        for writing, text in texts.items():
            if os.path.isdir(writing):
                raise _core.Error(f"{writing} is a folder; name a file in it")
            folder = os.path.dirname(os.path.abspath(writing))
            handle, drafts[writing] = tempfile.mkstemp(dir=folder, prefix=".sepcal-")
            with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as out:
                out.write(text)
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(drafts[writing], 0o666 & ~mask)
        for writing in texts:
            os.replace(drafts[writing], writing)
            del drafts[writing]
    except OSError as error:
        raise _core.Error(f"{writing} can't be written: {error.strerror}") from error
    finally:
        for draft in drafts.values():
            os.unlink(draft)


def refuse_outputs(outputs: tuple[str, ...], inputs: tuple[str, ...]) -> None:
    """Raises Error for an output whose folder isn't there, or that is an input."""
    for output in outputs:
        folder = os.path.dirname(output) or "."
        if not os.path.isdir(folder):
            raise _core.Error(f"{output}: folder '{folder}' isn't there; make it first")
        for read in inputs:
            if os.path.exists(output) and os.path.exists(read) and os.path.samefile(output, read):
                raise _core.Error(
                    f"{output}: it is an input, and writing there would lose it; name another file"
                )
