#!/usr/bin/env python3
"""What has to hold in room.toml: to begin with; add what your study relies on.

usage: python3 -m unittest     in this folder
"""
import pathlib
import unittest

from rubicon import Run

FILE = pathlib.Path(__file__).with_name("room.toml")


class RoomTest(unittest.TestCase):
    def test_all_motes_join_and_most_readings_arrive(self):
        with Run(FILE, seed=1, length=300) as run:
            run.step(until=lambda x: all(mote["joined"] for mote in x.motes().values()), limit=120)
            self.assertLess(run.now, 120)
            self.assertGreater(run.finish()["messages"]["delivery"], 0.9)

    def test_the_same_seed_gives_the_same_run(self):
        hashes = []
        for seed in (1, 1, 2):
            with Run(FILE, seed=seed, length=60) as run:
                hashes.append(run.finish()["trace_hash"])
        self.assertEqual(hashes[0], hashes[1])
        self.assertNotEqual(hashes[0], hashes[2])


if __name__ == "__main__":
    unittest.main()
