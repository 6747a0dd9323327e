#!/usr/bin/python3
"""Makes a map of each sequence, starts runs in it that know nothing but the map, and prints where they find themselves.

  scripts/maps.py [--bin DIR] [--every N] [--frames N] [--jobs N] [--strangers] SEQUENCE... [-- OPTION...]

A SEQUENCE is a folder with groundtruth.txt; the options after -- go to mba_vo_offline. One line for each sequence:

  starts    runs begun at every n-th image, with --map and --localize-only
  found     within 1 s of the first image, and later
  false     whose first pose is off by more than 5 % of the depth, for which the unit of length is taken, as a map
            begins with a median depth of 1
  first     images until the first pose, median and largest
  error     of what was published, in the frame and unit of the map, which is aligned to the truth by its own run:
            median over the starts of their medians, and the largest of these [mm]; map: of that run itself, smoothed

--strangers: instead, every sequence is begun in the map of every other one, of which it shows nothing; found are all
that have a pose.
"""
import argparse
import concurrent.futures
import csv
import itertools
import os
import subprocess
import tempfile

import numpy as np

from faults import similarity
from starts import Truth, read_poses

FALSE = 0.05  # of the depth
IN_TIME = 1.0  # [s]


class Map:
    """Of a whole sequence, with what its own run knows of the truth."""

    def __init__(self, arguments, folder, output):
        self.folder, self.file = folder, os.path.join(output, os.path.basename(folder) + ".map")
        run = os.path.join(output, os.path.basename(folder))
        offline(arguments, folder, run, "--save-map", self.file)
        times, positions, maps = read_poses(os.path.join(run, "trajectory.txt"))
        last = maps == maps.max()
        truth = Truth(folder).at(times[last])
        self.scale, self.rotation, self.translation = similarity(positions[last], truth)
        self.error = np.sqrt((np.linalg.norm(self.in_world(positions[last]) - truth, axis=1) ** 2).mean())
        with open(os.path.join(run, "frames.csv")) as file:
            self.images = sum(1 for _ in csv.DictReader(file))

    def in_world(self, positions):
        return self.scale * positions @ self.rotation.T + self.translation


def offline(arguments, folder, output, *options):
    command = [os.path.join(arguments.bin, "mba_vo_offline"), folder, "--output", output, "--deterministic", *options]
    subprocess.run(command + arguments.options, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)


def start_in(arguments, where, folder, skip):
    """Images and seconds until the first pose, and errors of all that were published [m]; None without a pose."""
    with tempfile.TemporaryDirectory() as output:
        offline(arguments, folder, output, "--map", where.file, "--localize-only", "--skip", str(skip), "--frames",
                str(arguments.frames))
        with open(os.path.join(output, "frames.csv")) as file:
            frames = list(csv.DictReader(file))
        times, positions, _ = read_poses(os.path.join(output, "online_trajectory.txt"))
    if not times.size:
        return None
    until = [float(f["time"]) < times[0] for f in frames].index(False)
    errors = np.linalg.norm(where.in_world(positions) - Truth(folder).at(times), axis=1)
    return until, times[0] - float(frames[0]["time"]), errors


def report(name, where, starts):
    found = [s for s in starts if s is not None]
    in_time = sum(s[1] <= IN_TIME for s in found)
    wrong = sum(s[2][0] > FALSE * where.scale for s in found)
    medians = [1e3 * np.median(s[2]) for s in found] or [np.nan]
    images = [s[0] for s in found] or [np.nan]
    print(f"{name:24} {len(starts):6} {in_time:6} {len(found) - in_time:5} {wrong:5} {np.median(images):6.0f} "
          f"{np.max(images):4.0f} {np.median(medians):8.2f} {np.max(medians):8.2f} {1e3 * where.error:6.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", nargs="+")
    parser.add_argument("--bin", default="devel/lib/mba_vo")
    parser.add_argument("--every", type=int, default=10, help="images between starts")
    parser.add_argument("--frames", type=int, default=45, help="images of each run")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--strangers", action="store_true")
    parser.add_argument("options", nargs="*", help="after --, for mba_vo_offline")
    arguments = parser.parse_args()
    folders = [s.rstrip("/") for s in arguments.sequences]
    with tempfile.TemporaryDirectory() as output, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        maps = list(pool.map(lambda folder: Map(arguments, folder, output), folders))
        print(f"{'':24} starts  found later false  first  max    error      max    map")
        pairs = itertools.permutations(maps, 2) if arguments.strangers else zip(maps, maps)
        for where, seen in pairs:
            skips = range(0, max(1, seen.images - arguments.frames), arguments.every)
            starts = list(pool.map(lambda skip: start_in(arguments, where, seen.folder, skip), skips))
            name = os.path.basename(where.folder)
            report(name if where is seen else f"{os.path.basename(seen.folder)} in {name}", where, starts)


if __name__ == "__main__":
    main()
