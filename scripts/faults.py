#!/usr/bin/python3
"""Spoils sequences on purpose, seed by seed, and checks what the odometry makes of it.

  scripts/faults.py [--bin DIR] [--seeds FIRST:LAST] [--kinds KINDS] [--offset X Y Z] SEQUENCE... [-- OPTION...]

A SEQUENCE is a folder with groundtruth.txt; the options after -- go to mba_vo_offline. Printed for each run, if anything
is wrong, and at the end for all:

  failed    crashed, did not end in time, or wrote something that is not a number
  wrong     poses labelled TRACKING that are further than 5 % of the scene's depth from the truth, after robust alignment
            of their map (which began with a median depth of 1)
  found     kidnappings after which the camera was found in its old map within 1 s; new: a new map began instead
  pieces    maps that began after the first; in sight: of these, such as show a place that an earlier one shows (by the
            truth: an image of each, within 20 % of the depth and 30 degrees); joined: of those in sight, such as are one
            map with an earlier one in the end; falsely: joined ones whose positions are off by more than 2 % of the
            depth in the median, after robust alignment of the whole map

Depth: what the camera usually sees lies at, --depth [m]. Needs orientations in groundtruth.txt.
"""
import argparse
import collections
import concurrent.futures
import csv
import os
import subprocess
import sys
import tempfile

import numpy as np

from starts import Truth, read_poses, rotate

WRONG = 0.05  # of the scene's depth
FOUND_WITHIN = 1.0  # [s]
FALSE_JOIN = 0.02  # of the scene's depth
PLACE, PLACE_DEGREES = 0.2, 30.0  # of the depth; degrees: what counts as the same place


def similarity(estimate, truth):
    """Scale, rotation and translation of the best similarity (Umeyama)."""
    me, mt = estimate.mean(axis=0), truth.mean(axis=0)
    u, d, vt = np.linalg.svd((truth - mt).T @ (estimate - me))
    sign = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    rotation = u @ sign @ vt
    scale = (d * np.diag(sign)).sum() / max(1e-12, ((estimate - me) ** 2).sum())
    return scale, rotation, mt - scale * rotation @ me


def errors_of(estimate, truth):
    """Distances over depth after an alignment that the worst fifth does not take part in."""
    keep = np.ones(len(estimate), bool)
    for _ in range(10):
        scale, rotation, t = similarity(estimate[keep], truth[keep])
        error = np.linalg.norm(truth - (scale * estimate @ rotation.T + t), axis=1)
        keep = error <= np.quantile(error, 0.8)
    return error / max(scale, 1e-9)


def places_of(folder, times):
    """Positions and viewing directions (axes of the camera in rows) nearest to these times."""
    truth = np.loadtxt(os.path.join(folder, "groundtruth.txt"))
    rows = truth[np.clip(np.searchsorted(truth[:, 0], times), 0, len(truth) - 1)]
    return rows[:, 1:4], rotate(rows[:, 4:8], np.array([0.0, 0.0, 1.0]))


def check_joins(output, folder, depth, source, result):
    """Of the pieces, as their poses were published, and what they are part of in the end."""
    times, positions, final = read_poses(os.path.join(output, "trajectory.txt"))
    online_times, _, online = read_poses(os.path.join(output, "online_trajectory.txt"))
    piece_of = dict(zip(online_times, online))
    known = np.array([t in piece_of and t in source for t in times])
    times, positions, final = times[known], positions[known], final[known]
    pieces = np.array([piece_of[t] for t in times])
    at, axis = places_of(folder, [source[t] for t in times])
    errors = np.zeros(len(times))
    for number in set(final):
        errors[final == number] = errors_of(positions[final == number], at[final == number])
    for piece in sorted(set(pieces))[1:]:
        own, earlier = pieces == piece, pieces < piece
        apart = np.linalg.norm(at[own][:, None] - at[earlier][None], axis=2)
        alike = axis[own] @ axis[earlier].T > np.cos(np.radians(PLACE_DEGREES))
        in_sight = bool(np.any(alike & (apart < PLACE * depth)))
        joined = bool(set(final[own]) & set(final[earlier]))
        result["pieces"] += 1
        result["in sight"] += int(in_sight)
        result["joined"] += int(joined and in_sight)
        result["falsely"] += int(joined and np.median(errors[own]) > FALSE_JOIN)


