"""The tuple space of one peer: own tuples, those held of others, subscriptions (docs/peis-wire.md 15).

Without sockets, threads and clocks, as overlay.py.
"""
from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Callable, Dict, List, Optional, Set, Tuple as Pair

from . import keys, records
from .errors import RefusedError
from .feed import Send, SubscriberFeed
from .records import DELETED, NEVER, Prototype, Subscribe, Tuple
from .wire import EVERYBODY, Port, WireError

OWN_MAX, OWN_OCTETS_MAX = 20_000, 96 << 20
HELD_MAX, HELD_OCTETS_MAX = 20_000, 96 << 20
SUBSCRIPTIONS_MAX = 1024
LIFETIME_S = 60  # of our subscriptions at marked hosts
REFRESH_S = LIFETIME_S / 3
RESEND_S = 1.0
APPEND_MATCHES_MAX = 256

Deliver = Callable[[Tuple], None]
Name = Pair[int, str]  # owner and folded key


class TupleSpace:
    """network_time: seconds since 1970 at a moment of the clock that never goes back."""

    def __init__(self, self_id: int, network_time: Callable[[float], float], send: Send) -> None:
        self.id = self_id
        self._time, self._send = network_time, send
        self.own: Dict[str, Tuple] = {}
        self.held: Dict[Name, Tuple] = {}
        self.feed = SubscriberFeed(send)
        self.counters: "Counter[str]" = Counter()
        self._octets = {True: 0, False: 0}  # of own tuples and of held ones
        self._expiring: Dict[Name, float] = {}
        self._first_seqno = 0
        self._incomplete: Set[Name] = set()
        self._subscriptions: Dict[int, Pair[Prototype, Deliver]] = {}
        self._next_subscription = 1
        self._hosts: Dict[int, bool] = {}  # those that can be reached, and whether they are marked
        self._next_refresh: Optional[float] = None
        self._resend: Dict[Pair[int, Prototype], float] = {}  # subscriptions that have not reached a host

    # Reading

    def find(self, wanted: Prototype) -> List[Tuple]:
        """All that is here and matches, own tuples first."""
        if wanted.owner != EVERYBODY and not keys.is_pattern(wanted.key):
            x = self._get((wanted.owner, keys.fold(wanted.key)))
            return [x] if x and wanted.matches(x) else []
        return [x for x in [*self.own.values(), *self.held.values()] if wanted.matches(x)]

    def _get(self, name: Name) -> Optional[Tuple]:
        return self.own.get(name[1]) if name[0] == self.id else self.held.get(name)

    def is_subscribed(self, owner: int, key: str) -> bool:
        """Does a subscription bring this tuple, if it exists?"""
        return any(wanted.owner in (EVERYBODY, owner) and wanted.mimetype is None and wanted.octets is None and
                   keys.matches(wanted.key, key) for wanted, _ in self._subscriptions.values())

    # Storing

    def _store(self, x: Tuple) -> bool:
        """False if there is no room."""
        name, mine = (x.owner, keys.fold(x.key)), x.owner == self.id
        known = self._get(name)
        octets = self._octets[mine] + len(x.octets) - (len(known.octets) if known else 0)
        count = len(self.own if mine else self.held) + (known is None)
        if count > (OWN_MAX if mine else HELD_MAX) or octets > (OWN_OCTETS_MAX if mine else HELD_OCTETS_MAX):
            self.counters["no_room"] += 1
            return False
        self._octets[mine] = octets
        if mine:
            self.own[name[1]] = x
        else:
            self.held[name] = x
        self._expiring.pop(name, None)
        if x.expires != NEVER:
            self._expiring[name] = x.expires[0] + x.expires[1] / 1e6
        self._notify(x)
        return True

    def _remove(self, name: Name) -> Optional[Tuple]:
        x = self.own.pop(name[1], None) if name[0] == self.id else self.held.pop(name, None)
        self._expiring.pop(name, None)
        self._incomplete.discard(name)
        if x is None:
            return None
        self._octets[name[0] == self.id] -= len(x.octets)
        if name[0] == self.id:
            self._first_seqno = max(self._first_seqno, x.seqno + 2)
        self._notify(replace(x, deleted=True))
        return x

    def _notify(self, x: Tuple) -> None:
        for wanted, deliver in list(self._subscriptions.values()):
            if wanted.matches(x):
                deliver(x)

    def _stamp(self, now: float) -> records.Time:
        time = self._time(now)
        return int(time), int(time % 1 * 1e6)

    # Own tuples

    def draft(self, owner: int, key: str, content: Pair[bytes, str, int], expires: Optional[float],
              user_time: float, now: float) -> Tuple:
        """A tuple to be set. expires: seconds from now; user_time: seconds since 1970."""
        octets, mimetype, encoding = content
        until = NEVER
        if expires is not None:
            end = self._time(now) + expires
            until = max(2, int(end)), int(end % 1 * 1e6)
        user = int(user_time), int(user_time % 1 * 1e6)
        return Tuple(owner, key, octets, mimetype, encoding, self.id, self._stamp(now), user, until)

    def set_own(self, x: Tuple, now: float) -> None:
        known = self.own.get(keys.fold(x.key))
        x = replace(x, seqno=known.seqno + 1 if known else self._first_seqno, appends=0, written=self._stamp(now))
        if not self._store(x):
            raise RefusedError("there is no room for more own tuples")
        self.feed.publish(x, now)

    def delete_own(self, key: str, now: float) -> bool:
        """False if there was none."""
        gone = self._remove((self.id, keys.fold(key)))
        if gone is None:
            return False
        last = replace(records.deletion_of(gone), seqno=gone.seqno + 1, written=self._stamp(now))
        self.feed.publish(last, now)
        return True

    def append_own(self, x: Tuple, added: bytes, now: float) -> None:
        """Subscribers get the whole value under a new sequence number, not a notice."""
        if x.encoding == records.TEXT and not added.endswith(b"\0"):
            added += b"\0"
        octets = x.extended(added)
        if len(octets) > records.VALUE_MAX:
            raise RefusedError("the value would be too long")
        mimetype = x.mimetype
        if mimetype == records.EMPTY_MIMETYPE:
            mimetype = records.TEXT_MIMETYPE if x.encoding == records.TEXT else records.BINARY_MIMETYPE
        self.set_own(replace(x, octets=octets, mimetype=mimetype), now)

    # Subscriptions of ours

    def subscribe(self, wanted: Prototype, deliver: Deliver, now: float) -> int:
        """What is here already is delivered at once."""
        if len(self._subscriptions) >= SUBSCRIPTIONS_MAX:
            raise RefusedError(f"there are {SUBSCRIPTIONS_MAX} subscriptions already")
        is_requested = any(x == wanted for x, _ in self._subscriptions.values())
        number = self._next_subscription
        self._next_subscription += 1
        self._subscriptions[number] = wanted, deliver
        if self._next_refresh is None:
            self._next_refresh = now + REFRESH_S
        for x in self.find(wanted):
            deliver(x)
        if not is_requested:
            for host in self._hosts:
                self._send_subscription(host, wanted, False, now)
        return number

    def unsubscribe(self, number: int) -> None:
        gone = self._subscriptions.pop(number, None)
        if gone is None:
            return
        wanted, folded = gone[0], keys.fold(gone[0].key)
        if not any(x.owner == wanted.owner and keys.fold(x.key) == folded for x, _ in self._subscriptions.values()):
            for host in self._hosts:
                if wanted.owner in (EVERYBODY, host):
                    self._send(host, Port.UNSUBSCRIBE, records.encode_unsubscribe(wanted.owner, wanted.key), _ignore)
        for name, x in list(self.held.items()):
            if wanted.names(x) and not self._is_wanted(x):
                self._remove(name)

    def _is_wanted(self, x: Tuple) -> bool:
        return any(wanted.matches(x) for wanted, _ in self._subscriptions.values())

    def _send_subscription(self, host: int, wanted: Prototype, refresh: bool, now: float) -> None:
        if wanted.owner not in (EVERYBODY, host):
            return
        lifetime = LIFETIME_S if self._hosts.get(host) else None
        message = records.encode_subscribe(Subscribe(wanted, lifetime, refresh))
        self._send(host, Port.SUBSCRIBE, message, lambda why: self._on_outcome(host, wanted, why, now))

    def _on_outcome(self, host: int, wanted: Prototype, why: str, now: float) -> None:
        if why and host in self._hosts and any(x == wanted for x, _ in self._subscriptions.values()):
            self._resend[host, wanted] = now + RESEND_S

    def _send_subscriptions(self, host: int, refresh: bool, now: float) -> None:
        for wanted in dict.fromkeys(x for x, _ in self._subscriptions.values()):
            self._send_subscription(host, wanted, refresh, now)

    # Hosts

    def host_appeared(self, id: int, marked: bool, now: float) -> None:
        self._hosts[id] = marked
        self.feed.host_appeared(id, marked)
        self._send_subscriptions(id, False, now)

    def host_vanished(self, id: int) -> None:
        self._hosts.pop(id, None)
        self._resend = {key: when for key, when in self._resend.items() if key[0] != id}
        self.feed.host_vanished(id)
        for name in [name for name in self.held if name[0] == id]:
            self._remove(name)

    # Time

    def on_time(self, now: float) -> None:
        time = self._time(now)
        for name in [name for name, end in self._expiring.items() if end <= time]:
            self._remove(name)
        if self._next_refresh is not None and self._next_refresh <= now:
            self._next_refresh = now + REFRESH_S
            for host, marked in self._hosts.items():
                if marked:
                    self._send_subscriptions(host, True, now)
        for host, wanted in [key for key, when in self._resend.items() if when <= now]:
            del self._resend[host, wanted]
            self._send_subscription(host, wanted, False, now)
        self.feed.on_time(now)

    def deadline(self, now: float) -> Optional[float]:
        times = [*self._resend.values()]
        times += [x for x in (self._next_refresh, self.feed.deadline()) if x is not None]
        if self._expiring:
            times.append(now + max(0.0, min(self._expiring.values()) - self._time(now)))
        return min(times, default=None)

    # Messages of others

    def on_arrived(self, port: int, source: int, data: bytes, now: float) -> None:
        try:
            if port == Port.PUSH:
                self._on_push(source, records.decode_tuple(data, self._time(now)), now)
            elif port == Port.APPENDED:
                self._on_appended(source, records.decode_appended(data), now)
            elif port == Port.SET:
                self._on_set(records.decode_tuple(data, self._time(now)), now)
            elif port == Port.APPEND:
                self._on_append(*records.decode_append(data, self._time(now)), now)
            elif port == Port.SUBSCRIBE:
                wanted = records.decode_subscribe(data, self._time(now))
                self.feed.subscribe(source, wanted, source in self._hosts, self.own, now)
            elif port == Port.UNSUBSCRIBE:
                self.feed.unsubscribe(source, *records.decode_unsubscribe(data))
        except WireError:
            self.counters["malformed"] += 1
        except RefusedError:
            self.counters["refused"] += 1

    def _on_set(self, x: Tuple, now: float) -> None:
        if x.owner != self.id:
            raise WireError("not ours")
        if keys.is_reserved(x.key):
            raise RefusedError("reserved")
        if x.expires == DELETED:
            self.delete_own(x.key, now)
        else:
            self.set_own(x, now)

    def _on_append(self, wanted: Prototype, added: bytes, now: float) -> None:
        matching = [x for x in self.own.values() if wanted.matches(x) and not keys.is_reserved(x.key)]
        if len(matching) > APPEND_MATCHES_MAX:
            raise RefusedError("too many tuples match")
        for x in matching:
            self.append_own(x, added, now)

    def _on_push(self, source: int, x: Tuple, now: float) -> None:
        if x.owner != source or source == self.id:
            raise WireError("pushed by another than its owner")
        name = x.owner, keys.fold(x.key)
        held = self.held.get(name)
        deletion = x.expires != NEVER and x.expires[0] + x.expires[1] / 1e6 <= self._time(now)
        if not self._is_wanted(held if deletion and held else x):
            self.counters["unwanted"] += 1
        elif held is None and deletion or held is not None and not self._replaces(x, held, deletion, name):
            self.counters["outdated"] += 1
        elif deletion or not self._store(x):
            self._remove(name)
        else:
            self._incomplete.discard(name)

    def _replaces(self, x: Tuple, held: Tuple, deletion: bool, name: Name) -> bool:
        if x.written > held.written:
            return True
        if x.seqno > held.seqno:
            return not deletion or x.written == held.written
        return name in self._incomplete and x.seqno == held.seqno and x.written == held.written

    def _on_appended(self, source: int, x: records.Appended, now: float) -> None:
        if x.owner != source:
            raise WireError("notice by another than the owner")
        name = source, keys.fold(x.key)
        held = self.held.get(name)
        if held is None or x.seqno < held.seqno or (x.seqno == held.seqno and x.length < len(held.octets)):
            self.counters["outdated"] += 1
        elif x.seqno == held.seqno and x.length == len(held.octets):
            extended = replace(held, octets=held.extended(x.added), appends=(x.appends + 1) & 0x7FFFFFFF)
            if len(extended.octets) > records.VALUE_MAX or not self._store(extended):
                self._remove(name)
        elif name not in self._incomplete:  # something has not arrived: the whole value is wanted
            self._incomplete.add(name)
            self._send_subscription(source, Prototype(source, x.key), False, now)


def _ignore(_why: str) -> None:
    pass
