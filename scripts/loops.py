#!/usr/bin/python3
"""Judges the loops of a run by true poses: loops.py SEQUENCE RUN [--depth METRES] [--drift]

SEQUENCE has groundtruth.txt; RUN is what mba_vo_offline wrote with `mapper: {loops: {close: true}}`. Tells

  false loops   closed ones that are off by more than 5 % of the depth, 2 degrees or 5 % of the scale
  errors        of the closed ones, and these over what they expect of themselves (1 is right)
  candidates    how many of the pairs compared show one place
  recall        of the keyframes at a place where an earlier one has been, within 20 % of the depth and 30 degrees, how
                many were compared with one there, how many closed a loop, and how many had one closed within 2 s

--drift: instead, what a run without loops is off by between keyframes: root mean square for one keyframe, if the errors
of so many add up at random.

Depth: what the camera usually sees lies at [m]; default: 2.5.
"""
import argparse
import csv
import os

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

FALSE_TRANSLATION, FALSE_DEGREES, FALSE_SCALE = 0.05, 2.0, 0.05  # of the depth; degrees; logarithm
PLACE_TRANSLATION, PLACE_DEGREES = 0.2, 30.0  # of the depth; degrees: what counts as the same place
LEAST_AWAY = 4.0  # [s] since an earlier keyframe that counts
IN_TIME = 2.0  # [s] until a return should be known
SCALE_WINDOW = 1.0  # [s] on either side, in which the unit of length is measured


class Poses:
    def __init__(self, table):
        self.times, self.positions = table[:, 0], table[:, 1:4]
        self.rotations = Slerp(self.times, Rotation.from_quat(table[:, 4:8]))

    def position(self, t):
        return np.array([np.interp(t, self.times, self.positions[:, i]) for i in range(3)])

    def rotation(self, t):
        return self.rotations(np.clip(t, self.times[0], self.times[-1]))


def metres_per_unit(truth, online, t):
    """By the spread of the positions as published around that time."""
    near = np.abs(online[:, 0] - t) < SCALE_WINDOW
    estimated = online[near, 1:4]
    true = np.array([truth.position(s) for s in online[near, 0]])
    a, b = estimated - estimated.mean(0), true - true.mean(0)
    _, d, _ = np.linalg.svd(b.T @ a)
    return d.sum() / (a**2).sum()


def relative(truth, older, newer):
    turn = truth.rotation(older).inv()
    return turn.apply(truth.position(newer) - truth.position(older)), turn * truth.rotation(newer)


def degrees(rotation):
    return np.degrees(rotation.magnitude())


def errors_of(row, truth, online):
    """Translation [m], in the axes of the newer keyframe, rotation [rad], scale; and what was expected."""
    older, newer = float(row["older_time"]), float(row["newer_time"])
    unit_older, unit_newer = metres_per_unit(truth, online, older), metres_per_unit(truth, online, newer)
    t, turn = relative(truth, older, newer)
    found = np.array([float(row[k]) for k in ("tx", "ty", "tz")]) * unit_older
    found_turn = Rotation.from_quat([float(row[k]) for k in ("qx", "qy", "qz", "qw")])
    sigma = np.array([float(row["sigma_" + k]) for k in ("x", "y", "z", "rx", "ry", "rz", "log_scale")])
    sigma[:3] *= unit_newer
    error = np.concatenate([turn.inv().apply(found - t), (turn.inv() * found_turn).as_rotvec(),
                            [float(row["log_scale"]) - np.log(unit_newer / unit_older)]])
    return error, sigma


def is_place(truth, older, newer, depth):
    t, turn = relative(truth, older, newer)
    return np.linalg.norm(t) < PLACE_TRANSLATION * depth and degrees(turn) < PLACE_DEGREES


def print_errors(closed, truth, online, depth):
    errors = [errors_of(row, truth, online) for row in closed]
    false = [row for row, (e, _) in zip(closed, errors)
             if np.linalg.norm(e[:3]) > FALSE_TRANSLATION * depth
             or np.degrees(np.linalg.norm(e[3:6])) > FALSE_DEGREES or abs(e[6]) > FALSE_SCALE]
    print(f"false loops   {len(false)} of {len(closed)}", *[f"{r['older']}-{r['newer']}" for r in false])
    if not errors:
        return
    e, s = (np.array([pair[i] for pair in errors]) for i in range(2))
    print(f"errors        median {1e3 * np.median(np.linalg.norm(e[:, :3], axis=1)):.2f} mm, "
          f"{np.degrees(np.median(np.linalg.norm(e[:, 3:6], axis=1))):.3f} deg, "
          f"{100 * np.median(np.abs(e[:, 6])):.2f} % of the scale")
    ratio = np.sqrt(np.median((e / s) ** 2, axis=0) / 0.455)  # the median of chi squared
    print("over expected", *[f"{r:.2f}" for r in ratio], " (x y z, rotation, scale)")


