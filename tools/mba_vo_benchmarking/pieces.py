"""ATE against blur: pieces of the truth, to each of which mba_vo_evaluate compares what was published.

Where a sequence has blur_px.txt (mba_vo_simulate writes it: motion within the exposure at 2 m, image by image).
"""
import math

from . import figures

LENGTH = 5.0  # of a piece [s]
LEAST = 2.0  # of the last piece [s]
SHARE = 0.9  # of the images of a piece have at most its blur
COMPARED = 0.5  # least share of the images of a piece that have a pose, and that in one map: few poses always fit
FOLDER = "pieces"
BIN_PX = 10.0  # of the curve
MOST_PX = 60.0


def of_sequence(folder):
    """Lines of the truth and blur [px] of each piece; none where the sequence does not tell."""
    try:
        truth = _lines(folder / "groundtruth.txt")
        blur = [float(line.split()[-1]) for line in _lines(folder / "blur_px.txt")]
        times = [float(line.split()[0]) for line in truth]
    except (OSError, ValueError):
        return []
    if not truth or len(blur) != len(truth):
        return []
    pieces, first = [], 0
    for last in range(len(truth)):
        if last + 1 == len(truth) or times[last + 1] - times[first] >= LENGTH:
            if times[last] - times[first] >= LEAST:
                pieces.append((truth[first:last + 1], quantile(blur[first:last + 1], SHARE)))
            first = last + 1
    return pieces


def _lines(file):
    with open(file, encoding="utf-8") as stream:
        return [line for line in stream if line.strip() and not line.startswith("#")]


def write(folder, pieces):
    (folder / FOLDER).mkdir()
    for index, (truth, blur) in enumerate(pieces):
        (folder / FOLDER / ("%03d.txt" % index)).write_text("# blur_px %.3f\n" % blur + "".join(truth), encoding="utf-8")


def commands(evaluate, folder, pieces):
    for index in range(len(pieces)):
        file = folder / FOLDER / ("%03d.txt" % index)
        yield [evaluate, "--groundtruth", file, "--estimate", folder / "online_trajectory.txt", "--yaml", file.with_suffix(".yaml")]


def read(folder):
    """[(blur [px], ATE [cm])] of the pieces of a run; infinite where most images have no pose in the map with the most."""
    points = []
    for file in sorted((folder / FOLDER).glob("*.txt")):
        with open(file, encoding="utf-8") as stream:
            blur = float(stream.readline().split()[2])
            images = sum(1 for _ in stream)
        evaluation = figures.load_yaml(file.with_suffix(".yaml"))
        known = figures.value_at(evaluation, "ate.count") >= COMPARED * images
        points.append((blur, 100.0 * figures.value_at(evaluation, "ate.rmse") if known else math.inf))
    return points


def curve(points):
    """[(blur in the middle of a bin [px], quartiles of the ATE [cm], pieces)] of the bins that have any."""
    result = []
    for index in range(int(MOST_PX / BIN_PX)):
        low = index * BIN_PX
        inside = [ate for blur, ate in points if low <= blur < low + BIN_PX]
        if inside:
            result.append((low + BIN_PX / 2, [quantile(inside, share) for share in (0.25, 0.5, 0.75)], len(inside)))
    return result


def quantile(values, share):
    """Linear between neighbours, as numpy's; infinite next to something infinite."""
    values = sorted(values)
    place = share * (len(values) - 1)
    low = math.floor(place)
    if place == low or values[low] == values[low + 1]:
        return values[low]
    return math.inf if math.isinf(values[low + 1]) else values[low] + (place - low) * (values[low + 1] - values[low])
