"""rubicon.Peer: a PEIS peer in a Python program."""
from __future__ import annotations

import atexit
import os
import random
import socket
import threading
import time
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any, Callable, Dict, Iterable, List, Optional, Union

from . import keys, meta, records, wire
from .arguments import Owner, check_id, check_name, check_owner, check_times, own_addresses, user_name
from .callbacks import CallbackQueue
from .errors import (BadValueError, ClosedError, NoSuchHostError, NoSuchTupleError, NotConnectedError, PeerError,
                     RefusedError, TimedOutError)
from .following import Follower
from .kernel import Kernel
from .loop import Loop, open_listener, parse_address
from .records import META_MIMETYPE, Prototype, Tuple, Value
from .wire import EVERYBODY, HostRecord, Port

TIMEOUT_S = 4.0
READINGS_MAX = 256  # subscriptions that reading has made
_NONE = object()

Callback = Callable[[Tuple], None]


@dataclass(frozen=True)
class Host:
    """Another peer of the network. hops: cost of the route to it; linked: there is a link to it."""
    id: int
    name: str
    host_name: str
    full_name: str
    hops: int
    linked: bool


class Subscription:
    """What Peer.subscribe() returns."""

    def __init__(self, peer: "Peer", numbers: List[int], pattern: str, owner: int) -> None:
        self._peer, self._numbers = peer, numbers
        self.pattern, self.owner = pattern, owner

    def cancel(self) -> None:
        """Ends the subscription. Calls that wait already are still made."""
        self._peer._cancel(self._numbers)  # pylint: disable=protected-access


