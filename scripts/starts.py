#!/usr/bin/python3
"""Starts the odometry at every n-th frame of sequences and prints how soon and how well it begins.

  scripts/starts.py [--bin DIR] [--every N] [--frames N] [--jobs N] [--offset X Y Z] [--list] SEQUENCE... [-- OPTION...]

A SEQUENCE is a folder with groundtruth.txt; the options after -- go to mba_vo_offline. One line for each sequence:

  starts    with 1.5 s of images after the first 2 % of parallax: translation over the median depth, for which the
            median scale of the maps found in the sequence is taken, as a map begins with a median depth of 1
  in time   share of them with a map within 1.5 s of that moment
  delay     from that moment to the map [s], median and largest
  ATE       of the 2 s that follow the map, after alignment by a similarity, in % of the path: median, 90 %, largest,
            and the number of starts above 3 %
  frames    share of all images read that are in the trajectory, mean and least over the starts
"""
import argparse
import concurrent.futures
import csv
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

MIN_PARALLAX = 0.02
IN_TIME = 1.5  # [s]
FOLLOWING = 2.0  # [s]
LEAST_FOLLOWING = 0.5  # [s] to measure an ATE at all
MOST_ERROR = 3.0  # [% of the path]


def read_poses(file, offset=(0.0, 0.0, 0.0)):
    """Times, positions of a point of the camera, and the number of the map (0 = none given)."""
    rows, map_id = [], 0
    with open(file) as lines:
        for line in lines:
            words = line.split()
            if line.startswith("# map"):
                map_id = int(words[2])
            elif words and not line.startswith("#"):
                rows.append([map_id] + [float(w) for w in words[:8]])
    rows = np.array(rows).reshape(-1, 9)
    return rows[:, 1], rows[:, 2:5] + rotate(rows[:, 5:9], np.array(offset)), rows[:, 0]


def rotate(quaternions, vector):
    """x y z w, one in each row."""
    axis, w = quaternions[:, :3], quaternions[:, 3:]
    cross = 2.0 * np.cross(axis, vector)
    return vector + w * cross + np.cross(axis, cross)


def align(estimate, truth):
    """Scale and residuals of the best similarity (Umeyama)."""
    e, t = estimate - estimate.mean(axis=0), truth - truth.mean(axis=0)
    u, d, vt = np.linalg.svd(t.T @ e)
    sign = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    rotation = u @ sign @ vt
    scale = (d * np.diag(sign)).sum() / max(1e-12, (e ** 2).sum())
    return scale, np.linalg.norm(t - scale * (e @ rotation.T), axis=1)


class Truth:
    def __init__(self, folder, offset=(0.0, 0.0, 0.0)):
        self.times, self.positions, _ = read_poses(os.path.join(folder, "groundtruth.txt"), offset)

    def at(self, times):
        return np.stack([np.interp(times, self.times, self.positions[:, k]) for k in range(3)], axis=1)

    def parallax_time(self, begin, depth):
        """When the camera had first moved by 2 % of the depth since `begin`; inf if never."""
        later = self.times >= begin - 1e-6
        moved = np.linalg.norm(self.positions[later] - self.at([begin]), axis=1) >= MIN_PARALLAX * depth
        return self.times[later][moved][0] if moved.any() else np.inf


