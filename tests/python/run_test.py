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
