#!/usr/bin/python3
"""Is the published covariance consistent? Runs the odometry over simulated seeds and prints NEES per degree of freedom.

  scripts/covariance.py [--seeds A-B] [--folder DIR] [--bin DIR] [--jobs N] [--list] [--size small|full] [--shake X]
                        [SEQUENCE...] [-- OPTION...]

Seeds that are not in the folder yet are rendered first. SEQUENCEs, folders with groundtruth.txt, take the place of the
seeds. The options after -- go to mba_vo_offline, --live above all.

Poses: as mba_vo_evaluate measures it (docs/evaluation.md), 1, 5 and 10 s after the first pose; mean and median over the
runs, and the rms of the errors and of what the covariance expects. Twists: of all images with a pose, by the twist and
twist_covariance of frames.csv, against the true motion between the two true poses about the image; of images whose
blur says enough of the velocity (confidence > 0) and others. 1 is right, more means that the covariance promises too much.
"""
import argparse
import concurrent.futures
import csv
import os
import subprocess
import sys
import tempfile

import numpy as np

DURATION = 12.0  # [s]
SIZES = {"small": ["--width", "376", "--height", "240", "--fx", "215"], "full": []}
TIMES = (1, 5, 10)  # [s]
OBSERVABLE_BLUR = 3.0  # [px] less says nothing of the velocity, as the tracker has it
FREEDOMS = 6


def run(command):
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)


def render(arguments, seed):
    name = "%s_%g_%d" % (arguments.size, arguments.shake, seed)
    folder = os.path.join(arguments.folder, name)
    if not os.path.exists(os.path.join(folder, "groundtruth.txt")):
        run([os.path.join(arguments.bin, "mba_vo_simulate"), "--output", folder, "--overwrite", *SIZES[arguments.size],
             "--duration", str(DURATION), "--rate", "25", "--exposure", "0.02", "--shake", str(arguments.shake),
             "--scene-seed", str(seed), "--trajectory-seed", str(seed)])
    return folder


def rotation(quaternion):
    x, y, z, w = quaternion
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def rotation_vector(R):
    """Of a rotation by less than pi."""
    axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = np.linalg.norm(axis)
    return axis if sine < 1e-9 else axis * np.arctan2(sine, 0.5 * (np.trace(R) - 1.0)) / sine


def true_twists(folder):
    """Times, and velocities in the camera: those of start to end of the exposure where these are known."""
    file = os.path.join(folder, "groundtruth_exposure.txt")
    if os.path.exists(file):
        rows = np.loadtxt(file)
        times, seconds, first, last = rows[:, 0], rows[:, 1], rows[:, 2:9], rows[:, 9:16]
    else:
        rows = np.loadtxt(os.path.join(folder, "groundtruth.txt"))
        times, seconds, first, last = rows[1:-1, 0], rows[2:, 0] - rows[:-2, 0], rows[:-2, 1:8], rows[2:, 1:8]
    twists = []
    for a, b, dt in zip(first, last, seconds):
        R = rotation(a[3:])
        phi = rotation_vector(R.T @ rotation(b[3:]))
        moved = R.T @ (b[:3] - a[:3])
        twists.append(np.concatenate([moved - 0.5 * np.cross(phi, moved), phi]) / dt)  # Log to the second order
    return times, np.array(twists)


def matrix(text):
    P = np.zeros((6, 6))
    P[np.triu_indices(6)] = [float(x) for x in text.split()]
    return P + np.triu(P, 1).T


def twist_nees(folder, output, scale):
    """Of each image with a twist: whether the blur says enough, NEES (all, translation, rotation), errors."""
    times, twists = true_twists(folder)
    samples = []
    with open(os.path.join(output, "frames.csv")) as file:
        for row in csv.DictReader(file):
            nearest = np.argmin(np.abs(times - float(row["time"])))
            if not row["twist"] or abs(times[nearest] - float(row["time"])) > 1e-3:
                continue
            v, P = np.array([float(x) for x in row["twist"].split()]), matrix(row["twist_covariance"])
            e = np.concatenate([twists[nearest, :3] / scale, twists[nearest, 3:]]) - v
            confident = float(row["blur_px"] or 0.0) >= OBSERVABLE_BLUR and v @ np.linalg.solve(P, v) > FREEDOMS
            samples.append((confident, e @ np.linalg.solve(P, e) / 6.0, e[:3] @ np.linalg.solve(P[:3, :3], e[:3]) / 3.0,
                            e[3:] @ np.linalg.solve(P[3:, 3:], e[3:]) / 3.0, scale * np.linalg.norm(e[:3]),
                            np.degrees(np.linalg.norm(e[3:]))))
    return samples


