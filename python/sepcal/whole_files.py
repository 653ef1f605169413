# SPDX-License-Identifier: BSD-3-Clause
"""Files that appear whole or not at all, several of them together."""

from __future__ import annotations

import os
import uuid
import zipfile
from collections.abc import Mapping
from contextlib import suppress
from typing import IO, BinaryIO, TextIO

from sepcal import _core
from sepcal.arguments import Misuse, shown
from sepcal.printing import in_line


def name_of(file: str | bytes | os.PathLike[str] | os.PathLike[bytes]) -> str:
    """A file's name as the engine takes it. Raises Error for no UTF-8, or a NUL."""
    if not isinstance(file, str | bytes | os.PathLike):
        raise Misuse(f"{shown(file)} is no file; give its name, a text or a path")
    name = os.fsdecode(file)
    if "\0" in name:
        raise _core.Error(f"{in_line(name)}: a file's name can't hold a NUL")
    try:
        name.encode()
    except UnicodeEncodeError:
        raise _core.Error(f"{in_line(name)}: the file's name is no UTF-8; rename it") from None
    return name


def open_scratch_text(file: str) -> TextIO:
    """A file in a temporary folder of our own, to be written as text."""
    return open(file, "w", encoding="utf-8", newline="")


def open_scratch(file: str) -> BinaryIO:
    """The same, to be written as bytes."""
    return open(file, "wb")


def open_scratch_part(archive: zipfile.ZipFile, name: str) -> IO[bytes]:
    """A part of an archive in such a folder, to be written."""
    return archive.open(name, "w", force_zip64=True)


def write_whole(texts: Mapping[str, str]) -> None:
    """Writes each file's text; raises Error, with nothing written or altered, where it can't."""
    _core.write_whole(dict(texts))


def write_bytes(path: str, content: bytes) -> None:
    """Writes a file that appears whole or not at all. Raises Error where it can't."""
    scratch = f"{path}.{uuid.uuid4().hex}"
    try:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        try:
            with open(scratch, "xb") as file:
                file.write(content)
            os.replace(scratch, path)
        except BaseException:
            with suppress(OSError):
                os.unlink(scratch)
            raise
    except OSError as error:
        raise _core.Error(f"{in_line(path)}: {error.strerror}") from None


def refuse_outputs(outputs: tuple[str, ...], inputs: tuple[str, ...]) -> None:
    """Raises Error for an output that is an input or can't be written."""
    for output in map(name_of, outputs):
        for read in map(name_of, inputs):
            _core.check_not_input(output, read)
        _core.check_output(output)
