"""Layouts of PEIS messages (docs/peis-wire.md), each a table of fields, and their codecs.

Decoders raise WireError and nothing else, whatever they are given.
"""
from __future__ import annotations

import struct
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Tuple

VERSION = 500
SYNC = 0xFF00AA00
EVERYBODY = -1
DATA_MAX = 1024  # octets of data in a package
FRAGMENTS_MAX = 16384
ID_MAX = 65535
PAGES_MAX = 32
ENTRIES_MAX = 70  # of a page
ACKS_MAX = 200  # ids of one message
ADDRESSES_MAX = 16
MARK = 0x52424E31  # of Rubicon peers (5)

LINK, BROADCAST, DIRECT = 0, 1, 2
RELIABLE, BULK, HIGH = 1, 4, 8


class Port:
    """Ports of the kernel (2)."""
    ROUTING, TRACE, TRACE_REPLY, SUBSCRIBE, UNSUBSCRIBE, PUSH, HEARTBEAT, DEAD_HOST = 0, 1, 2, 5, 6, 7, 8, 9
    SET, CLOCK, HOST_QUERY, HOST_RECORD, ACKS, APPEND, APPENDED = 10, 11, 12, 13, 14, 15, 16
    COUNT = 50


class WireError(ValueError):
    """These octets are not the message that they should be."""


class Layout:
    """A structure of fixed size: rows of name, offset and code of the struct module; gaps are zeros."""

    def __init__(self, size: int, *rows: Tuple[str, int, str]) -> None:
        form, at = ">", 0
        for _, offset, code in rows:
            form += f"{offset - at}x{code}" if offset > at else code
            at = offset + struct.calcsize(">" + code)
        self.size = size
        self._names = [row[0] for row in rows]
        self._struct = struct.Struct(form + (f"{size - at}x" if size > at else ""))
        assert self._struct.size == size

    def pack(self, *values: Any) -> bytes:
        return self._struct.pack(*values)

    def unpack(self, octets: bytes, at: int = 0) -> Dict[str, Any]:
        if len(octets) - at < self.size:
            raise WireError("truncated")
        return dict(zip(self._names, self._struct.unpack_from(octets, at)))

    def values(self, octets: bytes) -> Tuple[Any, ...]:
        if len(octets) < self.size:
            raise WireError("truncated")
        return self._struct.unpack_from(octets)


CONNECT = Layout(76, ("version", 0, "i"), ("id", 4, "i"), ("flags", 8, "I"), ("network", 12, "64s"))
HEADER = Layout(40, ("sync", 0, "I"), ("id", 4, "i"), ("counter", 8, "I"), ("ack_id", 12, "i"), ("flags", 16, "H"),
                ("type", 18, "B"), ("hops", 19, "B"), ("source", 20, "i"), ("destination", 24, "i"), ("port", 28, "H"),
                ("length", 30, "H"), ("fragments", 32, "H"), ("group", 34, "H"), ("fragment", 36, "H"))
ADDRESS = Layout(24, ("device", 0, "8s"), ("loopback", 8, "B"), ("type", 12, "4s"), ("address", 16, "4s"),
                 ("port", 20, "I"))
HOST = Layout(544, ("id", 0, "i"), ("magic", 4, "i"), ("host_name", 8, "64s"), ("full_name", 72, "64s"),
              ("addresses", 136, "B"), ("cluster", 536, "i"), ("mark", 540, "I"))
HOST_ADDRESSES_AT = 144
HOST_MESSAGE_SIZE = 552
PAGE = Layout(12, ("page", 0, "H"), ("pages", 2, "H"), ("entries", 4, "H"), ("seqno", 8, "i"))
ENTRY = Layout(14, ("id", 0, "i"), ("seqno", 4, "i"), ("magic", 8, "i"), ("hops", 12, "B"), ("links", 13, "B"))
QUERY = Layout(8, ("id", 0, "i"), ("magic", 4, "i"))
DEAD = Layout(8, ("id", 0, "i"), ("reason", 4, "i"))
CLOCK = Layout(12, ("seconds", 0, "I"), ("microseconds", 4, "i"), ("rest", 8, "I"))
HEARTBEAT = Layout(24, ("sent", 0, "q"), ("echoed", 8, "q"), ("held", 16, "q"))


