"""The network as one peer sees it: links, routes, hosts, messages (docs/peis-wire.md 7 to 13).

Without sockets, threads and clocks: octets, events of links and the time are its input; what links are to send, and
`events`, are its output. It announces only itself, so nothing is relayed over it.
"""
from __future__ import annotations

import random
from collections import Counter, deque
from typing import Callable, Deque, Dict, List, NamedTuple, Optional, Union

from . import wire
from .clock import NetworkClock
from .delivery import Acknowledger, Delivery, IdSource, Outcome, Reassembly, SeenIds
from .hosts import Host, HostAppeared, HostTable, HostVanished
from .link import BEAT_S, Link
from .routing import Route, RoutingTable
from .wire import BROADCAST, DIRECT, EVERYBODY, LINK, Header, HostRecord, Port, WireError

LINKS_MAX = 16
RECEIVED_OVER_MAX = 4096  # hosts of which the link is remembered over which they last sent
ANSWERS_MAX = 1024  # messages that wait, beyond which queries are not answered
ROUTING_PERIOD_S = 10.0
EXIT, REBORN = 1, 2  # reasons in dead-host messages


class Arrived(NamedTuple):
    """A whole message for us."""
    port: int
    source: int
    data: bytes


class LinkClosed(NamedTuple):
    """By us; the socket is to be closed."""
    link: int
    why: str


class LinkUp(NamedTuple):
    """Its neighbour has sent its host record, and has accepted us."""
    link: int
    neighbour: int
    marked: bool


Event = Union[HostAppeared, HostVanished, Arrived, LinkClosed, LinkUp, Outcome]


