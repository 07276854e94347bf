"""A whole peer without sockets, threads and clocks: overlay and tuple space together."""
from __future__ import annotations

import random
from typing import Callable, Dict, List, NamedTuple

from .delivery import Outcome
from .hosts import HostAppeared, HostVanished
from .overlay import Arrived, LinkClosed, LinkUp, Overlay
from .tuples import TupleSpace
from .wire import HostRecord

KERNEL_VERSION = "v0.6.0.7 (proto 500)"


class Notice(NamedTuple):
    """Of a link, for who owns its socket: it is up, or closed by us."""
    link: int
    why: str = ""
    up: bool = False
    marked: bool = False


class Kernel:
    """`now`: seconds of a clock that never goes back; offset: what makes it seconds since 1970."""

    def __init__(self, record: HostRecord, network: str, user: str, offset: float, now: float,
                 rng: random.Random) -> None:
        self.overlay = Overlay(record, network, offset, now, rng)
        self.space = TupleSpace(record.id, self.overlay.clock.at, self.send)
        self.notices: List[Notice] = []
        self._waiting: Dict[int, Callable[[str], None]] = {}
        self._token = 0
        for key, text in (("hostname", record.host_name), ("name", record.name), ("user", user),
                          ("id", str(record.id)), ("version", KERNEL_VERSION)):
            content = text.encode("utf-8", "replace") + b"\0", "text/plain", 0
            self.space.set_own(self.space.draft(record.id, "kernel." + key, content, None, 0.0, now), now)

    def send(self, destination: int, port: int, data: bytes, done: Callable[[str], None]) -> None:
        """done is called once: with why it has failed, or an empty text when it was acknowledged."""
        self._token += 1
        why = self.overlay.send(self._token, destination, port, data)
        if why:
            done(why)
        else:
            self._waiting[self._token] = done

    def link_octets(self, link: int, octets: bytes, now: float) -> None:
        self.overlay.link_octets(link, octets, now)
        self.settle(now)

    def on_time(self, now: float) -> None:
        self.overlay.on_time(now)
        self.space.on_time(now)
        self.settle(now)

    def settle(self, now: float) -> None:
        """To be called after any input: handles what it has led to."""
        events = self.overlay.events
        while events:
            x = events.popleft()
            if isinstance(x, Arrived):
                self.space.on_arrived(x.port, x.source, x.data, now)
            elif isinstance(x, Outcome):
                self._waiting.pop(x.token, _ignore)(x.why)
            elif isinstance(x, HostAppeared):
                self.space.host_appeared(x.id, x.marked, now)
            elif isinstance(x, HostVanished):
                self.space.host_vanished(x.id)
            elif isinstance(x, LinkClosed):
                self.notices.append(Notice(x.link, x.why))
            elif isinstance(x, LinkUp):
                self.notices.append(Notice(x.link, up=True, marked=x.marked))
        self.overlay.flush(now)

    def take_notices(self) -> List[Notice]:
        notices, self.notices = self.notices, []
        return notices

    def deadline(self, now: float) -> float:
        times = [self.overlay.deadline()]
        space = self.space.deadline(now)
        return min(times if space is None else times + [space])


def _ignore(_why: str) -> None:
    pass
