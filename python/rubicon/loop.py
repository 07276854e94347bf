"""Sockets of a peer: one thread that connects, accepts, reads and writes."""
from __future__ import annotations

import errno
import fcntl
import logging
import os
import selectors
import socket
import struct
import termios
import threading
import time
from collections import deque
from typing import Deque, Dict, List, Optional, Tuple

from . import wire
from .errors import BadValueError, PeerError
from .kernel import Kernel

CONNECT_S = 3.0  # for an attempt
RETRY_S, RETRY_MAX_S = 0.5, 4.0  # between attempts
LEAVE_S = 2.0  # for what is queued at the end
READ_MAX = WRITE_MAX = 1 << 16
PACED_MAX = 20_000  # octets to a neighbour without the mark that its system has not acknowledged
PACED_S = 0.01  # between looks at these
PACKAGE_MAX = wire.HEADER.size + wire.DATA_MAX
ACCEPTED_MAX = 12

log = logging.getLogger("rubicon")

Address = Tuple[str, int]


def parse_address(text: str, what: str) -> Address:
    """`tcp://HOST:PORT`; HOST is resolved now."""
    rest = text[6:] if text.startswith("tcp://") else text
    host, colon, port = rest.rpartition(":")
    if "://" in rest or not colon or not host or not port.isdigit() or int(port) > 65535:
        raise BadValueError(f"{what}: {text!r} is no address such as tcp://127.0.0.1:8000")
    try:
        return socket.getaddrinfo(host, int(port), socket.AF_INET, socket.SOCK_STREAM)[0][4]
    except (OSError, UnicodeError) as error:
        raise BadValueError(f"{what}: {host}: {error}") from None


def format_address(x: Address) -> str:
    return f"{x[0]}:{x[1]}"


class _Standing:
    """An address to which a link is kept."""

    def __init__(self, address: Address) -> None:
        self.address = address
        self.link: Optional[int] = None
        self.next = 0.0
        self.wait = RETRY_S
        self.why = "no answer yet"


class _Connection:
    def __init__(self, sock: socket.socket, address: str, standing: Optional[_Standing], now: float) -> None:
        self.socket, self.address, self.standing = sock, address, standing
        self.until: Optional[float] = now + CONNECT_S if standing else None  # while it is being opened
        self.writing = standing is not None
        self.up = False
        self.paced = False
        self.paced_until: Optional[float] = None

    def is_full(self, now: float) -> bool:
        """Must a neighbour of another kind, which reads a package only when all of it is there, catch up first?"""
        if not self.paced:
            return False
        waiting, = struct.unpack("i", fcntl.ioctl(self.socket, termios.TIOCOUTQ, bytes(4)))
        full = waiting + PACKAGE_MAX > PACED_MAX
        self.paced_until = now + PACED_S if full else None
        return full


