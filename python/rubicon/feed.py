"""What others have subscribed to, and the pushes to them (docs/peis-wire.md 15.3, 15.6)."""
from __future__ import annotations

from collections import OrderedDict
from typing import Callable, Dict, List, Optional

from . import keys, records
from .records import Prototype, Subscribe, Tuple
from .wire import Port

SUBSCRIBERS_MAX = 4096  # subscriptions of all hosts
SUBSCRIBERS_OF_HOST_MAX = 1024
IN_FLIGHT_MAX = 64  # pushes to one host
IN_FLIGHT_OCTETS_MAX = 1 << 20  # beyond the first
RETRY_S = 1.0
STRANGERS_MAX = 64  # hosts that the network does not know
STRANGER_S = 60.0  # a subscription without a lifetime of a host that the network does not know

Send = Callable[[int, int, bytes, Callable[[str], None]], None]
"""Destination, port, message, and what is called with why it has failed, or with an empty text."""


class _Host:
    def __init__(self) -> None:
        self.wanted: Dict[Prototype, Optional[float]] = {}  # until when
        self.pending: "OrderedDict[str, Tuple]" = OrderedDict()  # the newest of each key
        self.in_flight = 0
        self.octets = 0
        self.not_before = 0.0
        self.known = False


class SubscriberFeed:
    """Only the newest value of a tuple waits for a host; values in between are overtaken."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self._hosts: Dict[int, _Host] = {}
        self._now = 0.0
        self.refused = 0

    def subscribers(self) -> Dict[int, List[Prototype]]:
        return {id: list(host.wanted) for id, host in self._hosts.items() if host.wanted}

    def subscribe(self, source: int, x: Subscribe, known: bool, own: Dict[str, Tuple], now: float) -> None:
        host = self._hosts.get(source)
        wanted = host.wanted if host else {}
        is_new = x.wanted not in wanted
        strangers = sum(not h.known for h in self._hosts.values())
        if is_new and (len(wanted) >= SUBSCRIBERS_OF_HOST_MAX or
                       (host is None and not known and strangers >= STRANGERS_MAX) or
                       sum(len(h.wanted) for h in self._hosts.values()) >= SUBSCRIBERS_MAX):
            self.refused += 1
            return
        host = self._hosts.setdefault(source, _Host())
        host.known = known
        host.wanted[x.wanted] = now + x.lifetime if x.lifetime is not None else None if known else now + STRANGER_S
        if is_new or not x.refresh:
            for name, content in own.items():
                if x.wanted.matches(content):
                    host.pending[name] = content
            self._pump(source, now)

    def unsubscribe(self, source: int, owner: int, key: str) -> None:
        host = self._hosts.get(source)
        if host:
            folded = keys.fold(key)
            host.wanted = {x: until for x, until in host.wanted.items()
                           if x.owner != owner or keys.fold(x.key) != folded}

    def host_appeared(self, id: int, marked: bool) -> None:
        host = self._hosts.get(id)
        if host:
            host.not_before, host.known = 0.0, True
            if not marked:
                host.wanted = dict.fromkeys(host.wanted)

    def host_vanished(self, id: int) -> None:
        self._hosts.pop(id, None)

    def publish(self, x: Tuple, now: float) -> None:
        """A tuple has changed, or is deleted."""
        name = keys.fold(x.key)
        for id, host in list(self._hosts.items()):
            if any(wanted.matches(x) if x.expires != records.DELETED else wanted.names(x) for wanted in host.wanted):
                host.pending.pop(name, None)
                host.pending[name] = x
                self._pump(id, now)

    def _pump(self, id: int, now: float) -> None:
        host = self._hosts[id]
        self._now = max(self._now, now)
        while host.pending and host.not_before <= now and host.in_flight < IN_FLIGHT_MAX:
            name, x = next(iter(host.pending.items()))
            if host.in_flight and host.octets + len(x.octets) > IN_FLIGHT_OCTETS_MAX:
                return
            del host.pending[name]
            host.in_flight += 1
            host.octets += len(x.octets)
            self._send(id, Port.PUSH, records.encode_tuple(x, push=True),
                       lambda why, name=name, x=x: self._done(id, host, name, x, why))

    def _done(self, id: int, host: _Host, name: str, x: Tuple, why: str) -> None:
        host.in_flight -= 1
        host.octets -= len(x.octets)
        if self._hosts.get(id) is not host:
            return
        if why:
            host.pending.setdefault(name, x)
            host.not_before = self._now + RETRY_S
        else:
            self._pump(id, self._now)

    def on_time(self, now: float) -> None:
        self._now = now
        for id, host in list(self._hosts.items()):
            if any(until is not None and until <= now for until in host.wanted.values()):
                host.wanted = {x: until for x, until in host.wanted.items() if until is None or until > now}
            if not host.wanted and not host.in_flight:
                del self._hosts[id]
            elif host.pending:
                self._pump(id, now)

    def deadline(self) -> Optional[float]:
        times = [h.not_before for h in self._hosts.values() if h.pending and h.not_before > self._now]
        times += [t for h in self._hosts.values() for t in h.wanted.values() if t is not None]
        return min(times, default=None)
