"""The image that went worst in a run, as a picture: mba_vo_export takes it out of the recording, whatever form that has."""
import csv
import math

POSES = ("TRACKING", "DEGRADED")
FOLDER = "worst"
# Of mba_vo_offline; what they choose from a recording mba_vo_export has to choose, too.
CHOICES = ("--images", "--camera", "--calibration", "--image-topic", "--camera-info-topic", "--exposure-topic",
           "--stamp-reference", "--rectified")


def _number(row, key):
    try:
        return float(row.get(key) or "nan")
    except ValueError:
        return math.nan


def _gap(rows):
    """Where the longest stretch without a pose begins, after the first pose; None if there is none."""
    first = next((i for i, row in enumerate(rows) if row.get("online_status") in POSES), None)
    if first is None:
        return 0 if rows else None
    longest, begin = (0, None), None
    for index in range(first, len(rows) + 1):
        missing = index < len(rows) and rows[index].get("online_status") not in POSES
        if missing and begin is None:
            begin = index
        elif not missing and begin is not None:
            longest, begin = max(longest, (index - begin, -begin)), None
    return -longest[1] if longest[1] is not None else None


def choose(rows):
    """(index, why) of the rows of frames.csv: the first image of the longest gap, else that with the largest error in the image."""
    gap = _gap(rows)
    if gap is not None:
        row = rows[gap]
        why = "no pose (%s)" % (row.get("reason") or row.get("online_status") or "not published")
        return gap, why + _blur(row)
    errors = [(_number(row, "error_px"), -index) for index, row in enumerate(rows) if not math.isnan(_number(row, "error_px"))]
    if not errors:
        return None
    error, index = max(errors)
    return -index, "%.2f px off" % error + _blur(rows[-index])


def _blur(row):
    blur = _number(row, "blur_px")
    return "" if math.isnan(blur) else ", blur of %.1f px" % blur


def of_run(folder):
    """(index from the start of the run, why) or None."""
    try:
        with open(folder / "frames.csv", encoding="utf-8", newline="") as stream:
            return choose(list(csv.DictReader(stream)))
    except (OSError, csv.Error, UnicodeDecodeError):
        return None


def choices_of(options):
    """Those of the options that choose from the recording, with their values."""
    chosen, taken = [], False
    for word in options:
        if word.startswith("--"):
            taken = word in CHOICES
        if taken:
            chosen.append(word)
    return chosen


def command(export, sequence, folder, start, options):
    """Programs that make the picture; none where nothing is known of the run."""
    found = of_run(folder)
    if found is not None:
        yield [export, sequence, "--output", folder / FOLDER, "--form", "dso", "--rectify", "--skip", str(start + found[0]),
               "--frames", "1", *choices_of(options)]


def picture(folder):
    """The picture, or None."""
    file = folder / FOLDER / "dso" / "images" / "000000.png"
    return file if file.exists() else None