def check(output, folder, offset, depth):
    result = collections.Counter()
    with open(os.path.join(output, "faults.csv")) as file:
        faults = list(csv.DictReader(file))
    with open(os.path.join(output, "frames.csv")) as file:
        frames = {f["sequence"]: f for f in csv.DictReader(file)}
    times, positions, maps = read_poses(os.path.join(output, "trajectory.txt"))
    with open(os.path.join(output, "exposure_trajectory.txt")) as file:
        text = file.read() + open(os.path.join(output, "trajectory.txt")).read()
    result["failed"] += int("nan" in text.replace("\n#", "") or "inf" in text)
    result["frames"] += len(faults)
    result["posed"] += len(times)
    source = {f["time"]: float(f["source_time"]) for f in faults}
    status = {f["time"]: frames[f["sequence"]]["status"] for f in faults if f["sequence"] in frames}
    truth = Truth(folder, offset)
    spoken = {float(t): t for t in source}
    keys = [spoken.get(t) for t in times]
    for number in sorted(set(maps)):
        good = np.array([m == number and k is not None and status.get(k) == "TRACKING" for m, k in zip(maps, keys)])
        if good.sum() < 8:
            continue
        at = truth.at([source[k] for k, g in zip(keys, good) if g])
        error = errors_of(positions[good], at)
        result["wrong"] += int((error > WRONG).sum())
        result["judged"] += int(good.sum())
    result["maps"] += len(set(maps))
    if len(times) > 0:
        check_joins(output, folder, depth, {float(t): s for t, s in source.items()}, result)
    # Kidnappings: the first frames after the cover was taken away, in the maps as published: they may be joined later.
    online_times, _, online = read_poses(os.path.join(output, "online_trajectory.txt"))
    published = dict(zip(online_times, online))
    map_of = [published.get(float(f["time"])) for f in faults]
    for i in range(1, len(faults)):
        if faults[i - 1]["fault"] != "kidnap" or faults[i]["fault"] == "kidnap":
            continue
        last = next((j for j in range(i - 1, -1, -1) if map_of[j]), None)
        end = float(faults[i]["time"]) + FOUND_WITHIN
        after = [m for f, m in zip(faults[i:], map_of[i:]) if float(f["time"]) <= end]
        if last is None or len(after) < 10:
            continue
        result["kidnapped"] += 1
        result["found"] += int(map_of[last] in after)
        result["new"] += int(any(m not in (None, map_of[last]) for m in after))
    return result


def spoil(arguments, folder, seed):
    with tempfile.TemporaryDirectory() as output:
        output = os.path.join(arguments.keep, "%s_%d" % (os.path.basename(folder), seed)) if arguments.keep else output
        command = [os.path.join(arguments.bin, "mba_vo_offline"), folder, "--output", output, "--fault-seed", str(seed),
                   "--faults", arguments.kinds, *arguments.options]
        try:
            run = subprocess.run(command, capture_output=True, text=True, timeout=arguments.timeout, check=False)
        except subprocess.TimeoutExpired:
            return seed, collections.Counter(failed=1), "did not end in time"
        if run.returncode not in (0, 1) or "no frame could be tracked" not in run.stderr and run.returncode == 1:
            return seed, collections.Counter(failed=1), "exit status %d: %s" % (run.returncode, run.stderr[-300:])
        result = check(output, folder, arguments.offset, arguments.depth)
        return seed, result, ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", nargs="+", metavar="SEQUENCE")
    parser.add_argument("--bin", default="devel/lib/mba_vo", help="folder of mba_vo_offline")
    parser.add_argument("--seeds", default="1:10", help="first and last seed")
    parser.add_argument("--kinds", default="all", help="faults, separated by commas; see mba_vo_offline --help")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--timeout", type=float, default=300.0, help="[s] per run")
    parser.add_argument("--offset", type=float, nargs=3, default=(0.0, 0.0, 0.0), metavar=("X", "Y", "Z"),
                        help="of the camera from the point whose poses are the ground truth, in its axes [m]")
    parser.add_argument("--depth", type=float, default=2.5, help="[m] that the camera usually sees")
    parser.add_argument("--keep", default="", help="folder for the results of the runs")
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:end])
    arguments.options = words[end + 1:]
    for folder in arguments.sequences:
        if not os.path.exists(os.path.join(folder, "groundtruth.txt")):
            parser.error("%s is not there" % os.path.join(folder, "groundtruth.txt"))
    first, last = (int(x) for x in arguments.seeds.split(":"))
    for folder in (s.rstrip("/") for s in arguments.sequences):
        total = collections.Counter()
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            for seed, result, problem in pool.map(lambda s, f=folder: spoil(arguments, f, s), range(first, last + 1)):
                total += result
                if problem or result["failed"] or result["wrong"] or result["found"] < result["kidnapped"]:
                    print("  %s seed %d: %s %s" % (os.path.basename(folder), seed, dict(result), problem), flush=True)
        print("%-10s runs %d  failed %d  frames %d  with a pose %.1f %%  TRACKING %d, wrong %d  maps %d  kidnapped %d, found "
              "%d, new %d  pieces %d, in sight %d, joined %d, falsely %d" % (os.path.basename(folder), last - first + 1, total["failed"], total["frames"],
                              100.0 * total["posed"] / max(1, total["frames"]), total["judged"], total["wrong"],
                              total["maps"], total["kidnapped"], total["found"], total["new"], total["pieces"], total["in sight"],
                              total["joined"], total["falsely"]), flush=True)


if __name__ == "__main__":
    main()