def judge(arguments, folder):
    with tempfile.TemporaryDirectory() as output:
        program = os.path.join(arguments.bin, "mba_vo_")
        run([program + "offline", folder, "--output", output, *arguments.options])
        report = os.path.join(output, "report.yaml")
        run([program + "evaluate", "--run", output, "--groundtruth", os.path.join(folder, "groundtruth.txt"), "--yaml",
             report])
        poses = read_consistency(report)
        return os.path.basename(folder.rstrip("/")), poses, twist_nees(folder, output, poses["scale"])


def read_consistency(file):
    """The keys under causal.consistency, nees_1 and so on as dictionaries."""
    values, inside = {}, False
    with open(file) as lines:
        for line in lines:
            if not line.startswith("    "):
                inside = line.strip() == "consistency:"
            elif inside:
                key, value = (word.strip() for word in line.split(":", 1))
                if value.startswith("{"):
                    pairs = (pair.split(":") for pair in value.strip("{}").split(","))
                    values[key] = {k.strip(): float(v.replace(".nan", "nan")) for k, v in pairs}
                elif key == "scale":
                    values[key] = float(value.replace(".nan", "nan"))
    return values


def report(arguments, results):
    if arguments.list:
        for name, poses, _ in results:
            print("  %-16s %s" % (name, "  ".join("%d s: %5.2f %5.2f %5.2f" % (
                t, *(poses["nees_%d" % t][key] for key in ("total", "translation", "rotation"))) for t in TIMES)))
    print("poses        runs   mean: all  transl  rot     median: all transl  rot    rms error / expected [mm] [deg]")
    for t in TIMES:
        samples = [poses["nees_%d" % t] for _, poses, _ in results]
        samples = [s for s in samples if np.isfinite(s["total"])]
        if not samples:
            continue
        of = {key: np.array([s[key] for s in samples]) for key in samples[0]}
        rms = {key: np.sqrt((of[key] ** 2).mean()) for key in of}
        kinds = ("total", "translation", "rotation")
        print("%4d s        %4d       %6.2f %6.2f %6.2f        %6.2f %6.2f %6.2f      %6.1f / %6.1f  %5.3f / %5.3f" % (
            t, len(samples), *(of[k].mean() for k in kinds), *(np.median(of[k]) for k in kinds),
            1e3 * rms["position_error"], 1e3 * rms["position_sigma"], rms["rotation_error"], rms["rotation_sigma"]))
    twists = [s for _, _, samples in results for s in samples]
    print("twists     images   mean: all  transl  rot     median: all transl  rot    error rms, median [mm/s]    [deg/s]")
    for name, wanted in (("by blur", True), ("otherwise", False)):
        of = np.array([s[1:] for s in twists if s[0] == wanted]).reshape(-1, 5)
        if of.size:
            ratios, errors = of[:, :3], of[:, 3:]
            rms, median = np.sqrt((errors ** 2).mean(axis=0)), np.median(errors, axis=0)
            print("%-10s %6d       %6.2f %6.2f %6.2f        %6.2f %6.2f %6.2f           %6.1f  %6.1f     %6.2f %6.2f" % (
                name, len(of), *ratios.mean(axis=0), *np.median(ratios, axis=0), 1e3 * rms[0], 1e3 * median[0],
                rms[1], median[1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", nargs="*", metavar="SEQUENCE")
    parser.add_argument("--seeds", default="200-219", help="first and last seed of scene and trajectory")
    parser.add_argument("--folder", default="output/covariance", help="where the rendered sequences are kept")
    parser.add_argument("--bin", default="devel/lib/mba_vo", help="folder of the programs")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--size", choices=SIZES, default="small", help="376x240 or 752x480")
    parser.add_argument("--shake", type=float, default=1.0, help="of the camera, for mba_vo_simulate")
    parser.add_argument("--list", action="store_true", help="print every run")
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:end])
    arguments.options = words[end + 1:]
    first, last = (int(seed) for seed in arguments.seeds.split("-"))
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        folders = arguments.sequences or list(pool.map(lambda s: render(arguments, s), range(first, last + 1)))
        report(arguments, list(pool.map(lambda folder: judge(arguments, folder), folders)))


if __name__ == "__main__":
    main()
