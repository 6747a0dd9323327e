#!/usr/bin/python3
"""Writes docs/results.md from what scripts/results.sh has run; every figure in it comes from the folder of those runs.

  scripts/results_page.py FOLDER --command TEXT --jobs N >docs/results.md
"""
import argparse
import csv
import datetime
import json
import os
import subprocess

import numpy as np
import yaml

import stages

VARIANTS = ("live", "each-image", "no-blur-model")
BUSY = 0.5  # load of other programs from which on times mean little

HEAD = """# Results

Made by a command, nothing here is written by hand:

    %(command)s

%(date)s, commit %(commit)s, %(processor)s, %(cores)s.

One set of defaults (`config/default.yaml`) serves every row. ATE: RMSE of the camera's places [mm] after alignment by a
similarity ([evaluation](evaluation.md)). Figures are medians over starts (images left out at the beginning: %(starts)s), with the least and the most where
there are several. They depend on the machine only where they are times.

- **live**: as if live, in simulated time: images arrive at their stamps, every step takes as long as on a certain machine, what comes
  late comes late (`mba_vo_offline --live`). One pass, deterministic.
- **each image**: every image is dealt with before the next one comes, and a sequence is begun anew with what was learnt of the camera.
- **no blur model**: live, every image taken for sharp (`--exposure 0`).
- **sharp images**: live, with images of the same instants that were rendered without exposure.

*As published* is what counts: each pose as it was when it was published. *Smoothed* is what is known in the end."""

NOT_MEASURED = """## What is not measured here

| | command |
|---|---|
| the ROS nodes in real time | `scripts/live.sh` |
| long, shaken walks of 20 m | `scripts/simulated.sh` |
| ATE against blur, 0 to 30 ms, with both shutters | `scripts/blur_benchmark.sh` ([benchmark](benchmark.md)) |
| the paper's sequences beside published figures | `mba_vo_benchmark config/experiments/...` ([benchmark](benchmark.md)) |
| where the covariances are right | `scripts/covariance.py` |
| starts at every tenth image | `scripts/starts.py` |
| losing and finding again, spoilt recordings | `scripts/faults.py` |
| ten recorded motions, each in two rooms | `scripts/motions.sh` |
| cameras of which nothing is told, one fault at a time | `scripts/webcam.sh` |
| dark, noisy, deep and over-exposed images | `scripts/sensors.sh` |
| lens distortion | `scripts/distortion.sh` |
| keyframes 12 frames late, as on a slow machine | `scripts/accuracy.sh --delay 12` |
| one call of the tracker, against the truth and the clock | `tracking_study`, `tracking_benchmark` (`-DMBA_VO_BENCHMARKS=ON`) |
| sharp images of blurred ones | `mba_vo_deblur` ([offline](offline.md)) |

No other odometry was run. What earlier figures decided is in [decisions](decisions/README.md)."""


def load(folder, name):
    try:
        with open(os.path.join(folder, name, "results.json"), encoding="utf-8") as file:
            return json.load(file)
    except OSError:
        return {"runs": [], "medians": {}}


def significant(value):
    """Two digits, of large numbers all before the point."""
    return "%.*f" % (0 if value >= 9.95 else 1 if value >= 0.995 else 2, value)


def values(results, sequence, variant, key):
    """Of the starts; a run that failed, or had nothing to measure, is None."""
    return [run["figures"].get(key) if run["failed"] is None else None
            for run in results["runs"] if (run["sequence"], run["variant"]) == (sequence, variant)]


def spread(found, factor=1.0, shown=significant):
    """Median, with the least and the most of several; what failed counts as the worst."""
    numbers = sorted(np.inf if value is None else factor * value for value in found)
    if not numbers:
        return ""
    texts = ["fail" if np.isinf(number) else shown(number) for number in (np.median(numbers), numbers[0], numbers[-1])]
    return texts[0] if len(numbers) == 1 else "%s (%s-%s)" % tuple(texts)


def median(found, shown="%.0f", factor=1.0):
    numbers = [factor * value for value in found if value is not None]
    return shown % np.median(numbers) if numbers else ""


def table(title, note, header, rows):
    lines = ["## " + title, ""] + ([note, ""] if note else [])
    lines += ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


