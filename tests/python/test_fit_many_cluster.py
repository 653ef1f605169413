# SPDX-License-Identifier: BSD-3-Clause
"""A fleet of 200 logs on a Dask cluster, with a worker killed on the way."""

import os
import signal

import pytest
from distributed import Client, LocalCluster

import sepcal
from cases import but_first_slow
from fleet_flights import PROBE, WIND, Interrupted, check_same, write_fleet


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    """200 logs of 120 rows, and their joint fit without a cluster."""
    files = write_fleet(tmp_path_factory.mktemp("fleet"), 200)
    return files, sepcal.fit_many(PROBE, files, own=WIND, threads=1)


@pytest.fixture(scope="module")
def client():
    """Two workers, each a process of one thread, that a nanny starts anew when they die."""
    with (
        LocalCluster(
            processes=True, n_workers=2, threads_per_worker=1, dashboard_address=":0"
        ) as cluster,
        Client(cluster) as made,
    ):
        yield made


def kill_a_worker(client):
    """SIGKILL."""
    os.kill(next(iter(client.cluster.workers.values())).pid, signal.SIGKILL)


def test_200_flights_on_a_cluster_are_those_here_to_the_last_bit(client, fleet):
    files, expected = fleet
    assert expected.status == "converged"
    assert len(expected.flights) == 200
    check_same(sepcal.fit_many(PROBE, files, own=WIND, executor=client.get_executor()), expected)


@pytest.mark.parametrize("task", but_first_slow([20, 150]))
def test_a_worker_may_be_killed_on_the_way(client, fleet, task):
    files, expected = fleet
    executor = Interrupted(client.get_executor(), task, lambda: kill_a_worker(client))
    check_same(sepcal.fit_many(PROBE, files, own=WIND, executor=executor), expected)
    assert executor.submitted > task


def test_arrays_in_memory_reach_the_worker_that_came_new(client, fleet):
    files, _ = fleet
    flights = {str(file): sepcal.read_csv(file) for file in files[:20]}
    expected = sepcal.fit_many(PROBE, flights, own=WIND)
    executor = Interrupted(client.get_executor(), 50, lambda: kill_a_worker(client))
    check_same(sepcal.fit_many(PROBE, flights, own=WIND, executor=executor), expected)


def test_no_vehicle_of_the_fleet_departs(fleet):
    _, expected = fleet
    assert expected.departed() == []
    below = [name for name, one in expected.flights.items() if one.departure.p < 0.05]
    assert len(below) <= 20  # 200 x 0.05 +- 3 sqrt(200 x 0.05 x 0.95)
