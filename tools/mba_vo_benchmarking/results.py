"""All that the runs found, in one value from which JSON, CSV and the pages are made."""
import csv
import io
import json
import math

from . import figures, pieces


class Results:
    def __init__(self, experiment, runs, missing):
        self.experiment, self.runs, self.missing = experiment, runs, missing
        self.values = {run.name: run.values() for run in runs}

    def of(self, sequence, variant):
        return [run for run in self.runs if (run.sequence, run.variant) == (sequence, variant)]

    def medians(self, sequence, variant):
        """Of the starts; None if there is no run."""
        runs = self.of(sequence, variant)
        return figures.medians([self.values[run.name] for run in runs], runs[0].figures) if runs else None

    def sequences(self):
        return [s for s in self.experiment.sequences if s not in self.missing]

    def groups(self):
        """In the order of the experiment."""
        return list(dict.fromkeys(s.group for s in self.sequences() if s.group))

    def of_group(self, group, variant):
        """Of each sequence of a group the medians over its starts."""
        found = [self.medians(s.name, variant) for s in self.sequences() if s.group == group]
        return [values for values in found if values is not None]

    def without_drops(self, group, variant):
        """Of how many sequences of a group no run dropped an image after its first pose."""
        runs = [self.of(s.name, variant) for s in self.sequences() if s.group == group]
        return sum(all(self.values[run.name]["dropped_after_first"] == 0 for run in of_one) for of_one in runs if of_one)

    def variants(self):
        return [variant.name for variant in self.experiment.variants]

    def systems(self):
        """Others, whose trajectories were compared."""
        return [system for system in self.experiment.others if any(run.variant == system for run in self.runs)]

    def typical(self, sequence, variant):
        """Of the starts the one in the middle, by the published map ATE, that did not fail."""
        runs = [run for run in self.of(sequence, variant) if run.reason is None]
        key = "map_ate_cm" if runs and runs[0].start is not None else "smoothed_ate_cm"
        runs.sort(key=lambda run: self.values[run.name][key])
        return runs[(len(runs) - 1) // 2] if runs else None

    def shown(self, most):
        """The typical runs of all sequences, variants and systems; if there are more than `most`, the worst by the published map ATE."""
        runs = [self.typical(s.name, name) for s in self.sequences() for name in self.variants() + self.systems()]
        runs = [run for run in runs if run is not None]
        worst = sorted(runs, key=lambda run: -self.values[run.name].get("map_ate_cm", 0.0))[:most]
        return [run for run in runs if run in worst]

    def curves(self):
        """ATE against blur, {variant: pieces.curve}, of the variants that have any."""
        points = {variant: [point for run in self.runs if run.variant == variant and run.reason is None for point in run.pieces()]
                  for variant in self.variants()}
        return {variant: pieces.curve(found) for variant, found in points.items() if found}


def _number(value):
    return value if math.isfinite(value) else None


def as_json(results):
    """null is what does not exist; a run that failed has a reason and no figures."""
    def run(one):
        entry = {"sequence": one.sequence, "variant": one.variant, "start": one.start, "failed": one.reason}
        if one.reason is None:
            entry["figures"] = {key: _number(value) for key, value in results.values[one.name].items()}
        return entry

    def median(sequence, name):
        return {key: _number(value) for key, value in results.medians(sequence, name).items()}

    names = results.variants() + results.systems()
    return json.dumps({
        "title": results.experiment.title,
        "runs": [run(one) for one in results.runs],
        "medians": {s.name: {name: median(s.name, name) for name in names if results.of(s.name, name)}
                    for s in results.sequences()},
        "groups": {group: {name: {key: _number(value) for key, value in figures.medians(
                       results.of_group(group, name), figures.OURS).items()} for name in results.variants()}
                   for group in results.groups()},
        "ate_against_blur": {variant: [{"blur_px": blur, "ate_cm": [_number(q) for q in quartiles], "pieces": count}
                                       for blur, quartiles, count in curve] for variant, curve in results.curves().items()},
        "missing_sequences": [s.name for s in results.missing],
    }, indent=1) + "\n"


def as_csv(results):
    """One row for each run; empty is what does not exist."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    keys = [figure.key for figure in figures.OURS]
    writer.writerow(["sequence", "variant", "start", "failed", *keys])
    for run in results.runs:
        values = results.values[run.name] if run.reason is None else {}
        cells = ["%.6g" % values[key] if math.isfinite(values.get(key, math.nan)) else "" for key in keys]
        writer.writerow([run.sequence, run.variant, "" if run.start is None else run.start, run.reason or "", *cells])
    return text.getvalue()
