"""Reliable and long messages between the two ends (docs/peis-wire.md 8)."""
from __future__ import annotations

import random
from collections import OrderedDict, deque
from typing import Deque, Dict, List, NamedTuple, Optional, Tuple

from .wire import ACKS_MAX, BULK, DATA_MAX, DIRECT, FRAGMENTS_MAX, RELIABLE, Header

RETRY_S = 0.4  # attempt k is followed by a wait of k times this
ATTEMPTS_MAX = 7
WINDOW = 256  # packages to one destination that are not acknowledged
WAITING_MAX = 4096  # messages to one destination
WAITING_OCTETS_MAX = 64 << 20  # of them, beyond the first
MESSAGES_MAX = 16384  # to all destinations
SEEN_MAX = 16384  # no more are under way to a peer that relays nothing
PARTIAL_MAX = 64  # long messages that arrive at once
PARTIAL_OCTETS_MAX = 48 << 20
PARTIAL_S = 10.0  # after the last fragment


class IdSource:
    """Numbers of packages and groups of fragments, from a random place on by random strides."""

    def __init__(self, rng: random.Random) -> None:
        self._rng = rng
        self._id = rng.randrange(1, 0x7FFFFFFF)
        self._group = rng.randrange(1, 32767)

    def next(self) -> int:
        self._id = (self._id + self._rng.randrange(1, 8)) % 0x7FFFFFFF or 1
        return self._id

    def next_group(self) -> int:
        self._group = self._group % 32767 + 1
        return self._group


class SeenIds:
    """Remembers the newest numbers."""

    def __init__(self, most: int = SEEN_MAX) -> None:
        self._known: "OrderedDict[int, None]" = OrderedDict()
        self._most = most

    def insert(self, source: int, number: int) -> bool:
        """False if it is known."""
        known = source << 32 | number
        if known in self._known:
            return False
        self._known[known] = None
        if len(self._known) > self._most:
            self._known.popitem(last=False)
        return True


class Outcome(NamedTuple):
    """Of a reliable message; why is empty if it has arrived."""
    token: int
    why: str


