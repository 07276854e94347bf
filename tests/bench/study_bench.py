#!/usr/bin/env python3
"""What studies cost, and whether what they say holds.

usage: bench_study [power] [loop] [kill] [same] [when] [export] [--binary FILE] [--keep FOLDER]

power   a sweep of 50 motes whose radios sleep, in five islands on one channel: 6 powers x 4 windows x 30 seeds, with its page
loop    a sweep against a loop of the shell that runs the same seeds one after another
kill    a sweep that SIGKILL ends at ten random moments, and is begun again, against one in peace
same    100 comparisons of this binary with itself
when    explain --when of 20 runs in which it is known what decided a violation, or is checked by other futures
export  the record of 1000 motes as trace events and as MCAP: time and memory

Without a name all of them. --keep: files of the study are left in this folder. Status 1: something was missed.
"""
import argparse
import json
import os
import random
import re
import resource
import shlex
import subprocess
import sys
import tempfile
import time

PARTS = ("power", "loop", "kill", "same", "when", "export")
missed = []


def figure(what, value, unit, digits=1, at_most=None, at_least=None):
    text = f"  {what:<52} {value:12.{digits}f} {unit:<6}"
    aim = at_most if at_most is not None else at_least
    if aim is not None:
        met = value <= aim if at_most is not None else value >= aim
        text += f"  aim {'<=' if at_most is not None else '>='} {aim:g}: {'met' if met else 'MISSED'}"
        if not met:
            missed.append(what)
    print(text, flush=True)


class Folder:
    """Where commands are run."""

    def __init__(self, binary, path):
        self.binary, self.path = binary, path

    def write(self, name, text):
        with open(os.path.join(self.path, name), "w", encoding="utf-8") as out:
            out.write(text)

    def run(self, *words, status=(0,), limit_s=None):
        """@returns what is printed, and the status; -9 of a run that had its time"""
        process = subprocess.Popen([self.binary, *words], cwd=self.path, text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.DEVNULL)
        try:
            out, _ = process.communicate(timeout=limit_s)
        except subprocess.TimeoutExpired:
            process.kill()
            out, _ = process.communicate()
        if process.returncode not in (*status, *(() if limit_s is None else (-9,))):
            missed.append(shlex.join(words))
            print(f"  rubicon {shlex.join(words)}: status {process.returncode}\n{out}", flush=True)
        return out, process.returncode


HEAD = """[ecology]
name = "field"
duration = "3min"
[parameters]
power = "0dBm"
window = "100ms"
[radio.propagation]
model = "log_distance"
shadowing = "3dB"
"""
ISLAND = """[[island]]
id = %d
name = "field-%d"
sink.position_m = [%d, %d]
sink.power = "${power}"
keep_alive = "30s"
duty_cycle = { period = "10s", window = "${window}" }
[[island.group]]
count = 10
layout = "grid"
columns = 5
spacing = "5m"
origin = [%d, %d]
power = "${power}"
type = 101
transducers.temperature = { model = "sine", mean = 20, amplitude = 3 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "10s" }]
"""
AIR = """[[air]]
name = "all"
islands = ["field-1", "field-2", "field-3", "field-4", "field-5"]
"""
PLACES = ((0, 0), (40, 0), (80, 0), (0, 40), (40, 40))
FIELD = HEAD + AIR + "".join(ISLAND % (i + 1, i + 1, x, y, x + 3, y + 3) for i, (x, y) in enumerate(PLACES))
POWERS = ("-25dBm", "-15dBm", "-10dBm", "-5dBm", "-3dBm", "0dBm")
WINDOWS = ("60ms", "100ms", "150ms", "200ms")


def power(at):
    at.write("field.toml", FIELD)
    begun = time.monotonic()
    out, _ = at.run("sweep", "field.toml", "--vary", "power=" + ",".join(POWERS), "--vary",
                    "window=" + ",".join(WINDOWS), "--seeds", "1..30", "--out", "power.db", "--report", "power.html",
                    "--csv", "--of", "messages.delivery", "--of", "motes.left", "--of", "radio.lost.collision")
    figure("720 runs of 50 sleeping motes, one command", time.monotonic() - begun, "s", at_most=120)
    means = {tuple(x[:3]): float(x[4]) for x in (line.split(",") for line in out.splitlines()[1:]) if x[4:5] and x[4]}
    for name in ("messages.delivery", "radio.lost.collision"):
        print(f"  {name}\n" + "".join(f"    {p:>7} " + " ".join(f"{means.get((p, w, name), float('nan')):10.3f}" for w in WINDOWS)
                                     + "\n" for p in POWERS), end="")


ROOM = """[ecology]
name = "room"
duration = "1min"
[parameters]
loss = 0.1
[radio]
loss = "${loss}"
[[island]]
id = 1
name = "room"
[[island.mote]]
id = 2
name = "meter"
type = 101
position_m = [5, 0]
transducers.temperature = { model = "sine", mean = 20, amplitude = 3 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "10s" }]
"""


