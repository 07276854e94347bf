"""A mosquitto on loopback, and a client of MQTT 3.1.1 at quality of service 0, for tests.
usage: mqtt_tools.py sub|pub -p PORT -t TOPIC [-v] [-C COUNT] [-W SECONDS] [-m TEXT] [-r]   as mosquitto_sub and mosquitto_pub"""
import argparse
import os
import shutil
import socket
import ssl
import struct
import subprocess
import sys
import time

MOSQUITTO = shutil.which("mosquitto", path=os.environ.get("PATH", "") + ":/usr/sbin")


def free_port():
    with socket.socket() as x:
        x.bind(("127.0.0.1", 0))
        return x.getsockname()[1]


class Broker:
    """Ends with its `with` block, by its process id."""

    def __init__(self, folder, options="allow_anonymous true\n", port=None):
        self.port, self.process = port or free_port(), None
        self.config = f"{folder}/mosquitto-{self.port}.conf"
        user = "user root\n" if os.geteuid() == 0 else ""  # or it could not read the folder's files
        with open(self.config, "w", encoding="utf-8") as file:
            file.write(f"{user}listener {self.port} 127.0.0.1\n{options}")

    def __enter__(self):
        self.begin()
        return self

    def __exit__(self, *_):
        self.end()

    def begin(self):
        self.process = subprocess.Popen([MOSQUITTO, "-c", self.config], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(200):
            try:
                socket.create_connection(("127.0.0.1", self.port)).close()
                return
            except OSError:
                time.sleep(0.05)
        sys.exit("mosquitto does not listen")

    def end(self):
        if self.process:
            self.process.kill()
            self.process.wait()
        self.process = None


def text_of(x):
    octets = x if isinstance(x, bytes) else x.encode()
    return struct.pack(">H", len(octets)) + octets


def packet(kind, body):
    rest, length = len(body), b""
    while True:
        rest, digit = rest >> 7, rest & 127
        length += bytes([digit | (128 if rest else 0)])
        if not rest:
            return bytes([kind]) + length + body


class Client:
    def __init__(self, port, name="test", user=None, password=None, authority=None):
        self.socket = socket.create_connection(("127.0.0.1", port), 10)
        if authority:
            self.socket = ssl.create_default_context(cafile=authority).wrap_socket(self.socket, server_hostname="127.0.0.1")
        self.octets, self.seen = b"", {}
        login = text_of(user) + text_of(password) if user else b""
        self.socket.sendall(packet(0x10, text_of("MQTT") + bytes([4, 0xC2 if user else 2, 0, 0]) + text_of(name) + login))
        assert self.next(10)[1][1] == 0, "the broker refuses the test's client"

    def next(self, wait):
        """The next packet; None if there is none in time."""
        end = time.monotonic() + wait
        while True:
            if found := self.whole():
                return found
            self.socket.settimeout(max(0.01, end - time.monotonic()))
            try:
                more = self.socket.recv(65536)
            except (TimeoutError, ssl.SSLWantReadError):
                more = None
            if more == b"":
                raise ConnectionError("the broker has closed the connection")
            self.octets += more or b""
            if more is None and time.monotonic() >= end:
                return None

    def whole(self):
        length, at = 0, 1
        while True:
            if at >= len(self.octets):
                return None
            length |= (self.octets[at] & 127) << 7 * (at - 1)
            at += 1
            if self.octets[at - 1] < 128:
                break
        if len(self.octets) < at + length:
            return None
        found = self.octets[0], self.octets[at:at + length]
        self.octets = self.octets[at + length:]
        return found

    def subscribe(self, topic):
        self.socket.sendall(packet(0x82, b"\0\1" + text_of(topic) + b"\0"))

    def publish(self, topic, payload=b"", retain=False):
        self.socket.settimeout(60)
        self.socket.sendall(packet(0x31 if retain else 0x30, text_of(topic) + (payload if isinstance(payload, bytes) else payload.encode())))

    def message(self, wait):
        """Topic and payload of the next message; None if there is none in time."""
        end = time.monotonic() + wait
        while found := self.next(max(0, end - time.monotonic())):
            if found[0] >> 4 == 3:
                length = struct.unpack(">H", found[1][:2])[0]
                topic = found[1][2:2 + length].decode()
                self.seen[topic] = payload = found[1][2 + length:].decode()
                return topic, payload
        return None

    def until(self, topic, part="", wait=20):
        """Waits until the newest payload of that topic contains the part; exits if none comes."""
        if not self.comes(topic, part, wait):
            sys.exit(f"{topic} has not come with `{part}`")

    def comes(self, topic, part, wait):
        """The same, but returns whether one has come."""
        end = time.monotonic() + wait
        if topic in self.seen and part in self.seen[topic]:
            return True
        while found := self.message(max(0, end - time.monotonic())):
            if found[0] == topic and part in found[1]:
                return True
        return False

    def end(self):
        self.socket.close()


def main():
    options = argparse.ArgumentParser()
    options.add_argument("what", choices=("sub", "pub"))
    options.add_argument("-p", type=int, required=True)
    options.add_argument("-t", required=True)
    options.add_argument("-v", action="store_true")
    options.add_argument("-r", action="store_true")
    options.add_argument("-C", type=int, default=1 << 30)
    options.add_argument("-W", type=float, default=20)
    options.add_argument("-m", default="")
    x = options.parse_args()
    client = Client(x.p, f"{x.what}-{os.getpid()}")
    if x.what == "pub":
        client.publish(x.t, x.m, x.r)
        client.end()
        return
    client.subscribe(x.t)
    end = time.monotonic() + x.W
    count = 0
    while count < x.C and (found := client.message(max(0, end - time.monotonic()))):
        print(f"{found[0]} {found[1]}" if x.v else found[1], flush=True)
        count += 1


if __name__ == "__main__":
    main()
