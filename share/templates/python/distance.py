#!/usr/bin/env python3
"""Plots delivery against distance: motes in a row send packets to a sink, which are not repeated.

usage: distance.py [FILE]     distance.svg unless given; matplotlib draws it if it is installed
"""
import statistics
import sys

from rubicon import Run, map_runs

DISTANCES, SEEDS = range(10, 131, 10), range(1, 33)  # [m]


def deliveries(seed):
    """Share of the packets that arrived in one run, for each distance."""
    motes = [{"id": 2 + i, "name": f"{x}m", "position_m": [x, 0],
              "apps": [{"app": "sender", "to": "sink", "every": "1s"}]} for i, x in enumerate(DISTANCES)]
    with Run({"ecology": {"name": "row", "duration": "1min"},
              "radio": {"retries": 0, "propagation": {"model": "log_distance", "exponent": 3.0, "shadowing": "4dB"}},
              "island": [{"id": 1, "name": "row", "stack": "mac", "sink": {"apps": [{"app": "receiver"}]},
                          "mote": motes}]}, seed=seed) as run:
        return [x["pdr"] for x in run.finish()["flows"]]


def write_svg(file, points, right, left=60, width=520, top=20, height=260):
    """A curve of (distance, share of 1) in a frame with some numbers beside it."""
    at = [(left + width * x / right, top + height * (1 - y)) for x, y in points]
    texts = [(left - 8, top + height * (1 - y / 4) + 4, "end", f"{y * 25} %") for y in range(5)]
    texts += [(left + width * x / right, top + height + 18, "middle", f"{x} m") for x in range(0, right + 1, 50)]
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + width + 30}" height="{top + height + 50}" '
           'font-family="sans-serif" font-size="12">', '<rect width="100%" height="100%" fill="white"/>',
           f'<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="gray"/>']
    out += [f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>' for x, y, anchor, text in texts]
    out += [f'<polyline points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in at)}" fill="none" stroke="teal" '
            'stroke-width="2"/>', *(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="teal"/>' for x, y in at),
            f'<text x="{left + width / 2}" y="{top + height + 40}" text-anchor="middle">delivery against distance</text>']
    with open(file, "w", encoding="utf-8") as svg:
        svg.write("\n".join(out + ["</svg>\n"]))


def main():
    file = sys.argv[1] if len(sys.argv) > 1 else "distance.svg"
    means = [statistics.mean(x) for x in zip(*map_runs(deliveries, SEEDS))]
    for distance, mean in zip(DISTANCES, means):
        print(f"{distance:4} m  {mean:7.2%}")
    try:
        from matplotlib import pyplot
    except ImportError:
        write_svg(file, list(zip(DISTANCES, means)), DISTANCES[-1])
    else:
        pyplot.plot(DISTANCES, means, "o-")
        pyplot.xlabel("distance [m]")
        pyplot.ylabel("delivery")
        pyplot.savefig(file)


if __name__ == "__main__":
    main()
