# SPDX-License-Identifier: BSD-3-Clause
"""`sepcal fleet VERB ...`: the loop of many flights, from a folder of logs to a named vehicle."""

from __future__ import annotations

import argparse
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial

from sepcal import _core
from sepcal.calibration import Calibration, load
from sepcal.executors import Executors
from sepcal.fleet.fleet import Fleet
from sepcal.printing import in_line, show, tell
from sepcal.whole_files import refuse_outputs, write_whole

Verbs = argparse._SubParsersAction
LIKE = "a calibration of one flight (sepcal pitot fit ... -o BASE.json): as it, each is calibrated"


def add_to(commands: Verbs[argparse.ArgumentParser]) -> None:
    """Registers the command and its verbs."""
    what = "many flights of many vehicles: compares, diagnoses, adds to and watches them"
    fleet = commands.add_parser("fleet", help=what, description=what)
    verbs = fleet.add_subparsers(metavar="VERB", required=True, dest="verb")
    verb = _add(verbs, "fit", _fit, "every flight calibrated like one of them, into a folder")
    verb.add_argument(
        "logs", metavar="LOG", nargs="*",
        help="a log of any form, a folder, a pattern in quotes, a URL of fsspec [of the table]",
    )  # fmt: skip
    verb.add_argument("--like", metavar="BASE.json", required=True, help=LIKE)
    verb.add_argument(
        "--names", metavar="PATTERN",
        help="what stands in the logs' names: '{vehicle}/{date}_*.ulg' [the folder is the vehicle]",
    )  # fmt: skip
    verb.add_argument(
        "--table", metavar="LOGS.csv",
        help="a table with a column `file`, and vehicle, date, numbers and words in others",
    )  # fmt: skip
    verb.add_argument(
        "--share", metavar="NAME", default="vehicle",
        help="the field or column whose flights share parameters: sensor, say [vehicle]",
    )  # fmt: skip
    verb.add_argument(
        "--own", action="append", metavar="NAME",
        help="a parameter that each flight has for itself [w_n, w_e, w_d]",
    )  # fmt: skip
    verb.add_argument(
        "--common", action="append", metavar="NAME", default=[],
        help="a parameter that all vehicles share [none]",
    )  # fmt: skip
    verb.add_argument(
        "--only", action="append", metavar="EFFECT",
        help="a candidate to be tested [all that are linear]",
    )  # fmt: skip
    _add_output(verb)
    _add_cluster(verb)
    verb = _add(verbs, "compare", _compare, "where the model fails: flights by what they share")
    _add_folder(verb)
    verb.add_argument(
        "--by", metavar="NAME", default="vehicle",
        help="flight, vehicle, month, a word or number of the names or table, a channel [vehicle]",
    )  # fmt: skip
    verb = _add(verbs, "diagnose", _diagnose, "which effect is missing, everywhere or in a vehicle")
    _add_folder(verb)
    verb.add_argument(
        "--significance",
        type=float,
        default=0.01,
        metavar="P",
        help="share of sound fleets in which something may be found [0.01]",
    )
    verb = _add(verbs, "add", _add_effect, "the fleet with one more effect in every flight")
    _add_folder(verb)
    verb.add_argument("effect", metavar="EFFECT", help="as diagnose names it")
    verb.add_argument(
        "--common", action="store_true", help="one coefficient for all vehicles [each has its own]"
    )
    _add_output(verb)
    _add_cluster(verb)
    verb = _add(verbs, "population", _population, "how parameters spread over vehicles")
    _add_folder(verb)
    verb.add_argument("--correlated", action="store_true", help="with covariances between them")
    verb = _add(verbs, "calibrate", _calibrate, "a new vehicle, with the fleet as what is known")
    _add_folder(verb)
    verb.add_argument("log", metavar="NEW.csv", help="a short flight of it")
    verb.add_argument("-o", "--output", metavar="CAL.json", required=True)
    verb = _add(verbs, "monitor", _monitor, "parameters in time: limits, changes, who departs")
    _add_folder(verb)
    verb.add_argument(
        "--significance",
        type=float,
        default=0.01,
        metavar="P",
        help="share of sound fleets in which something may be found [0.01]",
    )
    verb = _add(verbs, "report", _report, "one page of all of these")
    _add_folder(verb)
    verb.add_argument("-o", "--output", metavar="FLEET.html", help="[the folder's name and .html]")


