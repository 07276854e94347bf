"""The other peers: who is known, who is present, who is to be queried (docs/peis-wire.md 10)."""
from __future__ import annotations

from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple

from .routing import Route
from .wire import HostRecord

HOSTS_MAX = 4096
LOST_S, LOST_UNMARKED_S = 3.0, 30.0  # without any route
QUERY_WAITS_S = (1.0, 2.0, 4.0, 8.0, 10.0)
GIVEN_UP_S = 15.0  # without a route, after which other kernels may have forgotten us


class HostAppeared(NamedTuple):
    """It can be reached and is known; resumed: it was there before, and may have forgotten our subscriptions."""
    id: int
    marked: bool
    resumed: bool = False


class HostVanished(NamedTuple):
    id: int


class Host:
    """Another peer. announced: a HostAppeared was given out; lost: since when there is no route."""

    def __init__(self, record: HostRecord) -> None:
        self.record = record
        self.announced = False
        self.lost: Optional[float] = None

    def patience(self) -> float:
        """Seconds without any route after which it is forgotten."""
        return LOST_S if self.record.marked else LOST_UNMARKED_S


class HostTable:
    """Bounded. Routes are those that the caller has."""

    def __init__(self) -> None:
        self.hosts: Dict[int, Host] = {}
        self._queries: Dict[int, Tuple[float, int]] = {}  # those without a fitting record: when, how often

    def is_restart(self, record: HostRecord) -> bool:
        """Is another incarnation known?"""
        known = self.hosts.get(record.id)
        return known is not None and known.record.magic != record.magic

    def believes(self, record: HostRecord, cached: bool, route: Optional[Route]) -> bool:
        """What others remember counts only if it fits the route."""
        fits = route is not None and route.magic == record.magic
        if record.id not in self.hosts:
            return len(self.hosts) < HOSTS_MAX and (not cached or fits or route is None)
        return fits or not cached or not self.is_restart(record)

    def store(self, record: HostRecord) -> Host:
        host = self.hosts.setdefault(record.id, Host(record))
        host.record = record
        return host

    def review(self, id: int, reachable: bool, route: Optional[Route], now: float) -> Optional[HostAppeared]:
        """Announces a host that is known and reachable; one without a fitting record is to be queried."""
        host = self.hosts.get(id)
        if host is None or (route is not None and route.magic != host.record.magic):
            self.query(id, now)
            return None
        if not reachable:
            host.lost = now if host.lost is None else host.lost
            return None
        self._queries.pop(id, None)
        lost, host.lost = host.lost, None
        if host.announced and (lost is None or now < lost + GIVEN_UP_S):
            return None
        resumed, host.announced = host.announced, True
        return HostAppeared(id, host.record.marked, resumed)

    def query(self, id: int, now: float) -> None:
        if len(self._queries) < HOSTS_MAX:
            self._queries.setdefault(id, (now, 0))

    def keep_queries(self, reachable: Iterable[int]) -> None:
        kept = set(reachable)
        self._queries = {id: x for id, x in self._queries.items() if id in kept}

    def take_queries(self, now: float) -> List[int]:
        """Whom to query now."""
        due = [id for id, (when, _) in self._queries.items() if when <= now]
        for id in due:
            tries = self._queries[id][1]
            self._queries[id] = now + QUERY_WAITS_S[min(tries, len(QUERY_WAITS_S) - 1)], tries + 1
        return due

    def lost_by(self, now: float) -> List[int]:
        """Those without a route for too long."""
        return [id for id, x in self.hosts.items() if x.lost is not None and x.lost + x.patience() <= now]

    def forget(self, id: int) -> Optional[HostVanished]:
        self._queries.pop(id, None)
        host = self.hosts.pop(id, None)
        return HostVanished(id) if host and host.announced else None

    def deadlines(self) -> List[float]:
        return [x.lost + x.patience() for x in self.hosts.values() if x.lost is not None] + \
            [when for when, _ in self._queries.values()]