class Peer:
    """A peer of a PEIS network: it has tuples of its own, and reads, writes and watches those of others.

        with Peer("robot", connect="tcp://127.0.0.1:8000") as robot:
            robot["position"] = "2 3"

    All methods may be called from any thread, callbacks included. Times are in seconds. An `owner` is the id of a peer
    or its name. Strings and numbers are sent as text, bytes as binary. What fails raises PeerError.
    """

    def __init__(self, name: str, connect: Union[str, Iterable[str]] = (), *, id: Optional[int] = None,
                 network: str = "rubicon", listen: Optional[str] = None, timeout: float = TIMEOUT_S,
                 callbacks: str = "thread") -> None:
        """Joins the network.

        name: of this program, 1 to 30 characters without `@`. connect: addresses such as `tcp://192.168.1.5:8000`, to
        which links are kept: they are tried again until close(). id: 1 to 65535, free in the whole network; a random
        high one if not given. network: the network string. listen: address at which links are accepted, port 0 for a
        free one. timeout: how long to wait for the first link to one of the addresses; 0 does not wait. callbacks:
        "thread" calls them on a thread of their own, "poll" in poll().
        """
        self.name = check_name(name)
        self.id = check_id(id) if id is not None else random.SystemRandom().randrange(32768, wire.ID_MAX + 1)
        if callbacks not in ("thread", "poll"):
            raise BadValueError('callbacks is "thread" or "poll"')
        if not isinstance(network, str) or len(network.encode("utf-8", "surrogatepass")) > 62 or "\0" in network:
            raise BadValueError("a network string has at most 62 octets")
        addresses = [parse_address(x, "connect") for x in ([connect] if isinstance(connect, str) else connect)]
        listener = open_listener(parse_address(listen, "listen")) if listen is not None else None
        self.port: Optional[int] = listener.getsockname()[1] if listener else None
        host_name = socket.gethostname()[:62] or "localhost"
        rng = random.Random(os.urandom(16))
        record = HostRecord(self.id, rng.randrange(1, 0x7FFFFFFF), host_name,
                            f"{name}@{host_name}!{os.getpid()}"[:62], own_addresses(listener), self.id)
        now = time.monotonic()
        self._kernel = Kernel(record, network, user_name(), time.time() - now, now, rng)
        self._changed = threading.Condition(threading.RLock())
        self._readings: "OrderedDict[Prototype, int]" = OrderedDict()
        self._closed = False
        self._callbacks = CallbackQueue(callbacks == "thread")
        self._loop = Loop(self._kernel, self._changed, addresses, listener)
        self._loop.thread.start()
        atexit.register(self.close)
        if addresses and timeout > 0:
            with self._changed:
                connected = self._wait(self._loop.is_up, timeout)
                why = self._loop.why_unconnected()
            if not connected:
                self.close()
                raise NotConnectedError(f"not connected within {timeout:g} s: {why}")

    def __enter__(self) -> "Peer":
        return self

    def __exit__(self, *_exception: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<rubicon.Peer {self.id} {self.name}{', closed' if self._closed else ''}>"

    def close(self) -> None:
        """Leaves the network: others learn it at once. Waits up to 2 s for what is still to be sent.

        The end of the program does it too, if it is not killed.
        """
        atexit.unregister(self.close)
        with self._changed:
            if not self._closed:
                self._closed = True
                self._kernel.overlay.leave()
                self._loop.stop()
        if threading.current_thread() is not self._loop.thread:
            self._loop.thread.join(5.0)
        self._callbacks.end()
        thread = self._callbacks.thread
        if thread is not None and threading.current_thread() is not thread:
            thread.join(1.0)

    # Who is there

    @property
    def connected(self) -> bool:
        """Is there a link to any peer?"""
        with self._changed:
            return self._loop.is_up()

    def hosts(self) -> List[Host]:
        """The other peers that can be reached, by id."""
        with self._changed:
            overlay = self._kernel.overlay
            found = []
            for id, host in sorted(overlay.hosts.items()):
                direct, route = overlay.neighbour_link(id), overlay.routes.get(id)
                if host.announced and host.lost is None:
                    hops = direct.cost if direct else route.hops if route else 0
                    record = host.record
                    found.append(Host(id, record.name, record.host_name, record.full_name, hops, direct is not None))
            return found

    def wait_for_host(self, owner: Owner, timeout: float = TIMEOUT_S) -> int:
        """Waits until a peer can be reached. Returns its id."""
        with self._changed:
            return self._wait_for_host(owner, time.monotonic() + timeout)

    def time(self) -> float:
        """The time on which the peers of the network agree, in seconds since 1970."""
        with self._changed:
            return self._kernel.overlay.clock.at(time.monotonic())

    def closed_links(self) -> List[str]:
        """The last links that have closed, and why."""
        with self._changed:
            return list(self._loop.closed)

    def counters(self) -> Dict[str, int]:
        """Numbers of what was dropped, and why: for the search for errors."""
        with self._changed:
            counted = dict(self._kernel.overlay.counters + self._kernel.space.counters)
            counted["subscribers_refused"] = self._kernel.space.feed.refused
            counted["callbacks_dropped"] = self._callbacks.dropped
            return counted

    # Reading

    def __getitem__(self, key: str) -> Union[str, bytes]:
        """The value of an own tuple."""
        with self._changed:
            x = self._kernel.space.own.get(keys.fold(keys.check(key)))
        if x is None:
            raise NoSuchTupleError(f"this peer has no tuple {key}")
        return x.value

    def __contains__(self, key: str) -> bool:
        """Is there such an own tuple?"""
        with self._changed:
            return keys.fold(keys.check(key)) in self._kernel.space.own

    def get(self, key: str, owner: Optional[Owner] = None, *, default: Any = _NONE,
            timeout: float = TIMEOUT_S) -> Any:
        """The value of a tuple: text as str, anything else as bytes.

        owner: whose; None means anybody's, an own tuple first. The first call subscribes to the tuple and waits up to
        timeout seconds; later calls return the newest value at once, and send nothing. If there is no such tuple:
        default, or an exception if none is given.
        """
        try:
            return self.get_tuple(key, owner, timeout=timeout).value
        except (NoSuchTupleError, NoSuchHostError, NotConnectedError):
            if default is _NONE:
                raise
            return default

    def get_tuple(self, key: str, owner: Optional[Owner] = None, *, timeout: float = TIMEOUT_S) -> Tuple:
        """As get(), with owner, times and MIME type."""
        keys.check(key, pattern=True)
        end = time.monotonic() + timeout
        with self._changed:
            self._check_open()
            id = EVERYBODY if owner is None else self._wait_for_host(owner, end)
            wanted = Prototype(id, key)
            self._read(wanted)
            found: List[Tuple] = []

            def arrived() -> bool:
                found[:] = self._kernel.space.find(wanted)
                return bool(found)

            if id == self.id:
                arrived()
            else:
                self._wait(arrived, end - time.monotonic())
            if found:
                return found[0]
            if id != self.id and not self._loop.is_up():
                raise NotConnectedError(f"not connected: {self._loop.why_unconnected()}")
            if id not in (EVERYBODY, self.id) and not self._kernel.overlay.is_reachable(id):
                raise NoSuchHostError(f"peer {id} has gone")
            whose = "nobody" if id == EVERYBODY else f"peer {id}"
            raise NoSuchTupleError(f"{whose} has a tuple {key}" if id == EVERYBODY else f"{whose} has no tuple {key}")

    def tuples(self, pattern: str = "", owner: Optional[Owner] = None, *, wait: float = 1.0) -> List[Tuple]:
        """All tuples that match, own ones included. Waits for `wait` seconds if nothing was subscribed to them yet."""
        keys.check(pattern, pattern=True)
        end = time.monotonic() + wait
        with self._changed:
            self._check_open()
            id = EVERYBODY if owner is None else self._wait_for_host(owner, end)
            wanted = Prototype(id, pattern)
            if self._read(wanted):
                self._wait(lambda: False, end - time.monotonic())
            return self._kernel.space.find(wanted)

    def _read(self, wanted: Prototype) -> bool:
        """Sees to it that a subscription brings what is wanted. True if it is a new one."""
        if wanted in self._readings:
            self._readings.move_to_end(wanted)
            return False
        space = self._kernel.space
        if wanted.owner == self.id or space.is_subscribed(wanted.owner, wanted.key):
            return False
        if len(self._readings) >= READINGS_MAX:
            space.unsubscribe(self._readings.popitem(last=False)[1])
        self._readings[wanted] = space.subscribe(wanted, lambda _: None, time.monotonic())
        self._go_on()
        return True

    # Writing

    def __setitem__(self, key: str, value: Value) -> None:
        """Sets an own tuple."""
        self.set(key, value)

    def __delitem__(self, key: str) -> None:
        """Deletes an own tuple."""
        self.delete(key)

    def set(self, key: str, value: Value, owner: Optional[Owner] = None, *, mimetype: Optional[str] = None,
            expires: Optional[float] = None, user_time: float = 0.0, timeout: float = TIMEOUT_S) -> None:
        """Sets a tuple, an own one or that of another owner.

        mimetype: text/plain for text and application/octet-stream for bytes if not given. expires: seconds from now
        after which it vanishes everywhere. user_time: free for the application, seconds since 1970. At another owner:
        returns when it has acknowledged the request, which does not mean that it has accepted the value.
        """
        keys.check(key)
        content = records.content(value, mimetype)
        check_times(expires, user_time)
        end = time.monotonic() + timeout
        with self._changed:
            id = self._writable(key, owner, end)
            now = time.monotonic()
            x = self._kernel.space.draft(id, key, content, expires, user_time, now)
            if id == self.id:
                self._kernel.space.set_own(x, now)
                self._go_on()
            else:
                self._request(id, Port.SET, records.encode_tuple(x, push=False), end)

    def append(self, key: str, value: Value, owner: Optional[Owner] = None, *, timeout: float = TIMEOUT_S) -> None:
        """Appends to a tuple. The outcome is that of set(); another owner without such a tuple does nothing."""
        keys.check(key)
        added = records.content(value)[0]
        end = time.monotonic() + timeout
        with self._changed:
            id = self._writable(key, owner, end)
            if id != self.id:
                self._request(id, Port.APPEND, records.encode_append(Prototype(id, key), added), end)
                return
            x = self._kernel.space.own.get(keys.fold(key))
            if x is None:
                raise NoSuchTupleError(f"this peer has no tuple {key}")
            self._kernel.space.append_own(x, added, time.monotonic())
            self._go_on()

    def delete(self, key: str, owner: Optional[Owner] = None, *, timeout: float = TIMEOUT_S) -> None:
        """Deletes a tuple. The outcome is that of set()."""
        keys.check(key)
        end = time.monotonic() + timeout
        with self._changed:
            id = self._writable(key, owner, end)
            now = time.monotonic()
            if id != self.id:
                x = self._kernel.space.draft(id, key, (b"\0", "text/plain", 0), None, 0.0, now)
                self._request(id, Port.SET, records.encode_tuple(records.deletion_of(x), push=False), end)
            elif not self._kernel.space.delete_own(key, now):
                raise NoSuchTupleError(f"this peer has no tuple {key}")
            else:
                self._go_on()

    def _writable(self, key: str, owner: Optional[Owner], end: float) -> int:
        """The owner's id, once it can be reached."""
        self._check_open()
        id = self.id if owner is None else self._wait_for_host(owner, end)
        host = self._kernel.overlay.hosts.get(id)
        if keys.is_reserved(key) and (id == self.id or (host and host.record.marked)) and \
                (id == self.id or keys.fold(key) != "kernel.do-quit"):
            raise RefusedError(f"{key} is written by the peer itself only")
        return id

    def _request(self, destination: int, port: int, message: bytes, end: float) -> None:
        outcome: List[str] = []
        self._kernel.send(destination, port, message, outcome.append)
        self._go_on()
        self._wait(lambda: bool(outcome), end - time.monotonic())
        if not outcome:
            raise TimedOutError(f"peer {destination} has not acknowledged the request in time")
        if outcome[0]:
            error = NotConnectedError if not self._loop.is_up() else PeerError
            raise error(f"the request has not reached peer {destination}: {outcome[0]}")

    # Watching

    def subscribe(self, pattern: str, callback: Callback, owner: Optional[Owner] = None, *,
                  mimetype: Optional[str] = None) -> Subscription:
        """Calls callback(tuple) with each value that matches, the present ones first.

        pattern: a key whose parts may be `*`, as in `devices.*.temperature`; empty: all. owner: whose tuples, None:
        anybody's, own ones included, also of peers that join later. mimetype: only tuples of this type. A deleted or
        expired tuple is passed once more with `deleted` set. If more than 4096 calls wait, the oldest are dropped.
        """
        keys.check(pattern, pattern=True)
        if mimetype is not None:
            records.check_mimetype(mimetype)
        with self._changed:
            self._check_open()
            id = self._owner_id(owner)
            number = self._kernel.space.subscribe(Prototype(id, pattern, mimetype),
                                                  lambda x: self._callbacks.add(callback, x), time.monotonic())
            self._go_on()
        return Subscription(self, [number], pattern, id)

    def poll(self, timeout: float = 0.0) -> int:
        """With callbacks="poll": runs what waits, or what arrives first within timeout seconds; returns how many."""
        return self._callbacks.poll(timeout)

    def _cancel(self, numbers: List[int]) -> None:
        with self._changed:
            for number in numbers:
                self._kernel.space.unsubscribe(number)
            numbers.clear()
            self._go_on()

    # Meta tuples

    def set_meta(self, key: str, target_owner: Optional[Owner], target_key: Optional[str] = None,
                 owner: Optional[Owner] = None, *, timeout: float = TIMEOUT_S) -> None:
        """Makes the meta tuple `key` of owner (None: this peer) refer to a tuple; target_owner None: to none."""
        reference = None
        if target_owner is not None:
            with self._changed:
                reference = meta.Reference(self._owner_id(target_owner), keys.check(target_key or ""))
        self.set(key, meta.format_reference(reference), owner, mimetype=META_MIMETYPE, timeout=timeout)

    def get_meta(self, key: str, owner: Optional[Owner] = None, *,
                 timeout: float = TIMEOUT_S) -> Optional[meta.Reference]:
        """Owner and key to which the meta tuple `key` of owner (None: this peer) refers; None if to none."""
        x = self.get_tuple(key, self.id if owner is None else owner, timeout=timeout)
        return meta.read_reference(x)

    def _target(self, key: str, owner: Optional[Owner], timeout: float) -> meta.Reference:
        target = self.get_meta(key, owner, timeout=timeout)
        if target is None:
            raise NoSuchTupleError(f"the meta tuple {key} refers to none")
        return target

    def get_through(self, key: str, owner: Optional[Owner] = None, *, timeout: float = TIMEOUT_S) -> Any:
        """The value of the tuple to which the meta tuple `key` of owner (None: this peer) refers."""
        end = time.monotonic() + timeout
        target = self._target(key, owner, timeout)
        return self.get(target.key, target.owner, timeout=max(0.0, end - time.monotonic()))

    def set_through(self, key: str, value: Value, owner: Optional[Owner] = None, *, mimetype: Optional[str] = None,
                    timeout: float = TIMEOUT_S) -> None:
        """Sets the tuple to which the meta tuple `key` of owner (None: this peer) refers."""
        end = time.monotonic() + timeout
        target = self._target(key, owner, timeout)
        self.set(target.key, value, target.owner, mimetype=mimetype, timeout=max(0.0, end - time.monotonic()))

    def subscribe_through(self, key: str, callback: Callback, owner: Optional[Owner] = None) -> Subscription:
        """As subscribe(), of the tuple to which a meta tuple refers, and of another one once it refers to that."""
        keys.check(key)
        with self._changed:
            self._check_open()
            id = self.id if owner is None else self._owner_id(owner)
            numbers: List[int] = []
            follower = Follower(self._kernel, lambda x: self._callbacks.add(callback, x), numbers)
            number = self._kernel.space.subscribe(Prototype(id, key), follower, time.monotonic())
            numbers.insert(0, number)
            self._go_on()
        return Subscription(self, numbers, key, id)

    # Within the lock

    def _check_open(self) -> None:
        if self._closed or self._loop.ended:
            raise ClosedError("the peer has been closed")

    def _go_on(self) -> None:
        self._kernel.settle(time.monotonic())
        self._loop.wake()

    def _wait(self, condition: Callable[[], bool], timeout: float) -> bool:
        end = time.monotonic() + timeout
        while not condition():
            left = end - time.monotonic()
            if left <= 0:
                return False
            if self._loop.ended:
                raise ClosedError("the peer has been closed")
            self._changed.wait(left)
        return True

    def _find_host(self, owner: Owner) -> Optional[int]:
        if isinstance(owner, int):
            return owner if owner == self.id or self._is_present(owner) else None
        if owner in (self.name, self._kernel.overlay.record.full_name):
            return self.id
        wanted = owner.lower()
        found = [id for id, host in self._kernel.overlay.hosts.items() if self._is_present(id) and wanted in (
            host.record.name.lower(), host.record.full_name.lower(), host.record.full_name.lower().split("!")[0])]
        if len(found) > 1:
            raise NoSuchHostError(f"several peers have the name {owner}: {', '.join(map(str, sorted(found)))}")
        return found[0] if found else None

    def _is_present(self, id: int) -> bool:
        host = self._kernel.overlay.hosts.get(id)
        return host is not None and host.announced and host.lost is None

    def _wait_for_host(self, owner: Owner, end: float) -> int:
        check_owner(owner)
        found: List[int] = []

        def is_there() -> bool:
            id = self._find_host(owner)
            found[:] = [] if id is None else [id]
            return bool(found)

        self._check_open()
        if self._wait(is_there, end - time.monotonic()):
            return found[0]
        if not self._loop.is_up():
            raise NotConnectedError(f"not connected: {self._loop.why_unconnected()}")
        raise NoSuchHostError(f"no peer {owner} can be reached")

    def _owner_id(self, owner: Optional[Owner]) -> int:
        """Without waiting: ids need not be there yet, names must."""
        if owner is None:
            return EVERYBODY
        if isinstance(owner, int):
            return check_id(owner)
        return self._wait_for_host(owner, time.monotonic() + TIMEOUT_S)
