# SPDX-License-Identifier: BSD-3-Clause
"""What was done of a fleet, kept in a folder, so that a run that ended early is taken up again.

An answer stands under the SHA-256 of its question and of its log's bytes. A log whose size and time
have not changed is not read again to know its bytes. Answers are arrays and JSON: reading one runs
nothing.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.fleet.logs import filesystem_of, is_url
from sepcal.fleet.visiting import Question, Visit
from sepcal.whole_files import write_bytes

Fields = Mapping[str, Any]


def factor_of(fields: Fields) -> _core.FlightFactor:
    """The factor that these are the fields of."""
    factor: _core.FlightFactor = _core.FlightFactor.__new__(_core.FlightFactor)
    state = tuple(fields[name] for name in _core.FlightFactor._fields)
    factor.__setstate__(state)
    return factor


def fingerprint_of(file: str) -> str:
    """What changes with a file, without reading it; empty where that is not known."""
    try:
        if not is_url(file):
            known = os.stat(file)
            return f"{known.st_size}-{known.st_mtime_ns}"
        system, path = filesystem_of(file)
        return str(system.ukey(path))
    except (OSError, NotImplementedError):
        return ""


def digest_of(question: Question) -> str:
    """SHA-256 of all that an answer depends on but the log's bytes."""
    asked = [
        question.base.to_json(),
        list(question.own),
        None if question.candidates is None else list(question.candidates),
        dict(question.at),
        dict(question.centres),
        question.calibration,
    ]
    return hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()


class Store:
    """The answers in a folder, which is made where it is not there yet."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = os.fspath(folder)
        self._index_path = os.path.join(self.folder, "read.json")
        self._index: dict[str, list[str]] = {}  # file: fingerprint, SHA-256
        if os.path.exists(self._index_path):
            with open(self._index_path, encoding="utf-8") as file:
                try:
                    self._index = dict(json.load(file))
                except ValueError:
                    self._index = {}  # each log is read again

    def _path(self, question: Question, sha256: str) -> str:
        key = hashlib.sha256((digest_of(question) + sha256).encode()).hexdigest()
        return os.path.join(self.folder, "answers", key[:2], key + ".npz")

    def find(self, question: Question) -> Visit | None:
        """What was answered, if the log is as it was."""
        fingerprint, sha256 = self._index.get(question.file, ["", ""])
        if not fingerprint or fingerprint_of(question.file) != fingerprint:
            return None
        path = self._path(question, sha256)
        try:
            with np.load(path, allow_pickle=False) as arrays:
                told = json.loads(bytes(arrays["told"]).decode())
                fields = told.pop("factor")
                fields["values"] = arrays["values"]
                fields["whitened"] = arrays["whitened"]
                fields["columns"] = [tuple(column) for column in fields["columns"]]
                side = fields["values"].size + len(fields["columns"]) + 1
                triangle = np.zeros((side, side))
                triangle[np.triu_indices(side)] = arrays["triangle"]
                fields["triangle"] = triangle
        except (OSError, ValueError, KeyError, zipfile.BadZipFile):
            return None  # it is asked again
        return Visit(question.name, sha256, factor=factor_of(fields), **told)

    def keep(self, question: Question, visit: Visit) -> None:
        """Keeps an answer that is no error."""
        factor = visit.factor
        if factor is None:
            return
        fields = dict(factor._asdict())
        values = np.asarray(fields.pop("values"))
        triangle = np.asarray(fields.pop("triangle"))
        whitened = np.asarray(fields.pop("whitened"))
        fields["inflation"] = np.asarray(fields["inflation"]).tolist()
        told = {
            "calibration": visit.calibration,
            "rows": visit.rows,
            "seconds": visit.seconds,
            "bytes_read": visit.bytes_read,
            "means": dict(visit.means),
            "factor": fields,
        }
        content = io.BytesIO()
        np.savez(
            content,
            told=np.frombuffer(json.dumps(told).encode(), dtype=np.uint8),
            values=values,
            whitened=whitened,
            triangle=triangle[np.triu_indices(len(triangle))],
        )
        write_bytes(self._path(question, visit.sha256), content.getvalue())
        self._index[question.file] = [fingerprint_of(question.file), visit.sha256]

    def save_index(self) -> None:
        """Keeps what is known of the logs' bytes."""
        write_bytes(self._index_path, json.dumps(self._index, indent=1).encode())
