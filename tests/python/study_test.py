#!/usr/bin/env python3
"""What `rubicon new --python` writes: each program does what it says.
usage: study_test RUBICON"""
import importlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import support

RUBICON = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
FOLDER = support.ROOT / "share/templates/python"


def setUpModule():
    os.environ["RUBICON"] = RUBICON
    sys.path.insert(0, str(FOLDER))


def tearDownModule():
    del os.environ["RUBICON"]
    sys.path.remove(str(FOLDER))


class EnvironmentTest(unittest.TestCase):
    def run_of(self, actions, seed=1):
        environment = importlib.import_module("environment").Reporting()
        self.addCleanup(environment.close)
        observation, info = environment.reset(seed=seed)
        self.assertEqual((len(observation), info), (3, {}))
        self.assertGreater(observation[1], 0)  # charge was used to join
        return [environment.step(action) for action in actions]

    def test_rare_reports_cost_less_and_the_same_actions_have_the_same_effect(self):
        often, seldom = self.run_of([1] * 4), self.run_of([4] * 4)
        self.assertGreater(sum(x[0][0] for x in often), 3 * sum(x[0][0] for x in seldom))
        self.assertGreater(sum(x[0][1] for x in often), sum(x[0][1] for x in seldom))
        self.assertEqual(often, self.run_of([1] * 4))
        for (readings, used, hops), reward, terminated, truncated, info in often:
            self.assertAlmostEqual(reward, readings - 500 * used)
            self.assertTrue(1 <= hops <= 3)
            self.assertFalse(terminated or truncated)
            self.assertGreater(info["now_s"], 60)

    def test_an_episode_ends_with_the_run(self):
        steps = self.run_of([2] * 20)
        self.assertTrue(steps[-1][3])
        self.assertEqual(steps[-1][4]["now_s"], 1200)


class ProgramTest(unittest.TestCase):
    def run_program(self, *words):
        done = subprocess.run([sys.executable, "-B", *words], cwd=self.folder, capture_output=True, text=True,
                              timeout=250, env=dict(os.environ, PYTHONPATH=str(support.ROOT / "python")))
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout + done.stderr

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name, "study")
        shutil.copytree(FOLDER, self.folder, ignore=shutil.ignore_patterns("__pycache__"))

    def test_delivery_falls_with_distance_and_is_plotted(self):
        file = self.folder / "distance.py"
        file.write_text(file.read_text().replace("range(1, 33)", "range(1, 5)"))
        shares = [float(x) for x in re.findall(r" m +([\d.]+)%", self.run_program("distance.py", "plot.svg"))]
        self.assertEqual(len(shares), 13)
        self.assertGreater(shares[0], 99)
        self.assertLess(shares[-1], 25)
        plot = xml.etree.ElementTree.parse(self.folder / "plot.svg").getroot()
        self.assertTrue(plot.tag.endswith("svg"))

    def test_the_curve_without_matplotlib_has_a_point_for_each_distance(self):
        distance = importlib.import_module("distance")
        file = self.folder / "curve.svg"
        distance.write_svg(file, [(0, 1.0), (50, 0.5), (100, 0.0)], 100)
        curve = xml.etree.ElementTree.parse(file).getroot()
        points = curve.find("{*}polyline").get("points").split()
        self.assertEqual(points, ["60.0,20.0", "320.0,150.0", "580.0,280.0"])
        self.assertEqual(len(curve.findall("{*}circle")), 3)
        self.assertIn("100 m", [x.text for x in curve.findall("{*}text")])

    def test_an_agent_acts_for_one_run(self):
        printed = self.run_program("environment.py", "3").splitlines()
        self.assertGreater(len(printed), 15)
        self.assertRegex(printed[-1], r"^reward -?\d+\.\d$")

    def test_the_test_of_the_study_passes(self):
        self.assertIn("OK", self.run_program("-m", "unittest"))


if __name__ == "__main__":
    unittest.main()
