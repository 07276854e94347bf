#!/usr/bin/env python3
"""Finds the shortest window of sleeping radios in which 99 % of the messages arrive.

usage: window.py [SEEDS]     runs of each window, 8 unless given
"""
import pathlib
import statistics
import sys

try:
    from rubicon import Run, map_runs
except ModuleNotFoundError:
    sys.exit("window.py: Python does not find the package rubicon: export PYTHONPATH=FOLDER, "
             "the folder python of the source tree or lib/python3/dist-packages of an installation")

FILE = pathlib.Path(__file__).with_name("room.toml")
WINDOWS = (20, 30, 40, 60, 80, 120, 160)  # [ms]
WANTED = 0.99


def delivery(setting):
    """Share of the messages that arrived in one run."""
    window, seed = setting
    with Run(FILE, seed=seed, options=["--set", f"island.room.duty_cycle.window={window}ms"]) as run:
        return run.finish()["messages"]["delivery"]


def main():
    seeds = range(1, int(sys.argv[1]) + 1 if len(sys.argv) > 1 else 9)
    shortest = None
    for window in WINDOWS:
        mean = statistics.mean(map_runs(delivery, [(window, seed) for seed in seeds]))
        print(f"{window:4} ms  {mean:7.2%}")
        if shortest is None and mean >= WANTED:
            shortest = window
    print(f"the shortest window with {WANTED:.0%}: " + (f"{shortest} ms" if shortest else "none of these"))


if __name__ == "__main__":
    main()