class Page:
    def __init__(self, folder):
        self.folder = folder
        self.blurred, self.sharp = load(folder, "blurred"), load(folder, "sharp")
        with open(os.path.join(folder, "blurred.yaml"), encoding="utf-8") as file:
            self.experiment = yaml.safe_load(file)
        with open(os.path.join(folder, "sequences.txt"), encoding="utf-8") as file:
            self.what = dict(line.rstrip("\n").split("\t") for line in file)
        self.names = list(self.experiment["sequences"])

    def run_folder(self, sequence, variant):
        """Of the first start."""
        return os.path.join(self.folder, "blurred", "runs", "%s-%s-%d" % (sequence, variant, self.experiment["starts"][0]))

    def sequences(self):
        rows = []
        for name in self.names:
            path = self.experiment["sequences"][name]["path"]
            rows.append(["`%s`" % name, self.what[name]] + sequence_facts(path, self.run_folder(name, "each-image")))
        return table("Sequences", "Blur is the motion within the exposure of what is 2 m away. What is rendered is rendered by this project's own "
                     "[simulator](simulation.md).", ["sequence", "what", "size", "images", "blur, median / 90 % / max [px]"], rows)

    def published(self):
        rows = []
        for name in self.names:
            def of(key, name=name):
                return values(self.blurred, name, "live", key)
            rows.append(["`%s`" % name, spread(of("map_ate_cm"), 10.0), spread(of("odom_ate_cm"), 10.0), median(of("in_time_percent")),
                         median(of("moving_percent")), median(of("first_pose_s"), "%.2f"), median(of("latency_95_ms"))])
        note = ("In time: images with a pose within a frame interval, of all, and of those later than 0.3 s after the first 2 % of parallax. "
                "First pose: after that parallax.")
        return table("As published, live", note, ["sequence", "ATE in the map [mm]", "ATE in odom [mm]", "in time [%]", "in time, moving [%]",
                                                  "first pose [s]", "latency, 95 % [ms]"], rows)

    def models(self, title, note, key):
        rows = [["`%s`" % name] + [spread(values(self.blurred, name, variant, key), 10.0) for variant in VARIANTS] +
                [spread(values(self.sharp, name, "live", key), 10.0)] for name in self.names]
        return table(title, note, ["sequence", "live", "each image", "no blur model", "sharp images"], rows)

    def dropped(self):
        lost = [(name, values(self.blurred, name, "each-image", "dropped_after_first")) for name in self.names]
        told = ["%s %s" % (name, median(found)) for name, found in lost if any(found)]
        return "Images without a pose after the first one with, each image dealt with: %s." % (
            ", ".join(told) + " (medians), otherwise none" if told else "none")

    def times(self, jobs):
        rows = []
        for name in self.names:
            run = self.run_folder(name, "each-image")
            try:
                keyframes, frames = stages.read_rows(run, "keyframes.csv"), stages.read_rows(run, "frames.csv")
            except OSError:
                continue
            if not keyframes:
                continue
            total = [float(keyframe["total_ms"]) for keyframe in keyframes]
            rows.append(["`%s`" % name] + [median(values(self.blurred, name, "each-image", key), shown) for key, shown in
                                           (("tracking_ms", "%.1f"), ("cpu_per_second", "%.2f"))] +
                        ["%.1f" % stages.depth_search_per_frame(keyframes, frames)[0]] +
                        ["%.1f" % np.median([float(keyframe[stage + "_ms"]) for keyframe in keyframes]) for stage in stages.STAGES] +
                        ["%.0f / %.0f / %.0f" % (np.median(total), np.quantile(total, 0.9), max(total)),
                         median(values(self.blurred, name, "each-image", "memory_mb"))])
        side = "%d runs side by side, each on a core of its own" % jobs if jobs > 1 else "one run at a time"
        return table("Time and memory", "Each image dealt with, %s; stages are medians over keyframes [ms].%s" % (side, self.others()),
                     ["sequence", "tracking, per image [ms]", "core-seconds per second", "depth search, per image"] + stages.STAGES +
                     ["keyframe, median / 90 % / max", "memory, most [MB]"], rows)

    def others(self):
        """What else the machine did when it began."""
        try:
            with open(os.path.join(self.folder, "load.txt"), encoding="utf-8") as file:
                load = float(file.read())
        except OSError:
            return ""
        return " Other programs were running when it began (load %.1f): **times are too long**." % load if load > BUSY else ""

    def memory(self):
        try:
            with open(os.path.join(self.folder, "memory.txt"), encoding="utf-8") as file:
                return "Growth, the first sequence to and fro: %s." % file.read().strip()
        except OSError:
            return "Growth over minutes was not measured (`--quick`; `scripts/memory.py` does)."


def sequence_facts(path, run):
    """Size, number of images and blur, as far as the folders tell."""
    facts = {"size": "", "images": "", "blur": ""}
    try:
        with open(os.path.join(path, "camera.yaml"), encoding="utf-8") as file:
            camera = yaml.safe_load(file)
        facts["size"] = "%dx%d" % (camera["image_width"], camera["image_height"])
    except (OSError, KeyError, TypeError, yaml.YAMLError):
        pass
    try:
        with open(os.path.join(run, "frames.csv"), encoding="utf-8") as file:
            facts["images"] = "%d" % sum(1 for _ in csv.DictReader(file))
    except OSError:
        pass
    try:
        blur = np.loadtxt(os.path.join(path, "blur_px.txt"), ndmin=2)[:, -1]
        facts["blur"] = "%.0f / %.0f / %.0f" % (np.median(blur), np.quantile(blur, 0.9), blur.max())
    except (OSError, ValueError, IndexError):
        pass
    return list(facts.values())


def said(*command):
    """Nothing, if there is no such program: the sources may have come without git."""
    try:
        return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    except FileNotFoundError:
        return ""


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return names[0] if names else "processor not told"


def commit():
    changed = said("git", "status", "--porcelain", "--", "src", "include", "config", "cmake", "CMakeLists.txt", "tools")
    return (said("git", "rev-parse", "--short", "HEAD") or "not known") + (" with changes" if changed else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--command", required=True, help="as the page tells it")
    parser.add_argument("--jobs", type=int, required=True, help="runs that were side by side")
    arguments = parser.parse_args()
    page = Page(arguments.folder)
    cores = len(os.sched_getaffinity(0))
    print("\n\n".join([
        HEAD % {"command": arguments.command, "date": datetime.date.today().isoformat(), "commit": commit(), "processor": processor(),
                "cores": "one core" if cores == 1 else "%d cores" % cores,
                "starts": ", ".join(str(start) for start in page.experiment["starts"])},
        page.sequences(), page.published(),
        page.models("As published, with and without the models", "ATE in the map [mm].", "map_ate_cm"),
        page.models("Smoothed", "ATE [mm]. " + page.dropped(), "smoothed_ate_cm"),
        page.times(arguments.jobs), page.memory(), NOT_MEASURED]))


if __name__ == "__main__":
    main()