def print_recall(rows, keyframes, truth, depth):
    compared, closed = {}, {}
    for row in rows:
        t = float(row["newer_time"])
        right = is_place(truth, float(row["older_time"]), t, 1.5 * depth)
        compared[t] = compared.get(t, False) or right
        closed[t] = closed.get(t, False) or row["rejected_because"] == ""
    right = sum(is_place(truth, float(r["older_time"]), float(r["newer_time"]), 1.5 * depth) for r in rows)
    print(f"candidates    {right} of {len(rows)} show one place (30 % of the depth, {PLACE_DEGREES:.0f} degrees)")
    times = np.array(sorted(keyframes))
    returns = [t for t in times if any(is_place(truth, s, t, depth) for s in times[times < t - LEAST_AWAY])]
    near = lambda t, found: any(ok and abs(s - t) <= IN_TIME for s, ok in found.items())
    count = lambda hits: f"{sum(hits)} of {len(returns)} ({100 * sum(hits) / max(len(returns), 1):.0f} %)"
    print("recall        compared", count([compared.get(t, False) for t in returns]), ", closed",
          count([closed.get(t, False) for t in returns]), ", closed within 2 s", count([near(t, closed) for t in returns]))


def print_drift(truth, run, keyframes):
    smoothed = np.loadtxt(os.path.join(run, "trajectory.txt"))
    estimate = Poses(smoothed)
    times = np.array([t for t in keyframes if smoothed[0, 0] + 1.0 < t < smoothed[-1, 0] - 1.0])
    units = np.array([metres_per_unit(truth, smoothed, t) for t in times])
    for steps in (1, 4, 16):
        errors = []
        for older, newer in zip(times[:-steps], times[steps:]):
            t, turn = relative(truth, older, newer)
            found, found_turn = relative(estimate, older, newer)
            errors.append([np.linalg.norm(np.median(units) * found - t), (turn.inv() * found_turn).magnitude()])
        translation, rotation = np.sqrt(np.mean(np.square(errors), axis=0) / 3.0 / steps)
        scale = np.std(np.log(units[steps:] / units[:-steps])) / np.sqrt(steps)
        print(f"{steps:3d} keyframes: {1e3 * translation:.2f} mm, {1e3 * rotation:.3f} mrad on each axis, "
              f"{100 * scale:.3f} % of the scale")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence")
    parser.add_argument("run")
    parser.add_argument("--depth", type=float, default=2.5)
    parser.add_argument("--drift", action="store_true")
    a = parser.parse_args()
    for folder, name in ((a.sequence, "groundtruth.txt"), (a.run, "keyframes.csv"), (a.run, "online_trajectory.txt")):
        if not os.path.exists(os.path.join(folder, name)):
            parser.error(f"{os.path.join(folder, name)} is not there")
    truth = Poses(np.loadtxt(os.path.join(a.sequence, "groundtruth.txt")))
    with open(os.path.join(a.run, "keyframes.csv"), encoding="utf-8") as file:
        keyframes = [float(row["time"]) for row in csv.DictReader(file)]
    if a.drift:
        print_drift(truth, a.run, keyframes)
        return
    online = np.loadtxt(os.path.join(a.run, "online_trajectory.txt"))
    loops = os.path.join(a.run, "loops.csv")
    if not os.path.exists(loops):
        parser.error(f"{loops} is not there: RUN needs `mapper: {{loops: {{close: true}}}}` in its configuration")
    with open(loops, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    closed = [row for row in rows if row["rejected_because"] == ""]
    print_errors(closed, truth, online, a.depth)
    print_recall(rows, keyframes, truth, a.depth)
    reasons = {}
    for row in rows:
        reason = " ".join(w for w in row["rejected_because"].split() if not any(c.isdigit() for c in w))
        reasons[reason] = reasons.get(reason, 0) + 1
    for reason, times in sorted(reasons.items(), key=lambda r: -r[1]):
        print(f"{times:6d}  {reason or 'closed'}")


if __name__ == "__main__":
    main()
