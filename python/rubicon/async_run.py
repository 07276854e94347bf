"""Steered runs for asyncio: `AsyncRun` is a `Run` whose calls are awaited."""
from __future__ import annotations

import asyncio
import functools
import os
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, TypeVar, Union

from .errors import RunError
from .run import Run, Step

__all__ = ["AsyncRun"]

_R = TypeVar("_R")


def _close_late(start: Future[Run]) -> None:
    if not start.cancelled() and start.exception() is None:
        start.result().close()


class AsyncRun:
    """A run of an ecology whose calls are awaited, so that many go on at once in one program of asyncio.

        async def delivery(seed):
            async with AsyncRun("home.toml", seed=seed) as run:
                await run.step(60)
                return (await run.finish())["messages"]["delivery"]

        async def main():
            print(await asyncio.gather(*(delivery(seed) for seed in range(1, 9))))

        asyncio.run(main())

    It takes what `Run` takes, and its calls do what those of `Run` do. The process starts as the block begins.

    Each run has a process and a thread of its own, and does its calls one after the other. A call that is cancelled goes
    on, and later ones wait for it; the end of the block, or close(), ends it at once.
    """

    def __init__(self, ecology: Union[str, os.PathLike[str], Mapping[str, Any]], *, seed: Optional[int] = None,
                 length: Optional[float] = None, binary: Optional[str] = None, options: Sequence[str] = (),
                 threads: int = 1) -> None:
        """Keeps what the run is to be; the block starts it."""
        self._start = functools.partial(Run, ecology, seed=seed, length=length, binary=binary, options=options,
                                        threads=threads)
        self._thread = ThreadPoolExecutor(1, "rubicon-run")
        self._started: Optional[Run] = None

    async def __aenter__(self) -> AsyncRun:
        """Starts the binary. RunError: it is not there, or the file has mistakes."""
        start = self._thread.submit(self._start)
        try:
            self._started = await asyncio.wrap_future(start)
        except BaseException:
            start.add_done_callback(_close_late)
            self._thread.shutdown(wait=False)
            raise
        return self

    async def __aexit__(self, *_: Any) -> None:
        """As close()."""
        await self.close()

    @property
    def run(self) -> Run:
        """The Run itself: its `name`, `seed`, `length`, `peers`, `mote_names` and `now`. Its calls are not awaited."""
        if self._started is None:
            raise RunError("the run has not started: use it in `async with`")
        return self._started

    @property
    def now(self) -> float:
        """Time of the run [s since its begin]."""
        return self.run.now

    async def _call(self, method: Callable[..., _R], *args: Any, **more: Any) -> _R:
        return await asyncio.get_running_loop().run_in_executor(self._thread, functools.partial(method, *args, **more))

    async def step(self, length: Optional[float] = None, *, until: Union[float, Callable[[Run], Any], None] = None,
                   every: float = 1.0, limit: Optional[float] = None) -> Step:
        """Lets time go on, as Run.step(). A condition is called with the Run, in its thread."""
        return await self._call(self.run.step, length, until=until, every=every, limit=limit)

    async def get(self, peer: str, key: str, owner: Optional[str] = None) -> Optional[str]:
        """A tuple as a peer has it, as Run.get()."""
        return await self._call(self.run.get, peer, key, owner)

    async def subscribe(self, pattern: str = "", owner: Optional[str] = None) -> None:
        """Steps return writes of tuples that match, as Run.subscribe()."""
        await self._call(self.run.subscribe, pattern, owner)

    async def subscribe_events(self) -> None:
        """Steps return the events of the run."""
        await self._call(self.run.subscribe_events)

    async def motes(self) -> Dict[str, Dict[str, Any]]:
        """All motes by name, as Run.motes()."""
        return await self._call(self.run.motes)

    async def report(self) -> Dict[str, Any]:
        """The report so far, as Run.report()."""
        return await self._call(self.run.report)

    async def set(self, peer: str, key: str, value: str) -> None:
        """Sets an own tuple of a peer, as Run.set()."""
        await self._call(self.run.set, peer, key, value)

    async def fault(self, words: str) -> None:
        """Causes a fault or a change now, as Run.fault()."""
        await self._call(self.run.fault, words)

    async def send(self, mote: str, destination: str, octets: Union[bytes, str], *, am_type: int = 10,
                   reliable: bool = True) -> int:
        """Sends a message as a program of a mote does, as Run.send()."""
        return await self._call(self.run.send, mote, destination, octets, am_type=am_type, reliable=reliable)

    async def record(self) -> str:
        """What was done so far, as lines: Run.record()."""
        return await self._call(self.run.record)

    async def to_toml_tables(self) -> str:
        """What was done so far, as tables of a file: Run.to_toml_tables()."""
        return await self._call(self.run.to_toml_tables)

    async def batch(self, requests: Sequence[Mapping[str, Any]]) -> List[Dict[str, Any]]:
        """Many requests of the protocol at once, as Run.batch()."""
        return await self._call(self.run.batch, requests)

    async def finish(self) -> Dict[str, Any]:
        """Runs it to its end and returns the report, as Run.finish()."""
        return await self._call(self.run.finish)

    async def close(self) -> None:
        """Ends the process, wherever the run is, and a call that has not returned."""
        if self._started is not None:
            self._started._interrupt()
            await self._call(self._started.close)
        self._thread.shutdown(wait=False)
