#!/usr/bin/env python3
"""Steered runs of asyncio, and that everything public has hints of types and words about itself.
usage: async_test RUBICON"""
import asyncio
import inspect
import os
import sys
import time
import typing
import unittest

import support

import rubicon
from rubicon import AsyncRun, RequestError, Run, RunError

RUBICON = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
HOME = str(support.ROOT / "share/templates/home.toml")
RUNS = 16


def start(**more):
    return AsyncRun(HOME, binary=RUBICON, **more)


def is_running(process):
    return process.poll() is None


class AsyncTest(unittest.TestCase):
    def test_many_runs_go_on_at_once_and_are_what_they_are_alone(self):
        async def steered(seed):
            async with start(seed=seed, length=20) as run:
                while not (await run.step(1)).over:
                    await run.get("care-pc", "kitchen.fan.state")
                return (await run.finish())["trace_hash"]

        async def all_at_once():
            return await asyncio.gather(*(steered(seed) for seed in range(RUNS)))

        hashes = asyncio.run(all_at_once())
        self.assertEqual(len(set(hashes)), RUNS)
        with Run(HOME, binary=RUBICON, seed=3, length=20) as alone:
            self.assertEqual(alone.finish()["trace_hash"], hashes[3])

    def test_calls_do_what_those_of_a_run_do(self):
        async def calls():
            async with start(length=60) as run:
                await run.subscribe("note")
                await run.subscribe_events()
                self.assertEqual((await run.step(until=5)).now, 5)
                self.assertEqual(run.now, 5)
                await run.set("care-pc", "note", "milk")
                await run.fault("crash mote kitchen/stove for 5s")
                step = await run.step(until=lambda x: x.get("care-pc", "note"), limit=10)
                self.assertEqual([x.value for x in step.tuples], ["milk"])
                self.assertEqual(await run.get("care-pc", "note"), "milk")
                self.assertFalse((await run.motes())["kitchen/stove"]["alive"])
                self.assertEqual((await run.report())["seed"], run.run.seed)
                self.assertEqual((await run.record()).count("\n"), 3)
                self.assertIn("[[fault]]", await run.to_toml_tables())
                self.assertTrue((await run.batch([{"do": "step", "for": 1}]))[0]["ok"])
                with self.assertRaises(RequestError):
                    await run.send("kitchen/nobody", "kitchen/fan", b"x")
                return await run.finish()

        self.assertIn("violations", asyncio.run(calls()))

    def test_the_loop_goes_on_while_a_step_does_and_a_block_ends_it(self):
        async def cut_short():
            async with start(length=1e7) as run:
                process = run.run._process
                with self.assertRaises(asyncio.TimeoutError):
                    await asyncio.wait_for(run.step(1e7), 0.2)
                began = time.monotonic()
            self.assertFalse(is_running(process))
            self.assertLess(time.monotonic() - began, 10)

        asyncio.run(cut_short())

    def test_a_run_that_cannot_begin_says_why(self):
        async def wrong():
            async with AsyncRun({"ecology": {"nam": "x"}}, binary=RUBICON):
                pass

        with self.assertRaisesRegex(RunError, "ecology.toml:2:"):
            asyncio.run(wrong())
        with self.assertRaises(RunError):
            start().run

    def test_all_calls_of_a_run_are_those_of_an_async_run(self):
        for name, method in inspect.getmembers(Run, inspect.isfunction):
            if name.startswith("_"):
                continue
            other = getattr(AsyncRun, name)
            self.assertTrue(inspect.iscoroutinefunction(other), name)
            self.assertEqual(list(inspect.signature(method).parameters), list(inspect.signature(other).parameters), name)
        self.assertEqual(inspect.signature(Run), inspect.signature(AsyncRun))


class HintTest(unittest.TestCase):
    def public(self):
        for name in rubicon.__all__:
            x = getattr(rubicon, name)
            yield name, x
            if inspect.isclass(x):
                for member, y in inspect.getmembers(x):
                    if member.startswith("_") and member != "__init__" or name.endswith("Error"):
                        continue
                    if isinstance(y, property):
                        yield f"{name}.{member}", y.fget
                    elif inspect.isfunction(y):
                        yield f"{name}.{member}", y

    def test_everything_public_has_hints_and_words(self):
        for name, x in self.public():
            if not inspect.isfunction(x):
                self.assertTrue(x.__doc__, name)
                continue
            hints = typing.get_type_hints(x)
            parameters = [y for y in inspect.signature(x).parameters if y not in ("self", "_cls")]
            self.assertEqual([y for y in [*parameters, "return"] if y not in hints], [], name)
            self.assertTrue(x.__doc__ or name.endswith("__init__"), name)


if __name__ == "__main__":
    unittest.main()
