#!/usr/bin/env python3
"""Stands in for original PEIS kernels (generation G6) that subscribe to one tuple of a peer.

Written from the facts that docs/peis.md names: what it receives it looks at with MSG_PEEK until a
package is whole, in a loop of 10 ms; it acknowledges after 0.2 s or a hundred packages; it drops a
half-received message 10 s after its last fragment, which it knows by its group alone; it notices the
end of a link by an error, or by 30 s of silence; it tells its routes every 10 s.

    original.py --connect PORT --owner ID --key KEY [--id N] [--readers N] [--values N]
                [--receive-buffer N] [--loop-ms N] [--rounds N] [--seconds N]

Prints `subscribed ID` when its subscription was acknowledged, `value ID OCTETS SECONDS` for each value `NUMBER MONOTONIC_TIME ...` that has come whole,
`links ID N` at the end, and succeeds if each reader has got as many values as asked for.
"""
import argparse
import os
import random
import select
import socket
import struct
import sys
import time

SYNC = 0xFF00AA00
HEADER = struct.Struct(">IIIIhBBiihhhhhH")
LINK, BROADCAST, DIRECT = 0, 1, 2
ROUTING, TRACE, TRACE_REPLY, SUBSCRIBE, PUSH, HOST_RECORD, ACKNOWLEDGEMENTS = 0, 1, 2, 5, 7, 13, 14
RELIABLE, BULK = 1, 4
NEVER = float("inf")


def number():
    return random.randrange(4096, 0x7FFFFFFF)


def report(*words):
    """One write, since readers share the output."""
    sys.stdout.write(" ".join(str(x) for x in words) + "\n")
    sys.stdout.flush()


class Link:
    def __init__(self, connection, accepted):
        self.connection = connection
        self.request_due = accepted
        self.heard = time.monotonic()
        self.counter = 0
        self.out = b""


