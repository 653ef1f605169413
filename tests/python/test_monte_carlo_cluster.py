# SPDX-License-Identifier: BSD-3-Clause
"""monte_carlo() on a Dask cluster: as many workers as you like, and some of them die."""

import os
import signal
import threading
from itertools import islice

import dask
import pytest
from distributed import Client, KilledWorker, LocalCluster

import sepcal
from sepcal.executors import gather, stream
from trial_functions import (
    TRUTH,
    SlowTrial,
    die_on_third,
    fit_scalar,
    give_what_stays,
    square,
    wait_and_square,
)


def start(workers):
    """Workers that are processes of one thread; a nanny starts them anew when they die."""
    return LocalCluster(
        processes=True, n_workers=workers, threads_per_worker=1, dashboard_address=":0"
    )


@pytest.fixture(scope="module")
def cluster():
    # The cluster waits for a nanny that takes its time; it would else do without the worker.
    patience = {"distributed.deploy.lost-worker-timeout": "10 minutes"}
    with dask.config.set(patience), start(2) as made:
        yield made


@pytest.fixture
def client(cluster):
    with Client(cluster) as made:
        made.wait_for_workers(2)
        yield made


@pytest.fixture
def impatient(cluster, client):
    """The client of a scheduler that calls a task off when its worker dies: KilledWorker."""
    patience = cluster.scheduler.allowed_failures
    cluster.scheduler.allowed_failures = 0
    yield client
    cluster.scheduler.allowed_failures = patience


def check_same(study, expected):
    """Bit for bit, and nothing is lost."""
    assert study.failed == []
    assert [record.index for record in study.trials] == [record.index for record in expected.trials]
    assert study.estimates.tobytes() == expected.estimates.tobytes()
    assert study.standard_errors.tobytes() == expected.standard_errors.tobytes()
    assert str(study) == str(expected)


def test_the_number_of_workers_does_not_matter():
    expected = sepcal.monte_carlo(fit_scalar, 12, seed=5, truth=TRUTH)
    with start(1) as cluster, Client(cluster) as client:
        for workers, batch in ((1, 1), (2, 1), (3, 4)):
            cluster.scale(workers)
            client.wait_for_workers(workers)
            study = sepcal.monte_carlo(
                fit_scalar, 12, seed=5, truth=TRUTH, executor=client.get_executor(), batch=batch
            )
            check_same(study, expected)


def kill_a_worker_on_the_way(client, folder, trials=40):
    """SIGKILL to the worker that began a trial last, with most trials still to come."""
    (folder / "cluster").mkdir()
    (folder / "serial").mkdir()
    killed = []

    def kill(done, _):
        if done == 5:
            last = max((folder / "cluster").iterdir(), key=lambda path: path.stat().st_mtime_ns)
            killed.append(last.name.split("-")[1])
            os.kill(int(killed[0]), signal.SIGKILL)

    study = sepcal.monte_carlo(
        SlowTrial(folder / "cluster"),
        trials,
        seed=5,
        executor=client.get_executor(),
        progress=kill,
    )
    check_same(study, sepcal.monte_carlo(SlowTrial(folder / "serial"), trials, seed=5))
    runs = [path.name.split("-") for path in (folder / "cluster").iterdir()]
    assert {int(index) for index, _ in runs} == set(range(trials))
    assert killed[0] in {pid for _, pid in runs}
    assert len({pid for _, pid in runs}) >= 2


def test_a_worker_that_is_killed_loses_nothing(client, tmp_path):
    kill_a_worker_on_the_way(client, tmp_path)


def test_work_that_dask_gives_up_is_submitted_again(impatient, tmp_path):
    kill_a_worker_on_the_way(impatient, tmp_path)


def test_an_item_that_kills_its_workers_takes_no_other_with_it(impatient):
    executor = impatient.get_executor()
    results = dict(stream(die_on_third, range(8), executor, lost=lambda item, error: error))
    assert isinstance(results.pop(3), KilledWorker)
    assert results == {number: number for number in range(8) if number != 3}
    with pytest.raises(sepcal.Error, match=r"item \d was lost in 1 attempt \(KilledWorker"):
        gather(die_on_third, range(8), executor, attempts=1)


def test_a_trial_that_kills_its_workers_is_on_record(impatient):
    def trial(rng, index):
        return {"index": die_on_third(index)}

    study = sepcal.monte_carlo(trial, 5, executor=impatient.get_executor())
    (lost,) = study.failed
    assert (lost.index, lost.failure.type) == (3, "distributed.scheduler.KilledWorker")
    assert "its worker died in every attempt" in lost.failure.message
    assert study["index"].tolist() == [0, 1, 2, 4]


def test_a_result_that_cannot_be_pickled_is_on_record(client):
    study = sepcal.monte_carlo(give_what_stays, 6, executor=client.get_executor())
    stays, gone = study.failed
    assert (stays.index, gone.index) == (2, 4)
    assert stays.failure.message == "the result can't be pickled: RuntimeError: this one stays"
    assert "can't be unpickled" in gone.failure.message
    assert len(study.values) == 4


def test_a_lambda_comes_back_from_dask(client):
    def trial(rng, index):
        return {"double": lambda: 2 * index}

    study = sepcal.monte_carlo(trial, 3, executor=client.get_executor())
    assert [value["double"]() for value in study.values] == [0, 2, 4]


def test_leaving_early_cancels_what_is_pending(client):
    executor = client.get_executor()
    results = stream(wait_and_square, range(500), executor)
    assert len(list(islice(results, 3))) == 3
    results.close()
    assert gather(square, range(5), executor) == [0, 1, 4, 9, 16]  # and doesn't wait for 500


def test_what_cannot_be_sent(client):
    lock = threading.Lock()
    with pytest.raises(sepcal.Error, match="can't be sent"):
        gather(lambda number: (lock, number), range(3), client.get_executor())


def test_a_client_that_is_closed(cluster):
    with Client(cluster) as short:
        executor = short.get_executor()
    for use in (gather, sepcal.monte_carlo):
        with pytest.raises(sepcal.Error, match="was shut down before the work was done"):
            use(square, range(3), executor=executor)
    with pytest.raises(sepcal.Error, match=r"client.get_executor\(\)"):
        gather(square, range(3), short)


def test_a_client_that_closes_on_the_way(cluster):
    short = Client(cluster)
    results = stream(wait_and_square, range(100), short.get_executor(), pending=10)
    next(results)
    short.close()
    with pytest.raises(sepcal.Error, match="was shut down before the work was done"):
        list(results)