def read_text(field: bytes) -> str:
    """Text of a field of fixed size: up to its NUL, which must be there."""
    end = field.find(b"\0")
    if end < 0:
        raise WireError("text without NUL")
    return field[:end].decode("utf-8", "surrogateescape")


def write_text(text: str, size: int) -> bytes:
    """Text for a field of fixed size, cut to leave room for a NUL."""
    return text.encode("utf-8", "surrogateescape")[:size - 1].ljust(size, b"\0")


class ConnectRequest(NamedTuple):
    """What the opener of a link sends first (3.2)."""
    version: int
    id: int
    flags: int
    network: str


def encode_connect(id: int, network: str, flags: int = 5) -> bytes:
    return CONNECT.pack(VERSION, id, flags, write_text(network, 64))


def decode_connect(octets: bytes) -> ConnectRequest:
    x = CONNECT.unpack(octets)
    if x["version"] != VERSION:
        raise WireError(f"protocol version {x['version']}")
    return ConnectRequest(x["version"], x["id"], x["flags"], read_text(x["network"]))


class Header(NamedTuple):
    """Of a package (6)."""
    id: int
    ack_id: int
    type: int
    source: int
    destination: int
    port: int
    length: int = 0
    flags: int = 0
    hops: int = 1
    counter: int = 0
    fragments: int = 0
    group: int = 0
    fragment: int = 0

    def is_legal(self) -> bool:
        """False for what must not be sent and is dropped (20)."""
        if self.type > DIRECT or self.port >= Port.COUNT or self.source <= 0 or not self.id or not self.hops:
            return False
        if self.type == DIRECT and self.destination <= 0:
            return False
        if not self.fragments:
            return True
        if self.type != DIRECT or self.fragments > FRAGMENTS_MAX or self.fragment >= self.fragments:
            return False
        return self.length > 0 if self.fragment + 1 == self.fragments else self.length == DATA_MAX


def encode_package(x: Header, data: bytes) -> bytes:
    return HEADER.pack(SYNC, x.id, x.counter, x.ack_id, x.flags, x.type, x.hops, x.source, x.destination, x.port,
                       len(data), x.fragments, x.group, x.fragment) + data


def decode_header(octets: bytes) -> Header:
    """Raises WireError where the stream is broken (3.4)."""
    (sync, id, counter, ack_id, flags, type, hops, source, destination, port, length, fragments, group,
     fragment) = HEADER.values(octets)
    if sync != SYNC:
        raise WireError(f"wrong sync word {sync:08x}")
    if id < 0 or ack_id < 0:
        raise WireError("negative package id")
    if length > DATA_MAX:
        raise WireError(f"a package of {length} octets")
    return Header(id, ack_id, type, source, destination, port, length, flags, hops, counter, fragments, group,
                  fragment)


class Address(NamedTuple):
    """Where a peer accepts links over TCP and IPv4."""
    device: str
    loopback: bool
    host: str
    port: int


class HostRecord(NamedTuple):
    """Description of a peer by itself (5)."""
    id: int
    magic: int
    host_name: str
    full_name: str
    addresses: Tuple[Address, ...] = ()
    cluster: int = 0
    marked: bool = True

    @property
    def name(self) -> str:
        """The program: what stands before the `@` of the full name."""
        return self.full_name.split("@", 1)[0]


def encode_host(x: HostRecord, cached: bool = False) -> bytes:
    """The message of port 13 (10)."""
    record = bytearray(HOST.pack(x.id, x.magic, write_text(x.host_name, 64), write_text(x.full_name, 64),
                                 len(x.addresses), x.cluster, MARK if x.marked else 0))
    at = HOST_ADDRESSES_AT
    for a in x.addresses:
        record[at:at + 24] = ADDRESS.pack(a.device.encode()[:8], a.loopback, bytes(4),
                                          bytes(map(int, a.host.split("."))), a.port)
        at += 24
    return bytes(record) + bytes((cached,)) + bytes(7)