def start_at(arguments, folder, skip):
    """Runs from one frame on; what is known of it before the depth of the sequence is."""
    truth = Truth(folder, arguments.offset)
    with tempfile.TemporaryDirectory() as output:
        command = [os.path.join(arguments.bin, "mba_vo_offline"), folder, "--output", output, "--skip", str(skip),
                   "--frames", str(arguments.frames), *arguments.options]
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        with open(os.path.join(output, "frames.csv")) as file:
            frames = list(csv.DictReader(file))
        times, positions, maps = read_poses(os.path.join(output, "trajectory.txt"))
    start = {"skip": skip, "begin": float(frames[0]["time"]), "end": float(frames[-1]["time"]), "map": None,
             "share": sum(f["map"] != "" for f in frames) / len(frames),
             "reasons": [f["message"] or f["reason"] for f in frames]}
    began = {int(n): float(f["time"]) for f in frames for n in re.findall(r"map (\d+) initialised", f["message"])}
    if not began or not maps.size:
        return start
    first = maps == maps.min()  # of those that were not given up
    begin = began[int(maps.min())]
    start["map"] = begin
    start["maps"] = len(began)
    all_of_it = first & (times <= begin + FOLLOWING)
    start["scale"] = align(positions[all_of_it], truth.at(times[all_of_it]))[0]
    after = first & (times >= begin) & (times <= begin + FOLLOWING)
    if after.any() and times[after][-1] - begin >= LEAST_FOLLOWING:
        true = truth.at(times[after])
        path = np.linalg.norm(np.diff(true, axis=0), axis=1).sum()
        start["error"] = 100.0 * np.sqrt((align(positions[after], true)[1] ** 2).mean()) / path
    elif start["end"] - begin > LEAST_FOLLOWING:
        start["error"] = np.inf  # the map was lost again
    return start


def quantiles(values, *levels):
    return " ".join("%.2f" % np.quantile(values, level, method="nearest") if len(values) else "-" for level in levels)


def report(arguments, folder, starts):
    truth = Truth(folder, arguments.offset)
    depth = np.median([s["scale"] for s in starts if s["map"] is not None] or [1.0])
    delays, errors, shares = [], [], []
    for s in starts:
        s["delay"] = (np.inf if s["map"] is None else s["map"]) - truth.parallax_time(s["begin"], depth)
        counts = s["end"] - truth.parallax_time(s["begin"], depth) >= IN_TIME
        shares.append(s["share"])
        if counts:
            delays.append(s["delay"])
        if "error" in s:
            errors.append(s["error"])
        if arguments.list or (counts and s["delay"] > IN_TIME) or s.get("error", 0.0) > MOST_ERROR:
            print("  %s %3d: delay %5.2f s, ATE %5.2f %%, scale %5.2f, maps %d, frames %3.0f %%%s" % (
                os.path.basename(folder), s["skip"], s["delay"], s.get("error", np.nan), s.get("scale", np.nan),
                s.get("maps", 0), 100.0 * s["share"], "" if s["map"] is not None else "; last: " + s["reasons"][-1]))
    delays, errors = np.array(delays), np.array(errors)
    print("%-10s depth %5.2f  starts %3d  in time %5.1f %%  delay %s  ATE %% %s, %d above 3  frames %.1f %% %.1f %%" % (
        os.path.basename(folder), depth, len(delays), 100.0 * (delays <= IN_TIME).mean() if len(delays) else np.nan,
        quantiles(delays, 0.5, 1.0), quantiles(errors, 0.5, 0.9, 1.0), (errors > MOST_ERROR).sum(),
        100.0 * np.mean(shares), 100.0 * np.min(shares)), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", nargs="+", metavar="SEQUENCE")
    parser.add_argument("--bin", default="devel/lib/mba_vo", help="folder of mba_vo_offline")
    parser.add_argument("--every", type=int, default=10, help="frames between starts")
    parser.add_argument("--first", type=int, default=0, help="frame of the first start")
    parser.add_argument("--frames", type=int, default=120, help="images read per start")
    parser.add_argument("--jobs", type=int, default=2, help="starts at a time")
    parser.add_argument("--offset", type=float, nargs=3, default=(0.0, 0.0, 0.0), metavar=("X", "Y", "Z"),
                        help="of the camera from the point whose poses are the ground truth, in its axes [m]")
    parser.add_argument("--list", action="store_true", help="print every start, not only the bad ones")
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:end])
    arguments.options = words[end + 1:]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for folder in (s.rstrip("/") for s in arguments.sequences):
            count = len(Truth(folder, arguments.offset).times)
            skips = range(arguments.first, count - 45, arguments.every)
            report(arguments, folder, list(pool.map(lambda skip, f=folder: start_at(arguments, f, skip), skips)))


if __name__ == "__main__":
    main()