class Original:
    def __init__(self, options, number_of):
        self.options = options
        self.id = options.id + number_of
        self.magic = number()
        self.seqno = 0
        self.listener = socket.socket()
        self.listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, options.receive_buffer)
        self.listener.bind(("127.0.0.1", 0))
        self.listener.listen(2)
        self.listener.setblocking(False)
        self.links = []
        self.links_had = 0
        self.seen = {}
        self.parts = {}  # by group alone
        self.acks = []
        self.acks_since = NEVER
        self.values = {}
        self.subscribed = False
        self.ready = False
        self.next_routing = 0
        if options.connect:
            connection = socket.socket()
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, options.receive_buffer)
            connection.connect(("127.0.0.1", options.connect))
            self.begin(connection, False)

    def begin(self, connection, accepted):
        connection.setblocking(False)
        link = Link(connection, accepted)
        if not accepted:
            link.out += struct.pack(">iii64s", 500, self.id, 5, self.options.network.encode())
            self.greet(link)
        self.links.append(link)
        self.links_had += 1

    def greet(self, link):
        self.send(link, LINK, -1, HOST_RECORD, self.record() + bytes(8))
        self.tell_routes(link)

    def record(self):
        port = self.listener.getsockname()[1]
        name = b"standin%d" % self.id
        return (struct.pack(">ii64s64sB7x", self.id, self.magic, name, b"original@" + name, 1)
                + struct.pack("<8sB3xi", b"lo", 1, 0) + socket.inet_aton("127.0.0.1")
                + struct.pack(">i", port) + bytes(15 * 24) + bytes(8)
                + struct.pack(">ii", self.id, 0))

    def tell_routes(self, link):
        self.seqno += 1
        self.send(link, LINK, -1, ROUTING, struct.pack(">hhhHi", 0, 1, 1, 0, self.seqno)
                  + struct.pack(">iiiBB", self.id, self.seqno, self.magic, 0, len(self.links)))

    def send(self, link, kind, to, port, data, flags=0):
        own = number()
        link.out += HEADER.pack(SYNC, own, link.counter, number() if flags & RELIABLE else own, flags,
                                kind, 1, self.id, to, port, len(data), 0, 0, 0, 0) + data
        link.counter += 1

    def subscribe(self, link):
        key = self.options.key.encode()
        record = struct.pack(">9iB3xii28xii128sIII", self.options.owner, *[-1] * 8, 0, 0, 0,
                             key.count(b".") + 1, 0, key, 0xFFFFFFFF, 0, 0)
        self.send(link, DIRECT, self.options.owner, SUBSCRIBE, bytes(4) + record, RELIABLE)

    def close(self, link):
        link.connection.close()
        self.links.remove(link)

    def step(self):
        """@returns whether there was anything to do"""
        now = time.monotonic()
        try:
            self.begin(self.listener.accept()[0], True)
        except BlockingIOError:
            pass
        busy = False
        for _ in range(self.options.rounds):
            taken = [self.take(link, now) for link in list(self.links)]
            busy = busy or any(taken)
            if not any(taken):
                break
        self.parts = {k: x for k, x in self.parts.items() if x["last"] + 10 > now}
        self.tell(now)
        for link in list(self.links):
            self.write(link)
            if link.heard + 30 < now and link in self.links:
                self.close(link)
        return busy

    def tell(self, now):
        if now - self.acks_since >= 0.2:
            self.acknowledge()
        if now >= self.next_routing:
            self.next_routing = now + 10
            for link in self.links:
                if not link.request_due:
                    self.tell_routes(link)
        if not self.subscribed and self.links and now - self.links[0].heard < 1:
            self.subscribed = True
            self.subscribe(self.links[0])

    def acknowledge(self):
        if self.links:
            self.send(self.links[0], DIRECT, self.options.owner, ACKNOWLEDGEMENTS,
                      struct.pack(">i%dI" % len(self.acks), len(self.acks), *self.acks))
            self.acks, self.acks_since = [], NEVER

    def write(self, link):
        try:
            if link.out:
                link.out = link.out[link.connection.send(link.out):]
        except BlockingIOError:
            pass
        except OSError:
            self.close(link)

    def take(self, link, now):
        """Takes one package if it is there as a whole. The end of the stream is not noticed."""
        try:
            ahead = link.connection.recv(76 if link.request_due else 1064, socket.MSG_PEEK)
            if link.request_due:
                if len(ahead) < 76:
                    return False
                link.connection.recv(76)
                link.request_due = False
                self.greet(link)
                return True
            if len(ahead) < HEADER.size:
                return False
            header = HEADER.unpack(ahead[:HEADER.size])
            size = HEADER.size + header[10]
            if len(ahead) < size:
                return False
            link.connection.recv(size)
        except BlockingIOError:
            return False
        except OSError:
            if link in self.links:
                self.close(link)
            return False
        link.heard = now
        self.on_package(link, header, ahead[HEADER.size:size], now)
        return True

    def on_package(self, link, header, data, now):
        (_, own, _, ack, flags, kind, _, source, to, port, _, seqlen, seqid, seqnum, _) = header
        if self.saw(own):
            return
        if kind == DIRECT and to == self.id and flags & RELIABLE and port != ACKNOWLEDGEMENTS:
            self.acks.append(ack)
            self.acks_since = min(self.acks_since, now)
            if len(self.acks) == 100:
                self.acknowledge()
        if to == self.id and ack != own and self.saw(ack):
            return
        if to == self.id and port == ACKNOWLEDGEMENTS and not self.ready:
            self.ready = True  # its first acknowledgement is that of the subscription
            report("subscribed", self.id)
        if port == TRACE and to == self.id:
            hops = struct.unpack(">i", data[:4])[0]
            data = struct.pack(">i", hops + 1) + data[4:4 + 4 * hops] + struct.pack(">i", self.id) + data[8 + 4 * hops:]
            self.send(link, DIRECT, source, TRACE_REPLY, data)
        if port != PUSH or to != self.id:
            return
        if seqlen == 0:
            self.on_value(data, now)
            return
        part = self.parts.setdefault(seqid, {"all": {}, "last": now})
        part["all"][seqnum] = data
        part["last"] = now
        if len(part["all"]) == seqlen:
            del self.parts[seqid]
            self.on_value(b"".join(part["all"][i] for i in range(seqlen)), now)

    def saw(self, identity):
        if identity in self.seen:
            return True
        self.seen[identity] = True
        while len(self.seen) > 4096:
            del self.seen[next(iter(self.seen))]
        return False

    def on_value(self, message, now):
        value = message[224 + message[36]:]
        words = value[:60].split()
        if value[-1:] != b"\0" or len(words) < 2:
            report("broken", self.id, len(value))
            return
        delay = now - float(words[1])
        self.values[words[1]] = delay
        report("value", self.id, len(value), "%.3f" % delay)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--connect", type=int)
    parser.add_argument("--owner", type=int, required=True)
    parser.add_argument("--key", required=True)
    parser.add_argument("--network", default="default")
    parser.add_argument("--id", type=int, default=5001)
    parser.add_argument("--readers", type=int, default=1)
    parser.add_argument("--values", type=int, default=1)
    parser.add_argument("--receive-buffer", type=int, default=16384)
    parser.add_argument("--loop-ms", type=float, default=10)
    parser.add_argument("--rounds", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=60)
    options = parser.parse_args()
    processes = []
    for reader in range(options.readers):
        process = os.fork()
        if process == 0:
            random.seed(f"{reader} {options.key}")
            os._exit(run(Original(options, reader), options))
        processes.append(process)
    codes = [os.waitstatus_to_exitcode(os.waitpid(x, 0)[1]) for x in processes]
    return max(codes)


def run(original, options):
    end = time.monotonic() + options.seconds
    while time.monotonic() < end and len(original.values) < options.values:
        if not original.step() or options.rounds > 100:
            time.sleep(options.loop_ms / 1000)
    for _ in range(30):  # acknowledgements
        original.step()
        time.sleep(0.01)
    report("links", original.id, original.links_had)
    return 0 if len(original.values) >= options.values else 1


if __name__ == "__main__":
    sys.exit(main())
