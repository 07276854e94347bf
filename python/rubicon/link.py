"""One link, without its socket: the stream in both directions (docs/peis-wire.md 3)."""
from __future__ import annotations

from collections import deque
from typing import Deque, Iterator, Optional, Tuple

from . import wire
from .wire import Header

SILENCE_S = 30.0  # without anything from the other end
MARKED_SILENCE_S = 4.0  # of one that sends heartbeats
GREETING_S = 3.0  # for the first octets on a link that we have opened
HANDSHAKE_S = 5.0  # for the request on a link that others have opened
BEAT_S = 1.0
OUTPUT_MAX = 1 << 17  # octets that wait in a link before reliable messages wait elsewhere
OUTPUT_LIMIT = 1 << 21  # octets beyond which nothing but acknowledgements is accepted


class Stream:
    """Takes a stream apart into the connect request, if one is expected, and packages."""

    def __init__(self, expects_request: bool) -> None:
        self._octets = bytearray()
        self._expects_request = expects_request

    def feed(self, octets: bytes) -> None:
        self._octets += octets

    def request(self) -> Optional[wire.ConnectRequest]:
        """The connect request once it is complete. Raises WireError."""
        if not self._expects_request or len(self._octets) < wire.CONNECT.size:
            return None
        octets = bytes(self._octets[:wire.CONNECT.size])
        del self._octets[:wire.CONNECT.size]
        self._expects_request = False
        return wire.decode_connect(octets)

    def packages(self) -> Iterator[Tuple[Header, bytes]]:
        """All complete packages. Raises WireError where the stream is broken."""
        at, size = 0, wire.HEADER.size
        try:
            while not self._expects_request and len(self._octets) - at >= size:
                header = wire.decode_header(bytes(self._octets[at:at + size]))
                end = at + size + header.length
                if len(self._octets) < end:
                    break
                data = bytes(self._octets[at + size:end])
                at = end
                yield header, data
        finally:
            del self._octets[:at]


class Link:
    """State of a link. Times are seconds of a clock that never goes back."""

    def __init__(self, number: int, opened_by_us: bool, address: str, now: float) -> None:
        self.number = number
        self.address = address
        self.opened_by_us = opened_by_us
        self.stream = Stream(expects_request=not opened_by_us)
        self.open = opened_by_us  # packages may be sent
        self.neighbour: Optional[int] = None
        self.named = False  # it has sent its host record
        self.marked = False
        self.up = False  # it has accepted us
        self.magic = 0
        self.cost = 2
        self.opened = self.last_received = now
        self.received_any = False
        self.beat: Optional[Tuple[int, float]] = None  # its last heartbeat, and when it arrived
        self.next_beat = now + BEAT_S
        self.one_way_delay: Optional[float] = None  # seconds
        self.table: dict = {}  # host: Entry of the last routing table
        self.pages: dict = {}
        self.pages_of: Tuple[int, int] = (0, 0)
        self.loopback = address.startswith("127.")
        self._counter = 0
        self._out: Deque[bytes] = deque()
        self.waiting = 0  # octets to be written

    def write(self, octets: bytes) -> None:
        self._out.append(octets)
        self.waiting += len(octets)

    def send(self, header: Header, data: bytes) -> bool:
        """False if there is no room."""
        if not self.open or (self.waiting > OUTPUT_LIMIT and header.port != wire.Port.ACKS) or \
                self.waiting > 2 * OUTPUT_LIMIT:
            return False
        self.write(wire.encode_package(header._replace(counter=self._counter), data))
        self._counter = (self._counter + 1) & 0xFFFFFFFF
        return True

    def has_room(self) -> bool:
        """For packages of reliable messages, which can wait elsewhere."""
        return self.waiting < OUTPUT_MAX

    def take_output(self, size: int) -> bytes:
        """What is to be written next: at least `size` octets if there are as many."""
        parts, taken = [], 0
        while self._out and taken < size:
            parts.append(self._out.popleft())
            taken += len(parts[-1])
        self.waiting -= taken
        return b"".join(parts)

    def give_back(self, octets: bytes) -> None:
        """What could not be written yet."""
        self._out.appendleft(octets)
        self.waiting += len(octets)

    def patience(self) -> float:
        """Seconds of silence after which it is closed."""
        if not self.open:
            return HANDSHAKE_S
        if not self.received_any:
            return GREETING_S
        return MARKED_SILENCE_S if self.beat and self.marked else SILENCE_S

    def note_beat(self, octets: bytes, now: float) -> None:
        """Raises WireError."""
        sent, echoed, held = wire.decode_heartbeat(octets)
        if echoed:
            delay = max(0.0, (now - (echoed + held) / 1e9) / 2)
            known = self.one_way_delay
            self.one_way_delay = delay if known is None or delay < known else known + (delay - known) / 16
        self.beat = sent, now

    def heartbeat(self, now: float) -> bytes:
        sent, arrived = self.beat or (0, now)
        return wire.HEARTBEAT.pack(int(now * 1e9), sent, int((now - arrived) * 1e9))

    def note_page(self, page: wire.Page) -> bool:
        """Adds a page of a routing table. True if the table is complete, which is then in `table`."""
        if self.pages_of != (page.seqno, page.pages):
            self.pages_of, self.pages = (page.seqno, page.pages), {}
        self.pages[page.page] = page.entries
        if len(self.pages) < page.pages:
            return False
        self.table = {entry.id: entry for entries in self.pages.values() for entry in entries if entry.id > 0}
        self.pages = {}
        return True
