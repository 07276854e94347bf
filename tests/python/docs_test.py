#!/usr/bin/env python3
"""The examples of docs/python.md are run as they stand, with the binary and the file of the page, on a free port; so are
those of docs/steering.md, with a template.
usage: docs_test RUBICON"""
import contextlib
import inspect
import io
import os
import re
import sys
import unittest

import support

import rubicon

RUBICON = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
PAGE = (support.ROOT / "docs/python.md").read_text()
STEERING = (support.ROOT / "docs/steering.md").read_text()


def blocks(language, page=PAGE):
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.M | re.S)


class PageTest(unittest.TestCase):
    def test_examples_print_what_is_beside_them(self):
        file, = blocks("toml")
        support.FILE = file.replace("{", "{{").replace("}", "}}").replace("8000", "{port}")
        binary = support.Binary(RUBICON)
        self.addCleanup(binary.end)
        names = {}
        for block in blocks("python"):
            expected = re.findall(r"^ *print\(.*\) *# (.*)$", block, re.M)
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(block.replace("8000", str(binary.port)), "docs/python.md", "exec"), names)
            self.assertEqual(printed.getvalue().splitlines(), expected)
        self.assertTrue(support.eventually(lambda: names["seen"] == ["21.5", "22"]))

    def test_all_methods_are_on_the_page(self):
        for name, method in inspect.getmembers(rubicon.Peer):
            if name.startswith("_"):
                continue
            if not inspect.isfunction(method):
                self.assertIn(f"`{name}`", PAGE)
                continue
            shown = re.search(rf"`{name}\((.*?)\)`", PAGE)
            self.assertTrue(shown, name)
            parameters = [x for x in inspect.signature(method).parameters if x != "self"]
            named = re.findall(r"(\w+)(?:=[^,]*)?(?:, |$)", shown[1])
            self.assertEqual(named, parameters, name)
            self.assertTrue(method.__doc__, name)

    def test_all_exceptions_are_on_the_page(self):
        for name in rubicon.__all__:
            if name.endswith("Error"):
                self.assertIn(f"`{name}`", PAGE + STEERING)

    def test_the_runs_of_the_page_of_steering_do_what_it_says(self):
        os.environ["RUBICON"] = RUBICON
        self.addCleanup(os.environ.pop, "RUBICON")
        printed, names = io.StringIO(), {}
        with contextlib.redirect_stdout(printed):
            for block in blocks("python", STEERING):
                exec(compile(block.replace("home.toml", str(support.ROOT / "share/templates/home.toml")),
                             "docs/steering.md", "exec"), names)
        temperature, last, outcome, deliveries = printed.getvalue().splitlines()
        self.assertGreater(float(temperature), 0)
        self.assertRegex(last, r"^\d+\.\d+ [0-9a-f]{16}$")
        self.assertEqual(outcome, "['message 1 not acknowledged']")
        self.assertIn(f"`{outcome}`", STEERING)
        self.assertEqual(len(deliveries.split(",")), 4)
        self.assertIn('at = "10.000000001s"', names["plan"])

    def test_all_methods_of_runs_are_on_the_page_of_steering(self):
        for name, method in inspect.getmembers(rubicon.Run, inspect.isfunction):
            if not name.startswith("_"):
                self.assertIn(f"`{name}(", STEERING)
                self.assertTrue(method.__doc__, name)


if __name__ == "__main__":
    unittest.main(verbosity=2)
