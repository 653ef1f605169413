# SPDX-License-Identifier: BSD-3-Clause
"""A fleet on an S3 server on this machine that refuses one read in ten."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import sepcal

s3fs = pytest.importorskip("s3fs", reason="logs on S3: pip install s3fs")
moto_server = pytest.importorskip("moto.server", reason="an S3 server: pip install moto[server]")

NAMES = "{vehicle}_{date}.csv"


@pytest.fixture
def bucket(tmp_path, monkeypatch) -> Iterator[tuple[str, str]]:
    """The logs' folder, and the same logs on the server."""
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "key")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "secret")
    server = moto_server.ThreadedMotoServer(port=0)
    server.start()
    host, port = server.get_host_and_port()
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{host}:{port}")
    sepcal.datasets.write_fleet(tmp_path, vehicles=4, flights=4)
    system = s3fs.S3FileSystem(skip_instance_cache=True)
    system.mkdir("fleet")
    system.put([str(file) for file in sorted(tmp_path.iterdir())], "fleet/")
    try:
        yield str(tmp_path), "s3://fleet/*.csv"
    finally:
        server.stop()


def test_the_same_bits_from_a_server_that_fails(bucket, monkeypatch) -> None:
    folder, url = bucket
    here = sepcal.Fleet(folder, sepcal.PitotStatic(), names=NAMES)
    assert len(here.flights) == 16
    whole = s3fs.S3FileSystem.get_file
    reads = iter(range(10**9))

    def get_file(self, *arguments, **named):
        if next(reads) % 10 == 3:
            raise ConnectionResetError("connection reset by peer")
        return whole(self, *arguments, **named)

    monkeypatch.setattr(s3fs.S3FileSystem, "get_file", get_file)
    there = sepcal.Fleet(url, sepcal.PitotStatic(), names=NAMES)
    assert {name: fit.values.tolist() for name, fit in there.vehicles.items()} == {
        name: fit.values.tolist() for name, fit in here.vehicles.items()
    }
    assert there.left_out == {}
    assert next(reads) > 33  # more reads than two visits of sixteen logs