class _Message:
    def __init__(self, token: int, port: int, data: bytes, group: int) -> None:
        self.token, self.port, self.data, self.group = token, port, data, group
        self.packages = max(1, -(-len(data) // DATA_MAX))
        self.begun = 0
        self.unacknowledged = 0


class _Pending:
    def __init__(self, destination: int, message: _Message, fragment: int) -> None:
        self.destination, self.message, self.fragment = destination, message, fragment
        self.attempts = 0
        self.due = 0.0


class Delivery:
    """Sends messages until they are acknowledged. Decides what is sent when; others write it."""

    def __init__(self, self_id: int, ids: IdSource) -> None:
        self._self, self._ids = self_id, ids
        self._queues: Dict[int, Deque[_Message]] = {}
        self._octets: Dict[int, int] = {}
        self._in_flight: Dict[int, "OrderedDict[int, _Pending]"] = {}
        self._by_ack: Dict[int, _Pending] = {}
        self.messages = 0  # that have no outcome yet

    def add(self, token: int, destination: int, port: int, data: bytes) -> str:
        """Queues a message. Why it is refused, or empty."""
        queue = self._queues.get(destination, deque())
        octets = self._octets.get(destination, 0)
        if len(queue) >= WAITING_MAX or (queue and octets + len(data) > WAITING_OCTETS_MAX):
            return "too many messages wait for that peer"
        if self.messages >= MESSAGES_MAX:
            return "too many messages wait"
        if len(data) > FRAGMENTS_MAX * DATA_MAX:
            return "the message is too long"
        self.messages += 1
        self._queues[destination] = queue
        queue.append(_Message(token, port, data, self._ids.next_group() if len(data) > DATA_MAX else 0))
        self._octets[destination] = octets + len(data)
        return ""

    def destinations(self) -> List[int]:
        """Those for which something is queued or in flight."""
        return list(self._queues.keys() | self._in_flight.keys())

    def next(self, destination: int, now: float) -> Optional[Tuple[Header, bytes]]:
        """The next package to a destination for the first time, if the window has room."""
        queue = self._queues.get(destination)
        flight = self._in_flight.setdefault(destination, OrderedDict())
        if not queue or len(flight) >= WINDOW:
            if not flight:
                del self._in_flight[destination]
            return None
        message = queue[0]
        pending = _Pending(destination, message, message.begun)
        ack_id = self._ids.next()
        flight[ack_id] = self._by_ack[ack_id] = pending
        message.begun += 1
        message.unacknowledged += 1
        if message.begun == message.packages:
            queue.popleft()
            self._octets[destination] -= len(message.data)
            self._tidy(destination)
        return self._transmit(ack_id, pending, now)

    def _tidy(self, destination: int) -> None:
        if not self._queues.get(destination, True):
            del self._queues[destination]
            self._octets.pop(destination, None)
        if not self._in_flight.get(destination, True):
            del self._in_flight[destination]

    def _transmit(self, ack_id: int, x: _Pending, now: float) -> Tuple[Header, bytes]:
        x.attempts += 1
        x.due = now + x.attempts * RETRY_S
        message, at = x.message, x.fragment * DATA_MAX
        data = message.data[at:at + DATA_MAX]
        long = message.packages > 1
        return Header(self._ids.next(), ack_id, DIRECT, self._self, x.destination, message.port, len(data),
                      RELIABLE | (BULK if long else 0), fragments=message.packages if long else 0,
                      group=message.group, fragment=x.fragment), data

    def acknowledge(self, source: int, ack_id: int) -> Optional[Outcome]:
        """The outcome of a message of which this was the last package."""
        x = self._by_ack.get(ack_id)
        if x is None or x.destination != source:
            return None
        del self._by_ack[ack_id]
        del self._in_flight[x.destination][ack_id]
        self._tidy(x.destination)
        x.message.unacknowledged -= 1
        done = x.message.unacknowledged == 0 and x.message.begun == x.message.packages
        self.messages -= done
        return Outcome(x.message.token, "") if done else None

    def due(self, now: float) -> Tuple[List[Tuple[Header, bytes]], List[Outcome]]:
        """What is to be repeated now, and what has failed."""
        again, failed = [], []
        for ack_id, x in list(self._by_ack.items()):
            if x.due > now or ack_id not in self._by_ack:
                continue
            if x.attempts >= ATTEMPTS_MAX:
                failed.append(self._fail(x.destination, x.message, "it was not acknowledged"))
            else:
                again.append(self._transmit(ack_id, x, now))
        return again, failed

    def hasten(self, now: float) -> None:
        """A link has closed: what it may have lost is repeated at once, or when there is a route."""
        for x in self._by_ack.values():
            if x.attempts < ATTEMPTS_MAX:
                x.due = min(x.due, now)

    def _fail(self, destination: int, message: _Message, why: str) -> Outcome:
        flight = self._in_flight.get(destination, OrderedDict())
        for ack_id in [a for a, x in flight.items() if x.message is message]:
            del flight[ack_id], self._by_ack[ack_id]
        queue = self._queues.get(destination)
        if queue and message in queue:
            queue.remove(message)
            self._octets[destination] -= len(message.data)
        self._tidy(destination)
        self.messages -= 1
        return Outcome(message.token, why)

    def fail_all(self, destination: int, why: str) -> List[Outcome]:
        messages = [x.message for x in self._in_flight.get(destination, OrderedDict()).values()]
        messages += self._queues.get(destination, ())
        return [self._fail(destination, message, why) for message in dict.fromkeys(messages)]

    def deadline(self) -> Optional[float]:
        return min((x.due for x in self._by_ack.values()), default=None)

    def is_idle(self) -> bool:
        return not self._queues and not self._by_ack


class Acknowledger:
    """Collects what is to be acknowledged during one turn."""

    def __init__(self) -> None:
        self._ids: Dict[int, List[int]] = {}

    def add(self, source: int, ack_id: int) -> None:
        self._ids.setdefault(source, []).append(ack_id)

    def take(self) -> List[Tuple[int, List[int]]]:
        """Destinations and ids, as many as one message takes."""
        taken, self._ids = self._ids, {}
        step = ACKS_MAX // 2
        return [(source, ids[i:i + step]) for source, ids in taken.items() for i in range(0, len(ids), step)]


class _Partial:
    def __init__(self, fragments: int) -> None:
        self.fragments = fragments
        self.have: Dict[int, bytes] = {}
        self.octets = 0
        self.last = 0.0


class Reassembly:
    """Puts the fragments of long messages together."""

    def __init__(self) -> None:
        self._partial: Dict[Tuple[int, int, int], _Partial] = {}
        self._octets = 0

    def accepts(self, x: Header) -> bool:
        """Is there room? What is refused must not be acknowledged."""
        known = self._partial.get((x.source, x.group, x.port))
        if known is None and len(self._partial) >= PARTIAL_MAX:
            return False
        return (known is None or known.fragments == x.fragments) and self._octets + x.length <= PARTIAL_OCTETS_MAX

    def add(self, x: Header, data: bytes, now: float) -> Optional[bytes]:
        """The whole message, if this was the last fragment that was missing."""
        group = x.source, x.group, x.port
        partial = self._partial.setdefault(group, _Partial(x.fragments))
        partial.last = now
        if x.fragment not in partial.have:
            partial.have[x.fragment] = data
            partial.octets += len(data)
            self._octets += len(data)
        if len(partial.have) < partial.fragments:
            return None
        self._drop(group)
        return b"".join(partial.have[i] for i in range(partial.fragments))

    def _drop(self, group: Tuple[int, int, int]) -> None:
        self._octets -= self._partial.pop(group).octets

    def drop_source(self, source: int) -> None:
        for group in [g for g in self._partial if g[0] == source]:
            self._drop(group)

    def on_time(self, now: float) -> int:
        """Drops what is incomplete for too long; how many."""
        late = [group for group, x in self._partial.items() if x.last + PARTIAL_S <= now]
        for group in late:
            self._drop(group)
        return len(late)
