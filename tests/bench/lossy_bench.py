#!/usr/bin/env python3
"""What links over TCP and over UDP carry between two peers: on loopback, and through a network that loses.

The lossy network is two network namespaces with a TUN device each; this program passes their IP packets on,
after a delay, and drops a share of them drawn by a seeded generator. TCP and UDP go the same way.
usage: lossy_bench.py PEIS_BENCH_PEER [--check] [--seconds S]
--check: only what a test needs, with expectations; exits with 77 where there are no namespaces or TUN devices.
"""
import argparse
import ctypes
import fcntl
import heapq
import os
import random
import select
import signal
import struct
import subprocess
import sys
import time

CLONE_NEWNET = 0x40000000
TUNSETIFF = 0x400454CA
IFF_TUN_NO_PI = 0x1001
ADDRESSES = ("10.77.0.1", "10.77.0.2")
QUEUE_MAX = 2000  # packets under way in one direction


class Unavailable(Exception):
    """This machine cannot make such a network."""


def run_quietly(*words):
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Unavailable(f"{' '.join(words)}: {done.stderr.strip()}")


def new_end(own, other):
    """A namespace of its own for this process and what it starts from now on, and the device in it."""
    if ctypes.CDLL(None, use_errno=True).unshare(CLONE_NEWNET) != 0:
        raise Unavailable(f"unshare: {os.strerror(ctypes.get_errno())}")
    try:
        device = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        fcntl.ioctl(device, TUNSETIFF, struct.pack("16sH22x", b"lossy", IFF_TUN_NO_PI))
    except OSError as error:
        raise Unavailable(f"/dev/net/tun: {error}") from error
    run_quietly("ip", "link", "set", "lo", "up")
    run_quietly("ip", "address", "add", own, "peer", other, "dev", "lossy")
    run_quietly("ip", "link", "set", "lossy", "up", "txqueuelen", "1000")
    return device


