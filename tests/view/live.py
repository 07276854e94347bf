"""What the tests of the live page share: a run with a page, and a WebSocket to it."""
import base64
import json
import os
import re
import signal
import socket
import struct
import subprocess
import threading
import time
from urllib.parse import urlsplit

PATIENCE = 120  # seconds for anything: machines may be slow


class Run:
    """A rubicon process that serves a page; ends with the block."""

    def __init__(self, binary, *arguments):
        self.process = subprocess.Popen([binary, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.errors = []
        self.output = ""
        self._lines = threading.Condition()
        self._readers = [threading.Thread(target=self._read_errors), threading.Thread(target=self._read_output)]
        for each in self._readers:
            each.start()
        self.url = self.wait_for(r"page: (http://\S+/)").group(1)

    def _read_errors(self):
        for line in self.process.stderr:
            with self._lines:
                self.errors.append(line.rstrip("\n"))
                self._lines.notify_all()

    def _read_output(self):
        self.output = self.process.stdout.read()

    def wait_for(self, pattern):
        """The first line on standard error that matches."""
        end = time.monotonic() + PATIENCE
        seen = 0
        with self._lines:
            while True:
                for line in self.errors[seen:]:
                    found = re.search(pattern, line)
                    if found:
                        return found
                seen = len(self.errors)
                if self.process.poll() is not None and not self._readers[0].is_alive():
                    raise AssertionError(f"ended without `{pattern}`: {self.errors}")
                if time.monotonic() > end:
                    raise AssertionError(f"no `{pattern}` in time: {self.errors}")
                self._lines.wait(0.2)

    def end(self):
        """Ctrl-C. Returns the exit status."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            status = self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        for each in self._readers:
            each.join()
        return status

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()


class Socket:
    """A page's WebSocket, without a page."""

    def __init__(self, url, origin=None):
        where = urlsplit(url)
        self.socket = socket.create_connection((where.hostname, where.port), PATIENCE)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            (f"GET {where.path}live HTTP/1.1\r\nHost: {where.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
             f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
             f"Origin: {origin or 'http://' + where.netloc}\r\n\r\n").encode())
        self.octets = b""
        head = self._until(b"\r\n\r\n")
        self.status = int(head.split()[1])
        self.unasked = []
        self.asked = 0

    def _until(self, end):
        while end not in self.octets:
            more = self.socket.recv(65536)
            if not more:
                raise AssertionError(f"closed after {self.octets!r}")
            self.octets += more
        head, self.octets = self.octets.split(end, 1)
        return head

    def _exactly(self, count):
        while len(self.octets) < count:
            more = self.socket.recv(1 << 20)
            if not more:
                raise AssertionError("closed")
            self.octets += more
        some, self.octets = self.octets[:count], self.octets[count:]
        return some

    def read(self):
        """The next message, whatever it is; fragments put together."""
        text = b""
        while True:
            first, length = self._exactly(2)
            if length == 126:
                length, = struct.unpack(">H", self._exactly(2))
            elif length == 127:
                length, = struct.unpack(">Q", self._exactly(8))
            content = self._exactly(length)
            if first & 0x0f == 9:  # ping
                self._send(0x8a, content)
                continue
            if first & 0x0f == 8:
                raise AssertionError("closed")
            text += content
            if first & 0x80:
                return json.loads(text)

    def _send(self, first, content):
        size = len(content)
        head = bytes([first])
        if size < 126:
            head += bytes([0x80 | size])
        elif size < 65536:
            head += b"\xfe" + struct.pack(">H", size)
        else:
            head += b"\xff" + struct.pack(">Q", size)
        self.socket.sendall(head + bytes(4) + content)

    def ask(self, question, **more):
        """The answer; what comes unasked meanwhile is kept in `unasked`."""
        self.asked += 1
        self._send(0x81, json.dumps({"ask": question, "id": self.asked, **more}).encode())
        while True:
            message = self.read()
            if message.get("id") == self.asked:
                return message
            self.unasked.append(message)

    def next(self, kind, accept=lambda message: True):
        """The next unasked message of a kind."""
        while True:
            message = self.unasked.pop(0) if self.unasked else self.read()
            if message["kind"] == kind and accept(message):
                return message