def decode_host(octets: bytes) -> Tuple[HostRecord, bool]:
    """The record and whether it is cached."""
    if len(octets) < HOST_MESSAGE_SIZE:
        raise WireError("truncated")
    x = HOST.unpack(octets)
    if x["addresses"] > ADDRESSES_MAX or not 0 < x["id"]:
        raise WireError("bad host record")
    addresses: List[Address] = []
    for i in range(x["addresses"]):
        a = ADDRESS.unpack(octets, HOST_ADDRESSES_AT + 24 * i)
        if a["type"] == bytes(4):
            addresses.append(Address(a["device"].split(b"\0")[0].decode("ascii", "replace"), bool(a["loopback"]),
                                     ".".join(map(str, a["address"])), a["port"]))
    return HostRecord(x["id"], x["magic"], read_text(x["host_name"]), read_text(x["full_name"]), tuple(addresses),
                      x["cluster"], x["mark"] == MARK), octets[544] != 0


class Entry(NamedTuple):
    """Of a routing table (9.1)."""
    id: int
    seqno: int
    magic: int
    hops: int
    links: int


class Page(NamedTuple):
    """A page of a routing table (9.1)."""
    page: int
    pages: int
    seqno: int
    entries: Tuple[Entry, ...]


def encode_page(x: Page) -> bytes:
    head = PAGE.pack(x.page, x.pages, len(x.entries), x.seqno)
    return head + b"".join(ENTRY.pack(*entry) for entry in x.entries)


def decode_page(octets: bytes) -> Page:
    x = PAGE.unpack(octets)
    count, page, pages = x["entries"], x["page"], x["pages"]
    if not 0 < pages <= PAGES_MAX or page >= pages or count > ENTRIES_MAX:
        raise WireError("bad routing page")
    if page + 1 < pages and count != ENTRIES_MAX:
        raise WireError("a routing page is not full")
    entries = (Entry(**ENTRY.unpack(octets, PAGE.size + ENTRY.size * i)) for i in range(count))
    return Page(page, pages, x["seqno"], tuple(entries))


def encode_acks(ids: Iterable[int]) -> bytes:
    ids = list(ids)
    return struct.pack(f">I{len(ids)}i", len(ids), *ids)


def decode_acks(octets: bytes) -> Tuple[int, ...]:
    if len(octets) < 4:
        raise WireError("truncated")
    count = int.from_bytes(octets[:4], "big")
    if count > ACKS_MAX or len(octets) < 4 + 4 * count:
        raise WireError("bad acknowledgements")
    return struct.unpack_from(f">{count}i", octets, 4)


def decode_trace(octets: bytes) -> List[int]:
    if len(octets) < 64:
        raise WireError("truncated")
    count, *ids = struct.unpack_from(">I15i", octets)
    if count > 15:
        raise WireError("bad trace")
    return ids[:count]


def encode_trace(ids: List[int]) -> bytes:
    return struct.pack(">I15i", len(ids), *(ids + [0] * (15 - len(ids))))


def encode_clock(time: float, master: bool = False, in_flight: float = 0.0) -> bytes:
    """Times in seconds (12)."""
    whole = int(time // 1)
    flight = min(max(int(in_flight * 1e6), 0), 0xFFFFFF)
    return CLOCK.pack(whole & 0xFFFFFFFF, int((time - whole) * 1e6), (1 << 24 if master else 0) | flight)


def decode_clock(octets: bytes, known: float) -> Tuple[float, bool, float]:
    """Time, whether it is a master's, and seconds in flight. Of possible times the nearest to `known`."""
    x = CLOCK.unpack(octets)
    if not 0 <= x["microseconds"] < 1_000_000:
        raise WireError("bad clock")
    return (unwrap(x["seconds"], known) + x["microseconds"] / 1e6, x["rest"] >> 24 != 0,
            (x["rest"] & 0xFFFFFF) / 1e6)


def unwrap(low: int, known: float) -> int:
    """The number nearest to `known` whose lowest 32 bits are `low`."""
    near = int(known)
    return near + ((low - near + 0x80000000) & 0xFFFFFFFF) - 0x80000000


def decode_heartbeat(octets: bytes) -> Optional[Tuple[int, int, int]]:
    """Times in nanoseconds: sent, echoed, held (16)."""
    x = HEARTBEAT.unpack(octets)
    times = (x["sent"], x["echoed"], x["held"])
    if any(not 0 <= t < 1 << 62 for t in times):
        raise WireError("bad heartbeat")
    return times
