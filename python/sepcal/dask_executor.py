# SPDX-License-Identifier: BSD-3-Clause
"""Dask's executor, with futures that always end.

distributed's ClientExecutor fetches a result without looking out for exceptions: where the result
died with its worker and can't be computed again, its future waits for ever, or ends with a
TypeError. Here the same client submits, and whatever comes of it ends the future.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any


def with_sure_futures(executor: Executor) -> Executor:
    """The executor; for distributed's ClientExecutor one that submits to its client."""
    if not type(executor).__module__.startswith("distributed"):
        return executor
    client = getattr(executor, "_client", None)
    options = getattr(executor, "_kwargs", None)
    return executor if client is None else _DaskExecutor(executor, client, options or {})


class _DaskExecutor(Executor):
    def __init__(self, executor: Executor, client: Any, options: dict[str, Any]) -> None:  # noqa: ANN401
        self._executor = executor
        self._client = client
        self._options = options  # of Client.submit(): workers, resources, retries

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:  # type: ignore[override]  # noqa: ANN401
        """Runs it on the cluster. Raises RuntimeError where client or executor are closed."""
        if getattr(self._executor, "_shutdown", False):
            raise RuntimeError("the executor was shut down")
        if getattr(self._client, "status", "") in ("closing", "closed"):
            raise RuntimeError("the client was closed")
        remote = self._client.submit(function, *arguments, **self._options)
        future: Future[Any] = Future()

        async def fetch() -> None:
            try:
                result = await self._client.gather(remote, asynchronous=True)
            except BaseException as error:
                if future.set_running_or_notify_cancel():
                    future.set_exception(error)
                return
            if future.set_running_or_notify_cancel():
                future.set_result(result)

        def cancel(done: Future[Any]) -> None:
            if done.cancelled():
                remote.cancel()

        future.add_done_callback(cancel)
        self._client.loop.add_callback(fetch)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Shuts down Dask's."""
        del cancel_futures
        self._executor.shutdown(wait=wait)
