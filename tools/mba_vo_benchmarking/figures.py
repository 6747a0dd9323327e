"""The figures of a run, read from what mba_vo_evaluate and mba_vo_offline wrote."""
import dataclasses
import math
import statistics

import yaml

INFINITE = math.inf


@dataclasses.dataclass(frozen=True)
class Figure:
    key: str  # in JSON and CSV
    title: str
    path: str  # in the file
    digits: int
    factor: float = 1.0
    worst: float = math.nan  # of a run that failed or never had a pose; nan: such a run does not count
    file: str = "evaluation.yaml"


CAUSAL = (
    Figure("map_ate_cm", "map ATE [cm]", "causal.map.ate.rmse", 3, 100.0, INFINITE),
    Figure("odom_ate_cm", "odom ATE [cm]", "causal.odometry.ate.rmse", 3, 100.0, INFINITE),
    Figure("in_time_percent", "in time [%]", "causal.availability.pose_in_time.percent", 1, worst=0.0),
    Figure("moving_percent", "moving [%]", "causal.availability.pose_in_time_moving.percent", 1, worst=0.0),
    Figure("first_pose_s", "first pose [s]", "causal.availability.first_pose_after_parallax", 2, worst=INFINITE),
    Figure("latency_95_ms", "latency 95 % [ms]", "causal.availability.latency_ms.percentile_95", 1),
    Figure("restarts", "restarts", "causal.restarts", 0),
)
SMOOTHED = (
    Figure("smoothed_ate_cm", "smoothed ATE [cm]", "smoothed.ate.rmse", 3, 100.0, INFINITE),
    Figure("smoothed_rotation_deg", "smoothed rotation [deg]", "smoothed.rotation.rmse", 3, worst=INFINITE),
    Figure("dropped_percent", "smoothed, dropped [%]", "smoothed.dropped_percent", 1, worst=100.0),
    Figure("dropped_after_first", "dropped after the first pose", "smoothed.dropped_after_initialization", 0),
)
TIMES = (
    Figure("tracking_ms", "tracking [ms/image]", "times.tracking.per_frame_ms", 1, file="summary.yaml"),
    Figure("mapping_ms", "mapping [ms/image]", "times.mapping.per_frame_ms", 1, file="summary.yaml"),
    Figure("cpu_per_second", "core-seconds per second", "cpu.per_second", 2, file="summary.yaml"),
    Figure("memory_mb", "memory [MB]", "peak_memory_mb", 0, file="summary.yaml"),
)
OURS = CAUSAL + SMOOTHED + TIMES
# Of a trajectory that another system wrote; nothing is known of when it knew it.
OTHERS = (
    Figure("smoothed_ate_cm", "ATE [cm]", "ate.rmse", 3, 100.0, INFINITE),
    Figure("smoothed_rotation_deg", "rotation [deg]", "rotation.rmse", 3, worst=INFINITE),
    Figure("dropped_percent", "dropped [%]", "dropped_percent", 1, worst=100.0),
)


def load_yaml(file):
    try:
        with open(file, encoding="utf-8") as stream:
            return yaml.load(stream, getattr(yaml, "CSafeLoader", yaml.SafeLoader)) or {}
    except OSError:
        return {}


def value_at(tree, path):
    for key in path.split("."):
        tree = tree.get(key) if isinstance(tree, dict) else None
    return float(tree) if isinstance(tree, (int, float)) else math.nan


def read(folder, figures):
    """{key: number}; what there is no figure for has the worst one."""
    trees = {name: load_yaml(folder / name) for name in {figure.file for figure in figures}}
    values = {figure.key: figure.factor * value_at(trees[figure.file], figure.path) for figure in figures}
    return {figure.key: figure.worst if math.isnan(values[figure.key]) else values[figure.key] for figure in figures}


def worst(figures):
    return {figure.key: figure.worst for figure in figures}


def medians(runs, figures):
    """Of figures of several runs; those that do not exist are left out."""
    result = {}
    for figure in figures:
        values = [run[figure.key] for run in runs if not math.isnan(run[figure.key])]
        result[figure.key] = statistics.median(values) if values else math.nan
    return result


def shown(figure, value):
    if math.isnan(value):
        return ""
    if math.isinf(value):
        return "fail"
    if figure.key.endswith("_cm"):
        return centimetres(value)
    return "%.*f" % (figure.digits, value)


def centimetres(value):
    """Three significant digits, down to a micrometre."""
    return "%.*f" % (max(0, min(4, 2 - math.floor(math.log10(value)))) if value > 0 else 0, value)