def loop(at):
    at.write("field.toml", FIELD)
    begun = time.monotonic()
    at.run("sweep", "field.toml", "--seeds", "1..40", "--vary", "power=-5dBm,0dBm", "--out", "loop.db")
    swept_s = time.monotonic() - begun
    begun = time.monotonic()
    subprocess.run(f"for power in -5dBm 0dBm; do for seed in $(seq 1 40); do {shlex.quote(at.binary)} run field.toml "
                   "--set power=$power --seed $seed --json --log off > loop-$power-$seed.json || true; done; done",
                   shell=True, cwd=at.path, check=False, stderr=subprocess.DEVNULL)
    looped_s = time.monotonic() - begun
    figure("80 runs, sweep", swept_s, "s")
    figure("80 runs, loop of the shell", looped_s, "s")
    figure(f"ratio on {os.cpu_count()} cores", looped_s / swept_s, "", 2, at_least=0.9 * min(os.cpu_count(), 16))


def kill(at):
    at.write("room.toml", ROOM)
    words = ("sweep", "room.toml", "--vary", "loss=0,0.5", "--seeds", "1..30", "--csv", "--out")
    begun = time.monotonic()
    whole, _ = at.run(*words, "whole.db")
    took_s = time.monotonic() - begun
    draw = random.Random(1)
    killed = 0
    while killed < 10:
        limit_s = draw.uniform(0, took_s / 10)
        _, status = at.run(*words, "killed.db", limit_s=limit_s)
        if status != -9:
            break
        killed += 1
    resumed, _ = at.run(*words, "killed.db")
    figure("times killed before it was complete", killed, "", 0, at_least=10)
    figure("tables that differ from that of a sweep in peace", resumed != whole, "", 0, at_most=0)
    tables = [at.run("query", database, "SELECT p.name, p.value, r.seed, s.name, s.value FROM run r JOIN parameter p ON p.run = r.id "
                     "JOIN scalar s ON s.run = r.id WHERE s.name != 'wall_s' ORDER BY p.value, r.seed, s.name", "--csv")[0]
              for database in ("whole.db", "killed.db")]
    figure("databases that differ in any number of a run", tables[0] != tables[1] or not tables[0], "", 0, at_most=0)


def same(at):
    at.write("room.toml", ROOM)
    found = 0
    for i in range(100):
        _, status = at.run("compare", at.binary, at.binary, "--file", "room.toml", "--for", "20s", "--seeds",
                           f"{3 * i + 1}..{3 * i + 3}", status=(0, 1))
        found += status != 0
    figure("of 100 comparisons of a binary with itself, unequal", found, "", 0, at_most=0)


YARD = """[ecology]
name = "yard"
duration = "5min"
[radio]
range = "24m"
[[island]]
id = 1
name = "yard"
"""
MOTE = """[[island.mote]]
id = %d
name = "%s"
type = 101
position_m = [%s]
"""


def yard(more):
    return YARD + "".join(MOTE % each for each in ((2, "gate", "1, 3"), (3, "barn", "15, 5"), (4, "well", "30, 7"))) + more


def cases():
    """Name, file, words of the violation, and the time of what decided it, in seconds: None if chance does it step by step."""
    for at_s in (30, 45, 60, 90, 120):  # a battery of one of three, which is drawn then
        yield (f"a battery that is drawn at {at_s} s", yard(f'[[fault]]\nat = "{at_s}s"\nkind = "battery_end"\nmote = "*"\n'),
               "yard/well: left", at_s)
    for at_s in (20, 75, 130):  # no chance: from the start
        yield (f"a battery that ends at {at_s} s", yard(f'[[fault]]\nat = "{at_s}s"\nkind = "battery_end"\nmote = "yard/barn"\n'),
               "yard/well: left", 0)
    for at_s in (40, 100):  # which of two cables is drawn
        second = ('[[island]]\nid = 2\nname = "lane"\n' + MOTE % (2, "lamp", "5, 0") + '[[expect]]\nkind = "event_log"\n'
                  f'at_least = 0\nat_most = 0\ntext = "unplugged"\nwho = "lane"\n[[fault]]\nat = "{at_s}s"\nkind = "unplug"\n'
                  'island = "*"\nfor = "5s"\n')
        yield f"a cable that is drawn at {at_s} s", yard(second), "unplugged", at_s
    for loss in (0.5, 0.55, 0.6, 0.65, 0.7):  # a bad link
        text = ROOM.replace("loss = 0.1", f"loss = {loss}").replace('loss = "${loss}"', 'loss = "${loss}"\nretries = 0')
        yield (f"a link that loses {loss:.0%}", text.replace('"10s"', '"2s"') + '[[expect]]\nkind = "delivery"\nat_least = 0.9\n',
               "delivery", None)
    for at_s in (50, 110, 170):  # whose clock is set is drawn
        yield (f"a clock that is drawn at {at_s} s",
               yard(f'[[fault]]\nat = "{at_s}s"\nkind = "clock_step"\nmote = "*"\nby = "3s"\n[[expect]]\nkind = "clock"\n'
                    f'of = "yard/well"\nat_most = "1s"\nfrom = "{at_s - 10}s"\nevery = "10ms"\n'), "clock", at_s)
    for ppm in (40, 80):  # crystals, and when motes receive the time
        yield (f"crystals of {ppm} ppm", yard('[[expect]]\nkind = "clock"\nat_most = "1us"\n').replace(
            'name = "yard"\n[[island.mote]]', f'name = "yard"\ncrystal_ppm = {ppm}\n[[island.mote]]', 1), "clock", None)


