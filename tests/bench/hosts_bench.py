#!/usr/bin/env python3
"""What several hosts cost, each a process of this computer.

usage: bench_hosts [BINARY]

Two islands that send each other messages, in one process and on two hosts; 8 hosts of 1000 motes in wall time; the time
from `rubicon deploy` until all hosts run; the share of the cores that a swarm over 3 hosts keeps busy.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

TICKS = os.sysconf("SC_CLK_TCK")
PAGE = os.sysconf("SC_PAGESIZE")
missed = []


def figure(what, value, unit, digits=1, at_most=None, at_least=None):
    text = f"  {what:<44} {value:12.{digits}f} {unit:<8}"
    aim = at_most if at_most is not None else at_least
    if aim is not None:
        met = value <= aim if at_most is not None else value >= aim
        text += f"  aim {'<=' if at_most is not None else '>='} {aim:g}: {'met' if met else 'missed'}"
        if not met:
            missed.append(what)
    print(text, flush=True)


def children(root):
    """The processes `rubicon run` below a process: their processor time and memory."""
    found = {}
    parents, lines = {}, {}
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/stat") as file:
                fields = file.read().rsplit(")", 1)[1].split()
            with open(f"/proc/{pid}/cmdline", "rb") as file:
                words = file.read().split(b"\0")
            parents[int(pid)] = int(fields[1])
            lines[int(pid)] = (words, (int(fields[11]) + int(fields[12])) / TICKS, int(fields[21]) * PAGE / 1e6)
        except (OSError, IndexError):
            pass
    below = {root}
    for _ in range(4):
        below |= {pid for pid, parent in parents.items() if parent in below}
    for pid in below - {root}:
        words, cpu_s, mb = lines.get(pid, ([], 0, 0))
        if words[:2] == [b"rubicon", b"run"]:
            found[pid] = (cpu_s, mb)
    return found


def idle_s():
    with open("/proc/stat") as file:
        fields = file.readline().split()
    return int(fields[4]) / TICKS


def hosts_toml(names, port):
    return "".join(f'[[host]]\nname = "{name}"\naddress = "127.0.0.1"\ncontrol_port = {port + 10 * i}\n'
                   for i, name in enumerate(names))


def two_islands(apart):
    motes = "".join(
        f'[[island.mote]]\nid = {i}\nname = "m{i}"\ntype = 1\nposition_m = [{i % 4}, {1 + i // 4}]\n'
        f'apps = [{{ app = "messenger", to = "OTHER/m{i}", text = "hello", every = "200ms", reliable = true }}]\n'
        for i in range(2, 10))
    text = ('[ecology]\nname = "pair"\nmode = "wall"\nduration = "30s"\n[radio]\nrange = "20m"\n' +
            hosts_toml(["west", "east"], 5300))
    for number, (name, other) in enumerate([("west", "east"), ("east", "west")], 1):
        host = name if apart else "west"
        text += f'[[island]]\nid = {number}\nname = "{name}"\nhost = "{host}"\n' + motes.replace("OTHER", other)
    text += ('[[peer]]\nid = 50\nname = "near"\nhost = "west"\ntcp = { port = 5390 }\n'
             f'[[peer]]\nid = 51\nname = "far"\nhost = "{"east" if apart else "west"}"\n')
    return text


def crowd(hosts, islands, motes):
    text = ('[ecology]\nname = "crowd"\nmode = "wall"\nduration = "3min"\n[radio]\nrange = "30m"\n' +
            hosts_toml([f"h{i}" for i in range(hosts)], 5400) +
            '[mote_type.sensor]\ntype = 7\n'
            'transducers.temperature = { model = "constant", value = 20.0 }\n'
            'apps = [{ app = "sampler", transducers = ["temperature"], every = "1min", jitter = "30s" }]\n')
    number = 0
    for host in range(hosts):
        for _ in range(islands):
            number += 1
            text += f'[[island]]\nid = {number}\nname = "i{number}"\nhost = "h{host}"\n'
            for mote in range(2, 2 + motes):
                x, y = mote % 10, mote // 10
                text += (f'[[island.mote]]\nid = {mote}\nname = "m{mote}"\ntype = "sensor"\n'
                         f'position_m = [{3 * x}, {3 * y}]\n')
                if mote == 2:  # one of an island calls the next island, on the next host for the last of a host
                    following = number % (hosts * islands) + 1
                    text += (f'apps = [{{ app = "messenger", to = "i{following}/m3", text = "hello", every = "10s", '
                             'reliable = true }]\n')
    return text


class lab:
    def __init__(self, binary):
        self.binary = binary
        self.folder = tempfile.mkdtemp(prefix="rubicon-bench-")
        self.env = {**os.environ, "XDG_STATE_HOME": self.folder}

    def file(self, name, text):
        path = f"{self.folder}/{name}"
        with open(path, "w") as file:
            file.write(text)
        return path

    def start(self, *words):
        return subprocess.Popen([self.binary, *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=self.env,
                                text=True)

    def output(self, *words):
        return subprocess.run([self.binary, *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=self.env,
                              text=True).stdout


def measure_pair(at, apart):
    path = at.file("pair.toml", two_islands(apart))
    words = ["deploy", path, "--local"] if apart else ["run", path]
    whole = at.start(*words, "--json")
    time.sleep(8)
    ping = json.loads(at.output("ping", "51", "--count", "50", "--json", "--connect", "127.0.0.1:5390") or '{"ms": []}')
    report = json.loads(whole.communicate()[0])
    sent = sum(i["messages"]["reliable_sent"] for i in report["islands"])
    acked = sum(i["messages"]["reliable_acked"] for i in report["islands"])
    name = "two hosts" if apart else "one process"
    figure(f"{name}: acknowledged of all", 100.0 * acked / max(sent, 1), "%")
    figure(f"{name}: messages to the other island", acked / report["simulated_s"], "1/s")
    if ping["ms"]:
        figure(f"{name}: to the other gateway's peer and back", sorted(ping["ms"])[len(ping["ms"]) // 2], "ms", 3)
    return acked / report["simulated_s"]


def main():
    if any(word in ("-h", "--help") for word in sys.argv):
        sys.exit(__doc__)
    here = os.path.dirname(os.path.abspath(__file__))
    at = lab(os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else f"{here}/../../rubicon"))

    print("\npair: 16 motes, each a reliable message every 200 ms to the other island, 30 s")
    one = measure_pair(at, False)
    two = measure_pair(at, True)
    figure("two hosts carry, of one process", 100 * two / one, "%", at_least=95)

    print("\ncrowd: 8 hosts of 1000 motes in 10 islands, a reading a minute, 3 min in wall time")
    whole = at.start("deploy", at.file("crowd.toml", crowd(8, 10, 100)), "--local", "--json")
    begun, usage = time.monotonic(), {}
    while whole.poll() is None and time.monotonic() - begun < 175:
        usage = {**usage, **children(whole.pid)}
        time.sleep(1)
    report = json.loads(whole.communicate()[0])
    joined = sum(m["joined"] for i in report["islands"] for m in i["motes"])
    messages = [i["messages"] for i in report["islands"]]
    figure("motes joined", joined, "", 0, at_least=8000)
    figure("processor time of a host's process", max(x[0] for x in usage.values()) / 1.75, "% core")
    figure("memory of a host's process, at most", max(x[1] for x in usage.values()), "MB")
    figure("reliable messages", sum(m["reliable_sent"] for m in messages), "", 0)
    figure("of these told as failed", sum(m["reliable_failed"] for m in messages), "", 0)
    lost = sum(m["reliable_sent"] - m["reliable_acked"] - m["reliable_failed"] - m["reliable_open"] for m in messages)
    figure("and lost without a word", lost, "", 0, at_most=0)
    figure("violations", len(report["violations"]), "", 0, at_most=0)

    print("\nstart: 3 hosts that run already are told to begin")
    root = next(x for x in (here + "/../../../..", here + "/../..") if os.path.exists(f"{x}/config/house.toml"))
    house = open(f"{root}/config/house.toml").read()
    path = at.file("house.toml", re.sub(r"control_port = 42", "control_port = 55", house))
    hosts = [at.start("host", "--name", name, "--listen", f"127.0.0.1:{port}", "--state", at.folder)
             for name, port in (("kitchen", 5550), ("bedroom", 5560), ("care", 5570))]
    time.sleep(1)
    took = []
    for _ in range(5):
        begun = time.monotonic()
        whole = at.start("deploy", path, "--for", "4s")
        while len(children(hosts[0].pid)) + len(children(hosts[1].pid)) + len(children(hosts[2].pid)) < 3:
            time.sleep(0.01)
            if whole.poll() is not None:
                break
        took.append(time.monotonic() - begun)
        whole.communicate()
    figure("until all parts run, at most of 5", max(took), "s", 2, at_most=2)

    print("\nswarm: 300 seeds of config/home.toml, 10 min each, over these 3 hosts")
    names = ",".join(f"127.0.0.1:{port}" for port in (5550, 5560, 5570))
    words = ["swarm", f"{root}/config/home.toml", "--seeds", "1..300", "--for", "10min", "--json"]
    busy = {}
    for name, more in (("this computer alone", []), ("3 hosts", ["--hosts", names])):
        begun, idle = time.monotonic(), idle_s()
        result = json.loads(at.output(*words, *more))
        wall = time.monotonic() - begun
        busy[name] = 100 - 100 * (idle_s() - idle) / wall / os.cpu_count()
        figure(f"{name}: runs", result["runs"], "", 0, at_least=300)
        figure(f"{name}: time", wall, "s", 1)
    figure("3 hosts: cores busy", busy["3 hosts"], "%", 1, at_least=95)
    for each in hosts:
        each.terminate()
        each.wait()
    shutil.rmtree(at.folder)
    sys.exit(bool(missed))


main()