class Peer:
    """A process of peis_bench_peer."""

    def __init__(self, program, number, *options):
        self.process = subprocess.Popen(
            [program, "--peis-id", str(number), "--peis-hostname", f"host{number}", "--peis-network", "lossy",
             "--peis-port", "8400", *options],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        os.set_blocking(self.process.stdout.fileno(), False)
        self.rest = b""
        self.events = []

    def send(self, line):
        self.process.stdin.write(line.encode() + b"\n")
        self.process.stdin.flush()

    def read(self):
        piece = self.process.stdout.read() or b""
        *lines, self.rest = (self.rest + piece).split(b"\n")
        self.events += [line.decode().split()[2:] for line in lines if line.startswith(b"@")]

    def end(self):
        self.process.kill()
        self.process.wait()


class Network:
    """Passes packets between the two devices; without devices there is nothing to pass."""

    def __init__(self, devices, loss, delay_s, seed=1):
        self.devices = devices
        self.loss = loss
        self.delay_s = delay_s
        self.dice = random.Random(seed)
        self.under_way = []
        self.number = 0
        self.counts = [0, 0]

    def turn(self, files, until):
        now = time.monotonic()
        while self.under_way and self.under_way[0][0] <= now:
            _, _, to, packet = heapq.heappop(self.under_way)
            self.counts[to] -= 1
            try:
                os.write(self.devices[to], packet)
            except OSError:
                pass  # its queue is full: lost
        due = min(until, self.under_way[0][0] if self.under_way else until)
        ready, _, _ = select.select([*self.devices, *files], [], [], max(0, min(0.05, due - now)))
        for end, device in enumerate(self.devices):
            if device in ready:
                self.take(end)

    def take(self, end):
        now = time.monotonic()
        for _ in range(64):
            try:
                packet = os.read(self.devices[end], 4096)
            except BlockingIOError:
                return
            if self.dice.random() < self.loss or self.counts[1 - end] >= QUEUE_MAX:
                continue
            self.number += 1
            self.counts[1 - end] += 1
            heapq.heappush(self.under_way, (now + self.delay_s, self.number, 1 - end, packet))


class Pair:
    """Publisher 100 and subscriber 101 with one link, and the network between them."""

    def __init__(self, program, medium, devices, namespaces, loss, delay_s):
        self.network = Network(devices, loss, delay_s)
        own = ADDRESSES if devices else ("127.0.0.1", "127.0.0.1")
        more = ["--udp"] if medium == "udp" else []
        self.peers = []
        enter(namespaces[0])
        self.peers.append(Peer(program, 100, "--address", own[0], *more))
        port = self.value(0, "READY", "udp" if medium == "udp" else "port")
        enter(namespaces[1])
        self.peers.append(Peer(program, 101, "--address", own[1], "--peis-connect",
                               f"{medium}://{own[0]}:{port}", *more))
        self.peers[1].send("monitor")
        self.until(lambda: any(x[0] == "MON" and x[4] == "1" for x in self.peers[1].events), 20)

    def until(self, done, seconds):
        end = time.monotonic() + seconds
        while not done():
            if time.monotonic() > end:
                raise RuntimeError("it takes too long")
            self.network.turn([x.process.stdout for x in self.peers], end)
            for peer in self.peers:
                peer.read()

    def wait(self, seconds):
        end = time.monotonic() + seconds
        self.until(lambda: time.monotonic() >= end, seconds + 1)

    def value(self, peer, event, label, seconds=20):
        """What stands behind the label in the next such event."""
        events = self.peers[peer].events

        def found():
            return next((x for x in events if x[0] == event), None)

        self.until(found, seconds)
        words = found()
        return words[words.index(label) + 1]

    def flow(self, size, rate, seconds):
        """MB/s, and percentiles of how old values were when they came."""
        key = f"flow{size}"
        self.peers[1].send(f"watch 100 {key}")
        self.wait(1)
        self.peers[0].send(f"flood {key} {size} {int(rate * (seconds + 2))} {rate}")
        self.wait(1)
        self.peers[1].send("reset")
        self.wait(seconds)
        self.peers[1].events.clear()
        self.peers[1].send("stats")
        words = {}
        self.value(1, "STATS", "n")
        stats = next(x for x in self.peers[1].events if x[0] == "STATS")
        for label, word in zip(stats[1::2], stats[2::2]):
            words[label] = float(word)
        return words["bytes"] / seconds / 1e6, words

    def end(self):
        for peer in self.peers:
            peer.end()


def enter(namespace):
    if namespace is not None:
        ctypes.CDLL(None, use_errno=True).setns(namespace, CLONE_NEWNET)


def use(control, namespaces):
    """TCP's congestion control, of those that this system has. Debian's default is cubic."""
    for namespace, own, other in zip(namespaces, ADDRESSES, reversed(ADDRESSES)):
        enter(namespace)
        done = subprocess.run(["ip", "route", "replace", other, "dev", "lossy", "src", own, "congctl", control],
                              capture_output=True, check=False)
        if done.returncode != 0:
            return False
    return True


def measure(program, devices, namespaces, loss, delay_s, seconds, loads):
    """Prints, and returns for each medium (MB/s, figures of ages) of each load."""
    results = {}
    for medium, control in (("tcp", "cubic"), ("tcp", "bbr"), ("udp", "")) if devices else (("tcp", ""), ("udp", "")):
        if control and not use(control, namespaces):
            continue
        name = medium + (" " + control if control else "")
        pair = Pair(program, medium, devices, namespaces, loss, delay_s)
        try:
            results[name] = []
            for size, rate in loads:
                mb_per_s, stats = pair.flow(size, rate, seconds)
                results[name].append((mb_per_s, stats))
                print(f"  {name:9} {size:7d} B x {rate:5d}/s: {mb_per_s:8.3f} MB/s, {stats['n'] / seconds:8.1f} values/s, "
                      f"age p50 {stats['p50']:9.3f} p95 {stats['p95']:9.3f} p99 {stats['p99']:9.3f} max "
                      f"{stats['max']:9.3f} ms", flush=True)
                pair.wait(1)
        finally:
            pair.end()
    return results


def make_lossy():
    home = os.open("/proc/self/ns/net", os.O_RDONLY)
    devices, namespaces = [], []
    for own, other in zip(ADDRESSES, reversed(ADDRESSES)):
        devices.append(new_end(own, other))
        namespaces.append(os.open("/proc/self/ns/net", os.O_RDONLY))
    enter(home)
    return devices, namespaces


def check(program, seconds):
    loads = [(10240, 400), (64, 100)]
    devices, namespaces = make_lossy()
    print("a network of 20 ms there and back that loses 5 %:")
    lossy = measure(program, devices, namespaces, 0.05, 0.01, seconds, loads)
    if "tcp cubic" not in lossy:
        raise Unavailable("TCP has no cubic")
    (tcp_bulk, _), _ = lossy["tcp cubic"]
    (udp_bulk, _), (_, udp_small) = lossy["udp"]
    wrong = []
    if udp_bulk < 3:
        wrong.append(f"{udp_bulk:.3f} MB/s over UDP, of 4.1 that are written")
    if udp_bulk < 1.5 * tcp_bulk:
        wrong.append(f"{udp_bulk:.3f} MB/s over UDP are not half as much again as {tcp_bulk:.3f} over TCP with cubic")
    if udp_small["n"] < 0.9 * 100 * seconds:
        wrong.append(f"{udp_small['n']:.0f} small values over UDP, of {100 * seconds:.0f}")
    for line in wrong:
        print(line)
    return 1 if wrong else 0


def bench(program, seconds):
    loads = [(64, 1000), (1024, 5000), (102400, 5000)]
    print("loopback:")
    measure(program, [], [None, None], 0, 0, seconds, loads)
    devices, namespaces = make_lossy()
    loads = [(64, 100), (10240, 1000)]
    for loss in (0, 0.01, 0.05, 0.2):
        print(f"a network of 20 ms there and back that loses {loss:.0%}:")
        measure(program, devices, namespaces, loss, 0.01, seconds, loads)
    return 0


def main():
    options = argparse.ArgumentParser()
    options.add_argument("program")
    options.add_argument("--check", action="store_true")
    options.add_argument("--seconds", type=float, default=8)
    x = options.parse_args()
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    program = os.path.abspath(x.program)
    try:
        return check(program, x.seconds) if x.check else bench(program, x.seconds)
    except Unavailable as why:
        print(f"skipped: no lossy network can be made here: {why}")
        return 77


if __name__ == "__main__":
    sys.exit(main())