def _add(
    verbs: Verbs[argparse.ArgumentParser],
    name: str,
    run: Callable[[argparse.Namespace], int],
    what: str,
) -> argparse.ArgumentParser:
    verb = verbs.add_parser(name, help=what, description=what)
    verb.add_argument("--json", action="store_true", help="prints JSON in place of the page")
    verb.set_defaults(run=run)
    return verb


def _add_folder(verb: argparse.ArgumentParser) -> None:
    verb.add_argument("folder", metavar="FLEET", help="the folder that fit or add wrote")


def _add_output(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "-o", "--output", metavar="FLEET", required=True,
        help="a folder for what is found; a run that ended early is taken up there",
    )  # fmt: skip


def _add_cluster(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "--processes", type=int, metavar="N", help="in so many processes [in threads]"
    )
    verb.add_argument(
        "--dask", metavar="ADDRESS", help="on a Dask cluster: the scheduler's, tcp://host:8786"
    )
    verb.set_defaults(kept="the same command goes on with what is done")


def _leave_interrupts() -> None:
    """Ctrl-C is the first process's to hear, which ends the others."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def _cluster(given: argparse.Namespace) -> Iterator[Executors]:
    if given.processes is not None and given.dask:
        raise _core.Error("give --processes or --dask, not both")
    if given.processes is not None:
        if given.processes < 1:
            raise _core.Error(f"--processes {given.processes}: give at least 1")
        yield partial(ProcessPoolExecutor, given.processes, initializer=_leave_interrupts)
        return
    if not given.dask:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise _core.Error("--dask needs distributed: pip install sepcal[dask]") from None
    try:
        client = Client(given.dask, timeout=10)  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TypeError) as error:
        raise _core.Error(f"--dask {in_line(given.dask)}: {in_line(str(error))}") from None
    with client:
        tell(f"sepcal fleet: dashboard at {client.dashboard_link}")
        yield client.get_executor()  # type: ignore[no-untyped-call]


def _show(given: argparse.Namespace, result: object) -> None:
    show(result.to_json() if given.json else str(result))  # type: ignore[attr-defined]


def _base_of(file: str) -> Calibration:
    base = load(file)
    if not isinstance(base, Calibration):
        raise _core.Error(f"{in_line(file)}: a fleet is of probes and magnetometers")
    return base


def _fit(given: argparse.Namespace) -> int:
    with _cluster(given) as cluster:
        fleet = Fleet(
            given.logs or None,
            _base_of(given.like),
            own=given.own,
            common=given.common,
            names=given.names,
            table=given.table,
            share=given.share,
            candidates=given.only,
            cluster=cluster,
            store=given.output,
        )
        fleet.save(given.output)
    _show(given, fleet)
    return 0


def _opened(given: argparse.Namespace, cluster: Executors = None) -> Fleet:
    return Fleet.load(given.folder, cluster=cluster)


def _compare(given: argparse.Namespace) -> int:
    _show(given, _opened(given).compare(given.by))
    return 0


def _diagnose(given: argparse.Namespace) -> int:
    found = _opened(given).diagnose(significance=given.significance)
    _show(given, found)
    return found.exit_code


def _add_effect(given: argparse.Namespace) -> int:
    if os.path.abspath(given.output) == os.path.abspath(given.folder):
        raise _core.Error("-o names the fleet itself; give another folder")
    with _cluster(given) as cluster:
        fleet = _opened(given, cluster).add(given.effect, common=given.common, store=given.output)
        fleet.save(given.output)
    _show(given, fleet)
    return 0


def _population(given: argparse.Namespace) -> int:
    _show(given, _opened(given).population(correlated=given.correlated))
    return 0


def _calibrate(given: argparse.Namespace) -> int:
    refuse_outputs((given.output,), (given.log,))
    made = _opened(given).population().calibrate(given.log)
    made.save(given.output)
    _show(given, made)
    return 0 if made.success else 5


def _monitor(given: argparse.Namespace) -> int:
    watched = _opened(given).monitor(significance=given.significance)
    _show(given, watched)
    return watched.exit_code


def _report(given: argparse.Namespace) -> int:
    from sepcal.fleet.report import fleet_report

    output = given.output or f"{given.folder.rstrip('/')}.html"
    refuse_outputs((output,), ())
    write_whole({output: fleet_report(_opened(given))})
    show(output)
    return 0
