#!/usr/bin/python3
"""Prints where the mapper's time goes, by stage, from runs of mba_vo_offline or scripts/accuracy.sh.

  taskset --cpu-list 0 scripts/accuracy.sh desk && scripts/stages.py output/accuracy/desk

One row for each run folder: medians over its keyframes [ms] of each stage and of the whole keyframe, its 90 % quantile
and largest, and the depth search per tracked frame [ms] (mean, and the largest mean between two keyframes).
"""
import argparse
import csv
import os

import numpy as np

STAGES = ["activation", "optimisation", "calibration", "marginalisation", "selection"]


def read_rows(folder, name):
    with open(os.path.join(folder, name)) as file:
        return list(csv.DictReader(file))


def depth_search_per_frame(keyframes, frames):
    """Mean and largest mean: frames are searched until the next keyframe is made."""
    tracked = np.array([int(f["sequence"]) for f in frames if f["points"]])
    sums = np.array([float(k["depth_search_ms"]) for k in keyframes])
    made = np.array([int(k["sequence"]) for k in keyframes])
    counts = np.array([((tracked > a) & (tracked <= b)).sum() for a, b in zip(made[:-1], made[1:])])
    known = counts > 0
    return sums[1:].sum() / max(1, counts.sum()), (sums[1:][known] / counts[known]).max(initial=0.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", metavar="RUN")
    arguments = parser.parse_args()
    print("| run | keyframes | %s | keyframe, median / 90 %% / max | depth search per frame, mean / max |" %
          " | ".join(STAGES))
    print("|---" * (len(STAGES) + 4) + "|")
    for run in arguments.runs:
        keyframes, frames = read_rows(run, "keyframes.csv"), read_rows(run, "frames.csv")
        stages = [np.median([float(k[stage + "_ms"]) for k in keyframes]) for stage in STAGES]
        total = np.array([float(k["total_ms"]) for k in keyframes])
        print("| `%s` | %d | %s | %.0f / %.0f / %.0f | %.1f / %.1f |" %
              ((os.path.basename(os.path.normpath(run)), len(keyframes), " | ".join("%.1f" % s for s in stages),
                np.median(total), np.quantile(total, 0.9), total.max()) + depth_search_per_frame(keyframes, frames)))


if __name__ == "__main__":
    main()
