#!/usr/bin/env python3
"""An environment in the shape of gymnasium's: how often should the motes of room.toml report?

usage: environment.py [SEED]     an agent without a plan acts for one run
"""
import pathlib
import random
import sys

from rubicon import Run

FILE = pathlib.Path(__file__).with_name("room.toml")


class Reporting:
    """A step is a minute, an action the period of all reports in it, as an index into PERIODS.

    An observation is of the last minute: readings that arrived, charge used [mAh], and the mean number of hops. The
    reward is the number of readings less PRICE for each mAh. With gymnasium installed, let the class inherit from
    gymnasium.Env, and set action_space = Discrete(len(PERIODS)), observation_space = Box(0, inf, (3,)).
    """
    PERIODS = (2, 5, 10, 30, 60)  # [s]
    PRICE = 500.0

    def __init__(self):
        self.run, self.used = None, 0.0

    def reset(self, *, seed=None, options=None):
        self.close()
        self.run = Run(FILE, seed=seed)
        self.run.subscribe("devices.*.output.1")
        self.run.step(until=lambda run: all(x["joined"] for x in run.motes().values()), limit=120)
        return self.observe(0), {}

    def observe(self, readings):
        motes = self.run.motes().values()
        used, self.used = self.used, sum(x["used_mah"] for x in motes)
        return readings, self.used - used, sum(x["hops"] for x in motes) / len(motes)

    def step(self, action):
        for mote in self.run.mote_names:
            self.run.fault(f"rate mote {mote} period {self.PERIODS[action]}s")
        done = self.run.step(60)
        observation = self.observe(len(done.tuples))
        terminated = not any(x["alive"] for x in self.run.motes().values())
        return observation, observation[0] - self.PRICE * observation[1], terminated, done.over, {"now_s": done.now}

    def close(self):
        if self.run is not None:
            self.run.close()
        self.run, self.used = None, 0.0


def main():
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    agent, environment = random.Random(seed), Reporting()
    environment.reset(seed=seed)
    total, over = 0.0, False
    while not over:
        action = agent.randrange(len(Reporting.PERIODS))
        (readings, used, _), reward, terminated, truncated, _ = environment.step(action)
        print(f"every {Reporting.PERIODS[action]:2} s: {readings:3} readings, {used:.3f} mAh, reward {reward:6.1f}")
        total, over = total + reward, terminated or truncated
    environment.close()
    print(f"reward {total:.1f}")


if __name__ == "__main__":
    main()
