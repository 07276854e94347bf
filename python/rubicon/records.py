"""Tuples, prototypes, and the messages that carry them (docs/peis-wire.md 15)."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple, Optional, Tuple as Pair, Union

from . import keys
from .errors import BadValueError
from .wire import EVERYBODY, Layout, WireError, read_text, unwrap, write_text

RECORD = Layout(224, ("owner", 0, "i"), ("creator", 4, "i"), ("written", 8, "i"), ("written_us", 12, "i"),
                ("user", 16, "i"), ("user_us", 20, "i"), ("expiry", 24, "i"), ("expiry_us", 28, "i"),
                ("encoding", 32, "i"), ("mimetype", 36, "B"), ("has_value", 40, "4s"), ("length", 44, "I"),
                ("key", 84, "128s"), ("is_new", 212, "i"), ("seqno", 216, "i"), ("appends", 220, "i"))
VALUE_MAX = 16384 * 1024 - 1024  # octets
MIMETYPE_MAX = 254
TEXT, BINARY = 0, 1
TEXT_MIMETYPE, BINARY_MIMETYPE = "text/plain", "application/octet-stream"
EMPTY_MIMETYPE = "x-rubicon/empty"
META_MIMETYPE = "x-peis/metatuple"
DELETED = (1, 0)  # as expiry
NEVER = (0, 0)
_ANY = -1
_IN_PUSH, _IN_SET = b"\1\0\0\0", b"\0\0\0\1"

Value = Union[str, bytes, int, float]
Time = Pair[int, int]  # seconds since 1970 and microseconds


@dataclass(frozen=True)
class Tuple:
    """A named value that lives with its owner.

    owner, creator: ids of peers; the creator wrote it last. octets: the value as it is sent, text with its trailing
    NUL. written, user_time, expires: seconds since 1970 and microseconds of network time; expires is (0, 0) if it
    lives until it is deleted. deleted: only in callbacks: the tuple has gone, and this was its last value.
    """
    owner: int
    key: str
    octets: bytes
    mimetype: str = TEXT_MIMETYPE
    encoding: int = TEXT
    creator: int = 0
    written: Time = (0, 0)
    user_time: Time = (0, 0)
    expires: Time = NEVER
    seqno: int = 0
    appends: int = 0
    deleted: bool = False

    @property
    def text(self) -> str:
        """The value as characters, up to the first NUL."""
        return self.octets.split(b"\0", 1)[0].decode("utf-8", "replace")

    @property
    def value(self) -> Union[str, bytes]:
        """Text as a string, anything else as octets."""
        return self.text if self.encoding == TEXT else self.octets

    def extended(self, added: bytes) -> bytes:
        """The octets with others appended, which replace the trailing NUL of text."""
        head = self.octets[:-1] if self.encoding == TEXT and self.octets else self.octets
        return head + added


def content(value: Value, mimetype: Optional[str] = None) -> Pair[bytes, str, int]:
    """Octets, MIME type and encoding of what a program sets. Strings and numbers are text, bytes are binary."""
    if isinstance(value, (int, float)):
        value = str(value)
    if isinstance(value, str):
        octets, kind, encoding = value.encode("utf-8", "surrogatepass") + b"\0", TEXT_MIMETYPE, TEXT
    elif isinstance(value, (bytes, bytearray, memoryview)):
        octets, kind, encoding = bytes(value), BINARY_MIMETYPE, BINARY
    else:
        raise BadValueError(f"a value is str, bytes, int or float, not {type(value).__name__}")
    if len(octets) > VALUE_MAX:
        raise BadValueError(f"a value of {len(octets)} octets; {VALUE_MAX} is the most")
    kind = mimetype if mimetype is not None else kind
    return octets, check_mimetype(kind), encoding


def mimetype_octets(mimetype: str) -> bytes:
    return mimetype.encode("utf-8", "surrogateescape")


def check_mimetype(x: str) -> str:
    """The MIME type itself, or BadValueError."""
    if not isinstance(x, str) or not 0 < len(x.encode("utf-8", "surrogatepass")) <= MIMETYPE_MAX or not x.isprintable():
        raise BadValueError(f"a MIME type has 1 to {MIMETYPE_MAX} printable octets")
    return x


@dataclass(frozen=True)
class Prototype:
    """Which tuples are wanted: owner -1, an empty key, wildcards and None match everything."""
    owner: int = EVERYBODY
    key: str = ""
    mimetype: Optional[str] = None
    octets: Optional[bytes] = None
    creator: int = _ANY
    encoding: int = _ANY
    written: Time = (_ANY, _ANY)
    user_time: Time = (_ANY, _ANY)
    expires: Time = (_ANY, _ANY)

    def names(self, x: Tuple) -> bool:
        """Owner and key alone."""
        return self.owner in (EVERYBODY, x.owner) and keys.matches(self.key, x.key)

    def matches(self, x: Tuple) -> bool:
        return (self.names(x) and self.creator in (_ANY, x.creator) and self.encoding in (_ANY, x.encoding) and
                self.mimetype in (None, x.mimetype) and _covers(self.written, x.written) and
                _covers(self.user_time, x.user_time) and _covers(self.expires, x.expires) and
                (self.octets is None or _equal(self.octets, x.octets)))


def _covers(wanted: Time, x: Time) -> bool:
    return all(w in (_ANY, given) for w, given in zip(wanted, x))


def _equal(a: bytes, b: bytes) -> bool:
    return len(a) == len(b) and a.split(b"\0", 1)[0].lower() == b.split(b"\0", 1)[0].lower()


def _low(time: Time) -> Time:
    """The lowest 32 bits of the seconds, signed."""
    return ((time[0] + 0x80000000) & 0xFFFFFFFF) - 0x80000000, time[1]


def _time(seconds: int, microseconds: int, known: float) -> Time:
    """0, 1 and -1 have their own meaning; else the time nearest to `known`."""
    return (seconds if seconds in (0, 1, -1) else unwrap(seconds & 0xFFFFFFFF, known)), microseconds


def encode_tuple(x: Tuple, push: bool) -> bytes:
    """The message of port 7 (push) or 10."""
    octets, mimetype = (x.octets, mimetype_octets(x.mimetype)) if x.octets else (b"\0", EMPTY_MIMETYPE.encode())
    return _tuple_record(x, push, len(mimetype), len(octets)) + mimetype + octets


def _tuple_record(x: Tuple, push: bool, mimetype: int, length: int) -> bytes:
    return RECORD.pack(x.owner, x.creator, *_low(x.written), *_low(x.user_time), *_low(x.expires), x.encoding,
                       mimetype, _IN_PUSH if push else _IN_SET, length, write_text(x.key, 128), 1, x.seqno, x.appends)


def _mimetype_length(x: dict) -> int:
    return 0 if x["mimetype"] == 255 else x["mimetype"]


def decode_tuple(octets: bytes, known: float) -> Tuple:
    """Of ports 7 and 10; `known`: network time in seconds since 1970."""
    x = RECORD.unpack(octets)
    head = RECORD.size + _mimetype_length(x)
    mimetype = octets[RECORD.size:head].decode("utf-8", "surrogateescape")
    key = keys.from_wire(read_text(x["key"]))
    wildcards = (x["user"], x["user_us"], x["expiry"], x["expiry_us"])
    if (x["owner"] <= 0 or x["creator"] <= 0 or _ANY in wildcards or x["encoding"] not in (TEXT, BINARY) or
            keys.is_pattern(key) or not mimetype or x["has_value"] == bytes(4) or len(octets) <= head):
        raise WireError("not a concrete tuple")
    value = b"" if mimetype == EMPTY_MIMETYPE else octets[head:]
    return Tuple(x["owner"], key, value, mimetype, x["encoding"], x["creator"],
                 _time(x["written"], x["written_us"], known), (x["user"], x["user_us"]),
                 _time(x["expiry"], x["expiry_us"], known), x["seqno"], x["appends"])


def deletion_of(x: Tuple) -> Tuple:
    """What is pushed or set to delete a tuple (15.4)."""
    return replace(x, octets=b"\0", expires=DELETED)


def _prototype_record(x: Prototype, mimetype: int) -> bytes:
    has = bytes(4) if x.octets is None else _IN_SET
    return RECORD.pack(x.owner, x.creator, *_low(x.written), *_low(x.user_time), *_low(x.expires), x.encoding,
                       mimetype, has, len(x.octets or b""), write_text(x.key, 128), -1, -1, -1)


def _read_prototype(octets: bytes, known: float) -> Pair[dict, Prototype]:
    x = RECORD.unpack(octets)
    if x["encoding"] not in (_ANY, TEXT, BINARY):
        raise WireError("bad encoding")
    return x, Prototype(x["owner"], keys.from_wire(read_text(x["key"])), None, None, x["creator"], x["encoding"],
                        _time(x["written"], x["written_us"], known), (x["user"], x["user_us"]),
                        _time(x["expiry"], x["expiry_us"], known))


class Subscribe(NamedTuple):
    """The message of port 5. lifetime: in seconds, None from other kernels; refresh: no values are wanted again."""
    wanted: Prototype
    lifetime: Optional[int] = None
    refresh: bool = False


def encode_subscribe(x: Subscribe) -> bytes:
    tag = b"\1\0\0\0" if x.lifetime is None else b"RL" + bytes((x.refresh, x.lifetime))
    mimetype = mimetype_octets(x.wanted.mimetype or "")
    return tag + _prototype_record(x.wanted, len(mimetype)) + mimetype + (x.wanted.octets or b"")


def decode_subscribe(octets: bytes, known: float) -> Subscribe:
    tag, body = octets[:4], octets[4:]
    x, wanted = _read_prototype(body, known)
    head = RECORD.size + _mimetype_length(x)
    if len(body) < head:
        raise WireError("truncated")
    mimetype = body[RECORD.size:head].decode("utf-8", "surrogateescape")
    wanted = replace(wanted, mimetype=mimetype or None, octets=body[head:] if x["has_value"] != bytes(4) else None)
    return Subscribe(wanted, tag[3], tag[2] != 0) if tag[:2] == b"RL" else Subscribe(wanted)


def encode_unsubscribe(owner: int, key: str) -> bytes:
    return _prototype_record(Prototype(owner, key), 255)


def decode_unsubscribe(octets: bytes) -> Pair[int, str]:
    x = RECORD.unpack(octets)
    return x["owner"], keys.from_wire(read_text(x["key"]))


def encode_append(wanted: Prototype, added: bytes) -> bytes:
    """The request of port 15."""
    return _prototype_record(wanted, 0) + len(added).to_bytes(4, "big") + (wanted.octets or b"") + added


def decode_append(octets: bytes, known: float) -> Pair[Prototype, bytes]:
    x, wanted = _read_prototype(octets, known)
    at = RECORD.size + 4
    value = octets[at:at + x["length"]]
    added = octets[at + x["length"]:]
    if len(octets) < at or len(value) != x["length"] or int.from_bytes(octets[at - 4:at], "big") != len(added):
        raise WireError("bad lengths")
    return replace(wanted, octets=value if x["has_value"] != bytes(4) else None), added


class Appended(NamedTuple):
    """The notice of port 16: the tuple before had `length` octets."""
    owner: int
    key: str
    seqno: int
    appends: int
    length: int
    added: bytes


def encode_appended(before: Tuple, added: bytes) -> bytes:
    record = _tuple_record(before, True, len(mimetype_octets(before.mimetype)), len(before.octets))
    return record + len(added).to_bytes(4, "big") + added


def decode_appended(octets: bytes) -> Appended:
    x = RECORD.unpack(octets)
    at = RECORD.size + 4
    key = keys.from_wire(read_text(x["key"]))
    if len(octets) < at or int.from_bytes(octets[at - 4:at], "big") != len(octets) - at:
        raise WireError("bad lengths")
    if x["owner"] <= 0 or keys.is_pattern(key):
        raise WireError("not a concrete tuple")
    return Appended(x["owner"], key, x["seqno"], x["appends"], x["length"], octets[at:])