class Overlay:
    """`now` is always in seconds of a clock that never goes back; offset: what makes it seconds since 1970."""

    def __init__(self, record: HostRecord, network: str, offset: float, now: float, rng: random.Random) -> None:
        self.record, self.network = record, network
        self.ids = IdSource(rng)
        self.clock = NetworkClock(record.id, offset, now)
        self.links: Dict[int, Link] = {}
        self.events: Deque[Event] = deque()
        self.counters: "Counter[str]" = Counter()
        self.rival: Optional[HostRecord] = None  # another peer with our id
        self._delivery = Delivery(record.id, self.ids)
        self._acknowledger = Acknowledger()
        self._reassembly = Reassembly()
        self._seen = SeenIds()
        self._received_over: Dict[int, int] = {}
        self._known = HostTable()
        self._routing = RoutingTable(record.id, record.magic)
        self._next_routing = now + ROUTING_PERIOD_S
        self._left = False
        self._services: Dict[int, Callable[[Link, Header, bytes, float], None]] = {
            Port.ROUTING: self._on_routing, Port.HEARTBEAT: self._on_heartbeat, Port.CLOCK: self._on_clock,
            Port.ACKS: self._on_acks, Port.HOST_QUERY: self._on_query, Port.HOST_RECORD: self._on_record,
            Port.DEAD_HOST: self._on_dead_host, Port.TRACE: self._on_trace}

    @property
    def hosts(self) -> Dict[int, Host]:
        return self._known.hosts

    @property
    def routes(self) -> Dict[int, Route]:
        return self._routing.routes

    # Links

    def link_opened(self, number: int, opened_by_us: bool, address: str, now: float) -> None:
        link = self.links[number] = Link(number, opened_by_us, address, now)
        if len(self.links) > LINKS_MAX:
            self.close_link(number, "too many links", now)
        elif opened_by_us:
            link.write(wire.encode_connect(self.record.id, self.network))
            self._greet(link)

    def link_octets(self, number: int, octets: bytes, now: float) -> None:
        link = self.links.get(number)
        if link is None:
            return
        link.stream.feed(octets)
        try:
            if not link.open:
                self._accept(link, now)
            for header, data in link.stream.packages():
                link.last_received, link.received_any = now, True
                self._on_package(link, header, data, now)
                if number not in self.links:
                    return
        except WireError as error:
            self.counters["links_broken"] += 1
            self.close_link(number, f"broken stream: {error}", now)

    def link_closed(self, number: int, now: float) -> None:
        """Its other end has closed it, or it has failed."""
        link = self.links.pop(number, None)
        if link is None:
            return
        self._received_over = {host: via for host, via in self._received_over.items() if via != number}
        self._update_routes(now)
        self._delivery.hasten(now)

    def close_link(self, number: int, why: str, now: float) -> None:
        if number in self.links:
            self.events.append(LinkClosed(number, why))
            self.link_closed(number, now)

    def _accept(self, link: Link, now: float) -> None:
        request = link.stream.request()
        if request is None:
            return
        why = "" if 0 < request.id <= wire.ID_MAX and request.id != self.record.id else f"id {request.id}"
        if request.network != self.network:
            why = f"network {request.network!r} instead of {self.network!r}"
        if why:
            self.close_link(link.number, f"connect request with {why}", now)
            return
        link.open, link.neighbour, link.last_received = True, request.id, now
        self._greet(link)
        self._update_routes(now)

    def _greet(self, link: Link) -> None:
        self.record = self.record._replace(cluster=min([self.record.id, *self.routes]))
        record = wire.encode_host(self.record)
        self._to_neighbour(link, Port.HOST_RECORD, record)
        if not self.routes:
            header = self._header(BROADCAST, Port.HOST_RECORD)
            link.send(header, record)
        self._send_routing([link])

    # Sending

    def _header(self, type: int, port: int, destination: int = EVERYBODY) -> Header:
        id = self.ids.next()
        return Header(id, id, type, self.record.id, destination, port)

    def _to_neighbour(self, link: Link, port: int, data: bytes) -> None:
        link.send(self._header(LINK, port), data)

    def _to_host(self, destination: int, port: int, data: bytes) -> None:
        """A package that nobody waits for."""
        link = self._link_to(destination)
        if link is None or not link.send(self._header(DIRECT, port, destination), data):
            self.counters["dropped"] += 1

    def broadcast(self, port: int, data: bytes) -> None:
        header = self._header(BROADCAST, port)
        for link in self.links.values():
            link.send(header, data)

    def send(self, token: int, destination: int, port: int, data: bytes) -> str:
        """A reliable message, whose Outcome follows as an event. Why it is refused, or empty."""
        if self._left:
            return "the peer has been closed"
        if self._link_to(destination) is None:
            return f"there is no route to peer {destination}"
        return self._delivery.add(token, destination, port, data)

    def is_idle(self) -> bool:
        return self._delivery.is_idle() and not any(link.waiting for link in self.links.values())

    def neighbour_link(self, host: int) -> Optional[Link]:
        return next((x for x in self.links.values() if x.open and x.neighbour == host), None)

    def _link_to(self, host: int) -> Optional[Link]:
        direct = self.neighbour_link(host)
        if direct:
            return direct
        route = self.routes.get(host)
        return self.links.get(route.link if route else self._received_over.get(host, -1))

    def flush(self, now: float) -> None:
        """At the end of each turn: what is due goes to the links."""
        for source, ids in self._acknowledger.take():
            self._to_host(source, Port.ACKS, wire.encode_acks(ids))
        for destination in self._delivery.destinations():
            link = self._link_to(destination)
            while link is not None and link.open and link.has_room():
                package = self._delivery.next(destination, now)
                if package is None:
                    break
                link.send(*package)

    # Time

    def on_time(self, now: float) -> None:
        for link in list(self.links.values()):
            if link.last_received + link.patience() <= now:
                self.close_link(link.number, f"silent for {link.patience():.0f} s", now)
            elif link.open and link.marked and link.next_beat <= now:
                link.next_beat = now + BEAT_S
                self._to_neighbour(link, Port.HEARTBEAT, link.heartbeat(now))
        again, failed = self._delivery.due(now)
        for header, data in again:
            via = self._link_to(header.destination)
            if via is not None:
                via.send(header, data)
        self.events.extend(failed)
        self._reassembly.on_time(now)
        if self._left:
            return
        if self._next_routing <= now:
            self._next_routing = now + ROUTING_PERIOD_S
            self._send_routing(list(self.links.values()))
        time = self.clock.on_time(now)
        if time is not None:
            self.broadcast(Port.CLOCK, time)
        for id in self._known.lost_by(now):
            self._forget(id)
        for id in self._known.take_queries(now):
            self._to_host(id, Port.HOST_QUERY, wire.QUERY.pack(self.record.id, -1))

    def deadline(self) -> float:
        times = [self._next_routing, self.clock.next]
        for link in self.links.values():
            times.append(link.last_received + link.patience())
            if link.open and link.marked:
                times.append(link.next_beat)
        times += self._known.deadlines()
        due = self._delivery.deadline()
        return min(times if due is None else times + [due])

    def leave(self) -> None:
        """Broadcasts that this peer ends (19)."""
        self.broadcast(Port.DEAD_HOST, wire.DEAD.pack(self.record.id, EXIT))
        self._left = True

    # Receiving (7)

    def _on_package(self, link: Link, x: Header, data: bytes, now: float) -> None:
        if not x.is_legal():
            self.counters["illegal"] += 1
            return
        if x.source == self.record.id:
            self._on_own_id(x, data)
            return
        if not self._seen.insert(x.source, x.id):
            return
        mine = x.type == DIRECT and x.destination == self.record.id
        if x.type == DIRECT and not mine:
            self.counters["not_relayed"] += 1
            return
        if mine:
            if x.source in self._received_over or len(self._received_over) < RECEIVED_OVER_MAX:
                self._received_over[x.source] = link.number
            if x.fragments and not self._reassembly.accepts(x):
                self.counters["fragments_refused"] += 1
                return
            if x.flags & wire.RELIABLE and x.port != Port.ACKS:
                self._acknowledger.add(x.source, x.ack_id)
            if x.ack_id not in (0, x.id) and not self._seen.insert(x.source, x.ack_id):
                return
            if x.fragments:
                whole = self._reassembly.add(x, data, now)
                if whole is None:
                    return
                data = whole
        service = self._services.get(x.port)
        try:
            if service:
                service(link, x, data, now)
            elif mine:
                self.events.append(Arrived(x.port, x.source, data))
        except WireError:
            self.counters["malformed"] += 1

    def _on_own_id(self, x: Header, data: bytes) -> None:
        if x.port == Port.HOST_RECORD and x.type == LINK:
            try:
                record, _ = wire.decode_host(data)
            except WireError:
                return
            if record.id == self.record.id and record.magic != self.record.magic:
                self.rival = record

    def _on_acks(self, _link: Link, x: Header, data: bytes, _now: float) -> None:
        for id in wire.decode_acks(data):
            done = self._delivery.acknowledge(x.source, id)
            if done:
                self.events.append(done)

    def _on_heartbeat(self, link: Link, _x: Header, data: bytes, now: float) -> None:
        first = link.beat is None
        link.note_beat(data, now)
        if first and link.marked:
            self._to_neighbour(link, Port.HEARTBEAT, link.heartbeat(now))
        self._check_up(link)

    def _on_clock(self, link: Link, x: Header, data: bytes, now: float) -> None:
        host = self.hosts.get(x.source)
        self.clock.on_message(data, x.source, bool(host and host.record.marked), link.one_way_delay or 0.0, now)

    def _on_trace(self, _link: Link, x: Header, data: bytes, _now: float) -> None:
        ids = wire.decode_trace(data)
        if len(ids) < 15:
            self._to_host(x.source, Port.TRACE_REPLY, wire.encode_trace(ids + [self.record.id]))

    # Routes (9)

    def _send_routing(self, links: List[Link]) -> None:
        page = self._routing.own_page(len(self.links))
        for link in links:
            self._to_neighbour(link, Port.ROUTING, page)

    def _on_routing(self, link: Link, x: Header, data: bytes, now: float) -> None:
        if x.type != LINK:
            raise WireError("routing page that is no link package")
        if not link.note_page(wire.decode_page(data)):
            return
        overtaken = self._routing.take_own(link)
        self._update_routes(now)
        if overtaken:
            self._send_routing(list(self.links.values()))

    def _update_routes(self, now: float) -> None:
        self._routing.update(self.links.values(), now)
        for id in [*self.hosts, *self.routes]:
            self._review(id, now)
        neighbours = (x.neighbour for x in self.links.values() if x.neighbour is not None)
        self._known.keep_queries([*self.routes, *neighbours])

    def is_reachable(self, host: int) -> bool:
        return host in self.routes or self.neighbour_link(host) is not None

    # Hosts (10, 11)

    def _review(self, id: int, now: float) -> None:
        appeared = self._known.review(id, self.is_reachable(id), self.routes.get(id), now)
        if appeared:
            self.events.append(appeared)

    def _on_query(self, _link: Link, x: Header, data: bytes, _now: float) -> None:
        wire.QUERY.unpack(data)
        if self._delivery.messages < ANSWERS_MAX:
            self.send(0, x.source, Port.HOST_RECORD, wire.encode_host(self.record))
        else:
            self.counters["queries_refused"] += 1

    def _on_record(self, link: Link, x: Header, data: bytes, now: float) -> None:
        record, cached = wire.decode_host(data)
        if not cached and record.id != x.source:
            raise WireError("a record in the name of another host")
        if record.id == self.record.id:
            if record.magic != self.record.magic:
                self.rival = record
            return
        if not cached and x.hops == 1 and link.neighbour in (None, record.id):
            first = not link.named
            link.neighbour, link.named, link.magic, link.marked = record.id, True, record.magic, record.marked
            link.cost = 1 if record.host_name == self.record.host_name else 2
            if first:
                self._on_named(link, now)
        self._store(record, cached, now)

    def _on_named(self, link: Link, now: float) -> None:
        """A marked neighbour answers the first heartbeat at once, if it has not rejected us."""
        self.rival = None
        if link.marked:
            link.next_beat = now + BEAT_S
            self._to_neighbour(link, Port.HEARTBEAT, link.heartbeat(now))
        self._check_up(link)

    def _check_up(self, link: Link) -> None:
        if not link.up and link.named and (link.beat or not link.marked):
            link.up = True
            assert link.neighbour is not None
            self.events.append(LinkUp(link.number, link.neighbour, link.marked))

    def _store(self, record: HostRecord, cached: bool, now: float) -> None:
        if not self._known.believes(record, cached, self.routes.get(record.id)):
            return
        if self._known.is_restart(record):
            self._forget(record.id)
            for link in [x for x in self.links.values() if x.neighbour == record.id and x.magic != record.magic]:
                self.close_link(link.number, "its peer has restarted", now)
        self._known.store(record)
        self._review(record.id, now)

    def _on_dead_host(self, _link: Link, x: Header, data: bytes, now: float) -> None:
        dead = wire.DEAD.unpack(data)
        if dead["id"] != x.source or dead["reason"] not in (0, EXIT, REBORN):
            raise WireError("bad dead-host message")
        if dead["reason"] == REBORN:
            host = self.hosts.get(x.source)
            if host and host.announced:
                self.events.append(HostAppeared(x.source, host.record.marked, True))
        elif dead["reason"] == EXIT and x.type == BROADCAST:
            self._delete(x.source, now)
        elif dead["reason"] == EXIT:  # it has given us up, but it is there
            self._forget(x.source)
            if self.is_reachable(x.source):
                self._known.query(x.source, now)

    def _delete(self, id: int, now: float) -> None:
        host, route = self.hosts.get(id), self.routes.get(id)
        magic = host.record.magic if host else route.magic if route else 0
        self._routing.bury(id, magic, now)
        self._forget(id)
        for link in [x for x in self.links.values() if x.neighbour == id]:
            self.close_link(link.number, "its peer has ended", now)
        self._update_routes(now)

    def _forget(self, id: int) -> None:
        self.events.extend(self._delivery.fail_all(id, f"peer {id} has gone"))
        self._reassembly.drop_source(id)
        vanished = self._known.forget(id)
        if vanished:
            self.events.append(vanished)
