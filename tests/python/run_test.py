#!/usr/bin/env python3
"""Runs that Python steers.
usage: run_test RUBICON"""
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import unittest

import support

from rubicon import RequestError, Run, RunError, map_runs, to_toml

RUBICON = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
HOME = str(support.ROOT / "share/templates/home.toml")
KILLS = int(os.environ.get("RUBICON_KILLS", "6"))


def start(**more):
    return Run(HOME, binary=RUBICON, **more)


def hash_of(*words):
    done = subprocess.run([RUBICON, "run", HOME, "--json", *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          timeout=120)
    return json.loads(done.stdout)["trace_hash"]


def is_running(pid):
    try:
        return "rubicon" in pathlib.Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return False


class StepTest(unittest.TestCase):
    def test_time_goes_on_as_requested_and_changes_nothing(self):
        with start(length=60) as run:
            self.assertEqual(run.now, 0)
            self.assertEqual(run.step(0.1).now, 0.1)
            for _ in range(50):
                run.step(0.1)
            self.assertTrue(run.motes()["kitchen/stove"]["alive"])
            self.assertEqual(run.step(until=30).now, 30)
            self.assertTrue(run.step(until=100).over)
            self.assertEqual(run.finish()["trace_hash"], hash_of("--for", "60s"))

    def test_tuples_and_events_are_read(self):
        with start(length=120) as run:
            run.subscribe("kitchen.*.temperature")
            run.subscribe_events()
            step = run.step(until=lambda x: x.get("kitchen-pc", "kitchen.stove.temperature"), limit=60)
            self.assertFalse(step.over)
            self.assertTrue(any(x.key == "kitchen.stove.temperature" for x in step.tuples))
            self.assertTrue(step.events)
            run.set("care-pc", "note", "milk")
            run.step(1)
            self.assertEqual(run.get("care-pc", "note"), "milk")
            answers = run.batch([{"do": "get", "peer": "care-pc", "key": "note"}] * 1000)
            self.assertEqual({x["value"] for x in answers}, {"milk"})

    def test_what_was_done_is_done_again_without_python(self):
        with start(length=60) as run, tempfile.TemporaryDirectory() as folder:
            run.step(10)
            run.fault("crash mote kitchen/stove for 5s")
            run.step(10.123456789)
            run.set("care-pc", "note", "milk")
            run.fault("rate mote kitchen/window period 2s")
            lines = os.path.join(folder, "lines")
            with open(lines, "w", encoding="utf-8") as out:
                out.write(run.record())
            self.assertEqual(run.finish()["trace_hash"], hash_of("--for", "60s", "--steer", lines))

    def steered_and_planned(self, *words):
        """Reports of a run in which this is done, one after the other, and of its file with the tables."""
        with start(length=60) as run, tempfile.TemporaryDirectory() as folder:
            run.fault(words[0])
            run.step(10.123456789)
            for each in words[1:]:
                run.fault(each)
            file = pathlib.Path(folder, "home.toml")
            file.write_text(pathlib.Path(HOME).read_text() + run.to_toml_tables())
            self.assertIn('at = "10.12345679s"', file.read_text())
            steered = run.finish()
            with Run(file, binary=RUBICON, length=60) as planned:
                reports = steered, planned.finish()
        for report in reports:
            for name in ("wall_s", "expectations", "violations"):  # with the name of the file
                del report[name]
            report["event_log"] = [(x["at_s"], x["who"], x["what"].replace("by hand", "as planned"))
                                   for x in report["event_log"]]
        return reports

    def test_what_was_done_is_done_again_by_tables_of_a_file(self):
        crash, kill = "crash mote kitchen/stove for 5s", "kill peer care-pc for 5s"
        rate = "rate mote kitchen/window period 2s"
        steered, planned = self.steered_and_planned("crash mote kitchen/window", crash, kill, rate)
        self.assertEqual(steered, planned)
        steered, planned = self.steered_and_planned(rate, crash, kill)
        self.assertNotEqual(steered.pop("trace_hash"), planned.pop("trace_hash"))  # a file numbers its faults first
        self.assertEqual(steered, planned)

    def test_tables_say_what_no_file_plans(self):
        with start(length=60) as run:
            run.step(10)
            run.set("kitchen-pc", "note", "milk\n[[fault]]")
            self.assertEqual(run.to_toml_tables(), '\n# 10s: no file plans {"do":"set","peer":"kitchen-pc","key":"note",'
                                                   '"value":"milk\\n[[fault]]"}\n')

    def test_a_mote_sends_as_its_programs_do(self):
        more = 'channel = 2 }, { app = "listener", am_type = 77 }]'
        ecology = pathlib.Path(HOME).read_text().replace("channel = 2 }]", more)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "home.toml")
            file.write_text(ecology)
            with Run(file, binary=RUBICON, length=60) as run:
                with self.assertRaisesRegex(RequestError, "has not joined"):
                    run.send("kitchen/stove", "kitchen/fan", b"early")
                run.subscribe_events()
                run.step(30)
                self.assertEqual(run.send("kitchen/stove", "kitchen/fan", "milk", am_type=77), 1)
                self.assertEqual(run.send("kitchen/stove", "kitchen/fan", "tea", am_type=78), 2)
                self.assertEqual(run.send("kitchen/stove", "kitchen-pc", bytes(256), reliable=False), 3)
                happened = [(x.who.rpartition("/")[2], x.what) for x in run.step(10).events]
                self.assertIn(("listener-77", 'received "milk" from mote 1/3'), happened)
                self.assertIn(("requested", "message 1 acknowledged"), happened)
                self.assertIn(("requested", "message 2 not acknowledged"), happened)  # nobody takes that type
                for mote, to, octets, why in (("kitchen/nobody", "kitchen/fan", b"", "there is no mote `kitchen/nobody`"),
                                              ("kitchen-pc", "kitchen/fan", b"", "there is no mote `kitchen-pc`"),
                                              ("kitchen/stove", "nobody", b"", "is named `nobody`"),
                                              ("kitchen/stove", "kitchen/fan", bytes(257), "at most 256 octets")):
                    with self.assertRaisesRegex(RequestError, why):
                        run.send(mote, to, octets)
                run.fault("crash mote kitchen/stove for 5s")
                run.step(1)
                with self.assertRaisesRegex(RequestError, "does not run"):
                    run.send("kitchen/stove", "kitchen/fan", b"late")
                lines, report = run.record(), run.finish()
            self.assertEqual(lines.count('"do":"send"'), 3)
            pathlib.Path(folder, "lines").write_text(lines)
            done = subprocess.run([RUBICON, "run", file, "--json", "--for", "60s", "--steer", folder + "/lines"],
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=120)
            self.assertEqual(json.loads(done.stdout)["trace_hash"], report["trace_hash"])

    def test_everything_may_be_requested_before_the_first_step(self):
        with start(length=60) as run:
            self.assertFalse(run.motes()["kitchen/stove"]["joined"])
            run.set("care-pc", "note", "milk")
            run.fault("crash mote kitchen/stove for 5s")
            run.step(1)
            self.assertEqual(run.get("care-pc", "note"), "milk")
            self.assertFalse(run.motes()["kitchen/stove"]["alive"])

    def test_bad_requests_are_refused_and_the_run_goes_on(self):
        with start() as run:
            for wrong in (lambda: run.fault("kill peer nobody"), lambda: run.get("nobody", "x"),
                          lambda: run.step(-1), lambda: run.set("care-pc", "*", "x")):
                with self.assertRaises(RequestError):
                    wrong()
            self.assertEqual(run.step(1).now, 1)

    def test_a_file_with_mistakes_is_reported_with_its_place(self):
        with self.assertRaisesRegex(RunError, "ecology.toml:2:"):
            Run({"ecology": {"nam": "x"}}, binary=RUBICON)

    def test_an_ecology_of_dicts_runs(self):
        ecology = {"ecology": {"name": "two", "duration": "10s"},
                   "peer": [{"id": 1, "name": "a"}, {"id": 2, "name": "b", "links": ["inproc://a"]}]}
        self.assertIn("[[peer]]", to_toml(ecology))
        seeds = map_runs(lambda seed: self.seed_of(ecology, seed), range(1, 5), at_once=2)
        self.assertEqual(seeds, [1, 2, 3, 4])

    def seed_of(self, ecology, seed):
        with Run(ecology, seed=seed, binary=RUBICON) as run:
            return run.finish()["seed"]


class EndTest(unittest.TestCase):
    def test_the_binary_is_killed(self):
        rng = random.Random(1)
        for _ in range(KILLS):
            with start() as run:
                process = run._process
                run.step(rng.random() * 5)
                process.send_signal(signal.SIGKILL)
                with self.assertRaises(RunError):
                    while True:
                        run.step(0.01)

    def test_python_is_killed(self):
        rng = random.Random(2)
        script = ("import sys; sys.path.insert(0, sys.argv[1])\nfrom rubicon import Run\n"
                  "run = Run(sys.argv[2], binary=sys.argv[3])\nprint(run._process.pid, flush=True)\n"
                  "while True:\n    run.step(0.01) if run.now < 200 else None\n")
        for _ in range(KILLS):
            child = subprocess.Popen([sys.executable, "-c", script, str(support.ROOT / "python"), HOME, RUBICON],
                                     stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
            pid = int(child.stdout.readline())
            try:
                child.wait(rng.random() * 0.3)
            except subprocess.TimeoutExpired:
                pass
            child.kill()
            child.wait()
            child.stdout.close()
            self.assertTrue(support.eventually(lambda: not is_running(pid)))


if __name__ == "__main__":
    unittest.main()
