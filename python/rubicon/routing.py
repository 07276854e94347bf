"""Routes to other peers, from the routing tables of neighbours (docs/peis-wire.md 9)."""
from __future__ import annotations

from typing import Dict, Iterable, NamedTuple, Tuple

from .link import Link
from .wire import Entry, Page, encode_page

HOPS_MAX = 30  # metric
BURIED_S = 30.0  # routes to a host that has left are ignored
GRAVES_MAX = 4096
_SEQNO_BELIEVED_MAX = 1 << 30


class Route(NamedTuple):
    link: int
    seqno: int
    hops: int
    magic: int

    @property
    def merit(self) -> int:
        return self.seqno - self.hops


class RoutingTable:
    """Our own table has one entry, so that nothing is relayed over us."""

    def __init__(self, self_id: int, magic: int) -> None:
        self._self, self._magic = self_id, magic
        self._seqno = 0
        self._graves: Dict[int, Tuple[int, float]] = {}
        self.routes: Dict[int, Route] = {}

    def own_page(self, links: int) -> bytes:
        """To be sent to all links: its sequence number is a new one."""
        self._seqno += 1
        own = Entry(self._self, self._seqno, self._magic, 0, min(links, 254))
        return encode_page(Page(0, 1, self._seqno, (own,)))

    def take_own(self, link: Link) -> bool:
        """What a neighbour knows of us. True if it is an earlier incarnation that has to be overtaken (9.6)."""
        own = link.table.pop(self._self, None)
        if own is None or own.magic == self._magic or not self._seqno <= own.seqno < _SEQNO_BELIEVED_MAX:
            return False
        self._seqno = own.seqno
        return True

    def bury(self, host: int, magic: int, now: float) -> None:
        """What neighbours still advertise of an incarnation that has left is ignored for a while."""
        self._graves = {id: grave for id, grave in self._graves.items() if now < grave[1]}
        if len(self._graves) < GRAVES_MAX:
            self._graves[host] = magic, now + BURIED_S

    def _is_buried(self, entry: Entry, now: float) -> bool:
        magic, until = self._graves.get(entry.id, (0, 0.0))
        return now < until and magic == entry.magic

    def update(self, links: Iterable[Link], now: float) -> None:
        """Takes the best route to each host, the present one if others are no better."""
        former, self.routes = self.routes, {}
        for link in links:
            for entry in link.table.values():
                hops = entry.hops + link.cost
                if hops >= HOPS_MAX or self._is_buried(entry, now):
                    continue
                route, known = Route(link.number, entry.seqno, hops, entry.magic), self.routes.get(entry.id)
                before = former.get(entry.id)
                if known is None or route.merit > known.merit or (
                        route.merit == known.merit and before is not None and before.link == link.number):
                    self.routes[entry.id] = route