class Loop:
    """Runs a kernel. All but the selection itself happens under `lock`; `changed` is notified after each turn."""

    def __init__(self, kernel: Kernel, changed: threading.Condition, connect: List[Address],
                 listener: Optional[socket.socket]) -> None:
        self._kernel, self._changed = kernel, changed
        self._standing = [_Standing(address) for address in connect]
        self._connections: Dict[int, _Connection] = {}
        self._next_link = 1
        self._listener = listener
        self._selector = selectors.DefaultSelector()
        self._wake_out, self._wake_in = socket.socketpair()
        for end in (self._wake_out, self._wake_in):
            end.setblocking(False)
        self._selector.register(self._wake_out, selectors.EVENT_READ, 0)
        if listener is not None:
            listener.setblocking(False)
            self._selector.register(listener, selectors.EVENT_READ, -1)
        self.closed: Deque[str] = deque(maxlen=32)  # links, and why
        self._stop_at: Optional[float] = None
        self.thread = threading.Thread(target=self._run, name="rubicon-io", daemon=True)

    # From other threads

    def wake(self) -> None:
        if threading.current_thread() is not self.thread:
            try:
                self._wake_in.send(b"\0")
            except OSError:
                pass  # it is full, or the loop has ended

    def stop(self) -> None:
        """Under the lock. The thread ends when all is sent, or after LEAVE_S."""
        if self._stop_at is None:
            self._stop_at = time.monotonic() + LEAVE_S
        self.wake()

    def why_unconnected(self) -> str:
        if not self._standing:
            return "nobody has connected"
        return "; ".join(f"{format_address(x.address)}: {x.why}" for x in self._standing)

    def is_up(self) -> bool:
        return any(x.up for x in self._connections.values())

    # The thread

    def _run(self) -> None:
        try:
            while self._turn():
                pass
        except Exception:  # pylint: disable=broad-except
            log.exception("the peer ends")
        finally:
            with self._changed:
                self._stop_at = 0.0
                for number in list(self._connections):
                    self._close(number, "the peer has ended")
                for each in (self._listener, self._wake_out, self._wake_in, self._selector):
                    if each is not None:
                        each.close()
                self._changed.notify_all()

    @property
    def ended(self) -> bool:
        return not self.thread.is_alive()

    def _turn(self) -> bool:
        with self._changed:
            timeout = self._deadline() - time.monotonic()
        ready = self._selector.select(min(max(timeout, 0.0), 10.0))
        with self._changed:
            now = time.monotonic()
            for key, mask in ready:
                self._guard(key.data, mask, now)
            self._kernel.on_time(now)
            self._connect_due(now)
            self._take_notices()
            self._write_all(now)
            self._changed.notify_all()
            return self._stop_at is None or (now < self._stop_at and not self._kernel.overlay.is_idle())

    def _guard(self, number: int, mask: int, now: float) -> None:
        """Whatever happens with one socket, the others go on."""
        try:
            self._on_ready(number, mask, now)
        except Exception:  # pylint: disable=broad-except
            log.exception("link %d", number)
            if number > 0:
                self._lose(number, "internal error", now)

    def _deadline(self) -> float:
        now = time.monotonic()
        times = [self._kernel.deadline(now)]
        if self._stop_at is not None:
            return min(times + [now + PACED_S, self._stop_at])
        times += [x.next for x in self._standing if x.link is None]
        times += [t for x in self._connections.values() for t in (x.until, x.paced_until) if t is not None]
        return min(times)

    def _on_ready(self, number: int, mask: int, now: float) -> None:
        if number == 0:
            try:
                while self._wake_out.recv(4096):
                    pass
            except BlockingIOError:
                pass
        elif number == -1:
            self._accept(now)
        else:
            x = self._connections.get(number)
            if x is not None and x.until is not None:
                self._on_connected(number, x, now)
            elif x is not None and mask & selectors.EVENT_READ:
                self._read(number, x, now)

    def _add(self, x: _Connection) -> int:
        number = self._next_link
        self._next_link += 1
        self._connections[number] = x
        events = selectors.EVENT_READ | (selectors.EVENT_WRITE if x.writing else 0)
        self._selector.register(x.socket, events, number)
        return number

    def _accept(self, now: float) -> None:
        assert self._listener is not None
        try:
            sock, address = self._listener.accept()
        except OSError:
            return
        if sum(x.standing is None for x in self._connections.values()) >= ACCEPTED_MAX or self._stop_at is not None:
            self.closed.append(f"{format_address(address)}: too many links")
            sock.close()
            return
        self._prepare(sock)
        number = self._add(_Connection(sock, format_address(address), None, now))
        self._kernel.overlay.link_opened(number, False, format_address(address), now)

    @staticmethod
    def _prepare(sock: socket.socket) -> None:
        sock.setblocking(False)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _connect_due(self, now: float) -> None:
        for number, x in list(self._connections.items()):
            if x.until is not None and x.until <= now:
                self._lose(number, f"no answer within {CONNECT_S:.0f} s", now)
        for standing in self._standing:
            if standing.link is None and standing.next <= now and self._stop_at is None:
                self._connect(standing, now)

    def _connect(self, standing: _Standing, now: float) -> None:
        sock = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._prepare(sock)
        standing.link = self._add(_Connection(sock, format_address(standing.address), standing, now))
        error = sock.connect_ex(standing.address)
        if error not in (0, errno.EINPROGRESS):
            self._lose(standing.link, os.strerror(error), now)

    def _on_connected(self, number: int, x: _Connection, now: float) -> None:
        error = x.socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if error:
            self._lose(number, os.strerror(error), now)
            return
        x.until = None
        self._kernel.overlay.link_opened(number, True, x.address, now)

    def _read(self, number: int, x: _Connection, now: float) -> None:
        try:
            octets = x.socket.recv(READ_MAX)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            self._lose(number, error.strerror or str(error), now)
            return
        if octets:
            self._kernel.link_octets(number, octets, now)
        else:
            self._lose(number, "closed by the other end" + self._hint(x), now)

    def _hint(self, x: _Connection) -> str:
        rival = self._kernel.overlay.rival
        if rival is not None:
            name = "".join(c if c.isprintable() else "?" for c in rival.full_name)
            return f": its id is used by {name}"
        return "" if x.up else " before it accepted us: another network, a used id, or no room"

    def _lose(self, number: int, why: str, now: float) -> None:
        self._close(number, why)
        self._kernel.overlay.link_closed(number, now)
        self._kernel.settle(now)

    def _close(self, number: int, why: str) -> None:
        x = self._connections.pop(number, None)
        if x is None:
            return
        self.closed.append(f"{x.address}: {why}")
        log.info("link to %s closed: %s", x.address, why)
        self._selector.unregister(x.socket)
        x.socket.close()
        if x.standing is not None:
            x.standing.link, x.standing.why = None, why
            x.standing.wait = RETRY_S if x.up else min(1.5 * x.standing.wait, RETRY_MAX_S)
            x.standing.next = time.monotonic() + x.standing.wait

    def _take_notices(self) -> None:
        for notice in self._kernel.take_notices():
            x = self._connections.get(notice.link)
            if x is not None and notice.up:
                x.up, x.paced = True, not notice.marked
                log.info("link to %s is up", x.address)
            elif not notice.up:
                self._close(notice.link, notice.why)

    def _write_all(self, now: float) -> None:
        for number, x in list(self._connections.items()):
            if x.until is None:
                self._write(number, x, now)

    def _write(self, number: int, x: _Connection, now: float) -> None:
        link = self._kernel.overlay.links.get(number)
        if link is None:
            return
        full = False
        try:
            while link.waiting:
                full = x.is_full(now)
                if full:
                    break
                octets = link.take_output(1 if x.paced else WRITE_MAX)
                sent = x.socket.send(octets)
                if sent < len(octets):
                    link.give_back(octets[sent:])
                    break
        except (BlockingIOError, InterruptedError):
            link.give_back(octets)
        except OSError as error:
            self._lose(number, error.strerror or str(error), now)
            return
        self._want_to_write(number, x, link.waiting > 0 and not full)
        if not link.waiting:
            self._kernel.overlay.flush(now)
            if link.waiting:
                self._want_to_write(number, x, True)

    def _want_to_write(self, number: int, x: _Connection, wanted: bool) -> None:
        if wanted != x.writing:
            x.writing = wanted
            self._selector.modify(x.socket, selectors.EVENT_READ | (selectors.EVENT_WRITE if wanted else 0), number)


def open_listener(address: Address) -> socket.socket:
    """Raises PeerError."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind(address)
        sock.listen(16)
    except OSError as error:
        sock.close()
        raise PeerError(f"cannot listen at {format_address(address)}: {error.strerror}") from None
    return sock