def seed_with(at, words):
    """The first seed whose run has the violation."""
    for seed in range(1, 41):
        out, _ = at.run("run", "case.toml", "--seed", str(seed), "--json", "--log", "off", "--record", "case.rec",
                        status=(0, 1))
        if any(words in f"{x['invariant']}: {x['detail']}" for x in json.loads(out)["violations"]):
            return seed
    return None


def has(at, words, command):
    out, _ = at.run(*shlex.split(command)[1:], "--json", "--log", "off", status=(0, 1))
    return any(words in f"{x['invariant']}: {x['detail']}" for x in json.loads(out)["violations"])


def when(at):
    wrong = 0
    for name, text, words, decided_s in cases():
        at.write("case.toml", text)
        seed = seed_with(at, words)
        if seed is None:
            print(f"  {name}: no seed has it", flush=True)
            wrong += 1
            continue
        begun = time.monotonic()
        out, status = at.run("explain", "--when", "case.rec", words, "--json", "--within", "100ms")
        if status != 0:
            wrong += 1
            continue
        found = json.loads(out)
        certain_s, before = found["certain_from_s"], found["before"]
        problems = []
        if decided_s == 0 and certain_s != 0:
            problems.append("not from the start")
        if decided_s and not (certain_s is not None and decided_s <= certain_s <= decided_s + 0.1 and before["at_s"] < decided_s):
            problems.append(f"decided at {decided_s} s")
        if before and not before["with"] < before["of"]:
            problems.append("certain before")
        run = f"rubicon run case.toml --seed {seed} --reseed "
        if certain_s is not None:  # futures that were not asked
            kept = sum(has(at, words, f"{run}{round(certain_s * 1000)}ms:{key}") for key in range(101, 109))
            if kept < 7:
                problems.append(f"{kept} of 8 other futures have it")
        if found["other_future"] and has(at, words, found["other_future"]):
            problems.append("the future without it has it")
        wrong += bool(problems)
        share = "-" if before is None else f"{before['with']} of {before['of']} from {before['at_s']:.3f} s"
        print(f"  {name:<36} seed {seed:<3} certain from {certain_s} s, before {share}, {time.monotonic() - begun:.0f} s"
              f"{': WRONG: ' + ', '.join(problems) if problems else ''}", flush=True)
    figure("cases of 20 whose answer does not hold", wrong, "", 0, at_most=0)


THOUSAND = """[ecology]
name = "thousand"
duration = "2min"
[[island]]
id = 1
name = "field"
[[island.group]]
count = 1000
layout = "grid"
columns = 32
spacing = "8m"
type = 101
transducers.temperature = { model = "sine", mean = 20, amplitude = 3 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "1min" }]
"""


def export(at):
    at.write("thousand.toml", THOUSAND)
    at.run("run", "thousand.toml", "--record", "thousand.rec", "--brief", "--log", "off", status=(0, 1))
    size_mb = os.path.getsize(os.path.join(at.path, "thousand.rec")) / 1e6
    figure("record of 1000 motes, 2 min", size_mb, "MB")
    for words in ((), ("--perfetto", "thousand.json"), ("--mcap", "thousand.mcap")):
        begun = time.monotonic()
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        at.run("explain", "thousand.rec", *(words or ("--limit", "1")))
        what = words[0] if words else "explain alone"
        figure(f"{what}, time", time.monotonic() - begun, "s")
        figure(f"{what}, most memory so far",
               max(before, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss) / 1e3, "MB", 0)
        if words:
            figure(f"{words[1]}", os.path.getsize(os.path.join(at.path, words[1])) / 1e6, "MB")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("part", nargs="*", choices=[[], *PARTS])
    words.add_argument("--binary", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../rubicon"))
    words.add_argument("--keep")
    given = words.parse_args()
    parts = {"power": power, "loop": loop, "kill": kill, "same": same, "when": when, "export": export}
    with tempfile.TemporaryDirectory(prefix="rubicon-study-") as temporary:
        folder = given.keep or temporary
        os.makedirs(folder, exist_ok=True)
        at = Folder(os.path.abspath(given.binary), folder)
        for name in given.part or PARTS:
            print(name, flush=True)
            parts[name](at)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
