#!/usr/bin/python3
"""Runs the odometry over a sequence for minutes, to and fro, and prints how its memory grows.

  scripts/memory.py [--bin DIR] [--minutes M] SEQUENCE [-- OPTION...]

SEQUENCE is a folder; seen backwards a blurred image is a blurred image, so its frames serve in both directions. The
options after -- go to mba_vo_offline. Printed: minutes, slope of the resident memory after the first minute [MB per
minute of the sequence], its peak [MB], and frames dropped.
"""
import argparse
import os
import re
import subprocess
import tempfile
import time

import numpy as np


def read_times(folder):
    with open(os.path.join(folder, "times.txt")) as lines:
        rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    return [(row[0], float(row[1]), row[2]) for row in rows]


def to_and_fro(source, target, minutes):
    """A folder of links to the images of `source`, with times that go on; returns its length [s]."""
    times = read_times(source)
    images = os.path.join(source, "images")
    files = {int(os.path.splitext(name)[0]): name for name in os.listdir(images)}
    os.makedirs(os.path.join(target, "images"))
    os.symlink(os.path.abspath(os.path.join(source, "camera.yaml")), os.path.join(target, "camera.yaml"))
    now, index, step, number = times[0][1], 0, 1, 0
    with open(os.path.join(target, "times.txt"), "w") as out:
        while now - times[0][1] < 60.0 * minutes:
            frame, _, exposure = times[index]
            name = files[int(frame)]
            link = "%06d%s" % (number, os.path.splitext(name)[1])
            os.symlink(os.path.abspath(os.path.join(images, name)), os.path.join(target, "images", link))
            out.write("%d %.6f %s\n" % (number, now, exposure))
            if not 0 <= index + step < len(times):
                step = -step
            now += abs(times[index + step][1] - times[index][1])
            index += step
            number += 1
    return number


def resident_mb(pid):
    with open("/proc/%d/status" % pid) as lines:
        for line in lines:
            if line.startswith("VmRSS:"):
                return int(line.split()[1]) / 1024.0
    return None


def watch(command):
    """Resident memory [MB] over the share of the run that is done."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    begin, samples = time.monotonic(), []
    while process.poll() is None:
        try:
            memory = resident_mb(process.pid)
        except OSError:
            break
        if memory:
            samples.append((time.monotonic() - begin, memory))
        time.sleep(0.5)
    error = process.communicate()[1]
    if process.returncode != 0:
        raise SystemExit("mba_vo_offline failed: " + error.strip())
    return np.array(samples)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="devel/lib/mba_vo", help="folder of the programs")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("sequence")
    parser.add_argument("options", nargs="*", help="for mba_vo_offline")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        frames = to_and_fro(arguments.sequence, os.path.join(folder, "sequence"), arguments.minutes)
        output = os.path.join(folder, "run")
        samples = watch([os.path.join(arguments.bin, "mba_vo_offline"), os.path.join(folder, "sequence"), "--output",
                         output] + arguments.options)
        with open(os.path.join(output, "summary.yaml")) as file:
            summary = file.read()
    minutes = samples[:, 0] / samples[-1, 0] * arguments.minutes
    later = minutes > 1.0
    slope = np.polyfit(minutes[later], samples[later, 1], 1)[0]
    dropped = re.search(r"^dropped_after_initialization: (\d+)", summary, re.M).group(1)
    print("%.0f minutes, %d frames: slope %.2f MB per minute, peak %.0f MB, %s dropped" %
          (arguments.minutes, frames, slope, samples[:, 1].max(), dropped))


if __name__ == "__main__":
    main()
