"""The tables of the pages: causal figures first."""
import math

from . import figures
from .tables import Table

CAUSAL_NOTE = ("As published, when it was published: errors in map and odom after alignment by a similarity; images with a pose within a "
               "frame interval, of all and of those after the first parallax; the first pose after the first parallax.")

GROUPED = [figure for figure in figures.CAUSAL + figures.SMOOTHED
           if figure.key in ("map_ate_cm", "odom_ate_cm", "moving_percent", "first_pose_s", "smoothed_ate_cm")]


def all_tables(results):
    tables = [table for table in (_by_group(results), _curves(results)) if table]
    tables += [_ours(results, "Causal figures", CAUSAL_NOTE, figures.CAUSAL),
              _ours(results, "Smoothed", "With what was known in the end. Dropped: images without a pose.", figures.SMOOTHED)]
    tables += [table for table in (_side_by_side(results), _published_sources(results)) if table]
    tables.append(_ours(results, "Time and memory", "On the cores that a run had; runs were side by side.", figures.TIMES))
    tables.append(_all_runs(results))
    return tables + [table for table in (_failures(results), _missing(results)) if table]


def _by_group(results):
    rows = []
    for group in results.groups():
        for variant in results.variants():
            sequences = results.of_group(group, variant)
            values = figures.medians(sequences, figures.OURS)
            rows.append([group, variant] + [figures.shown(figure, values[figure.key]) for figure in GROUPED] +
                        ["%d of %d" % (results.without_drops(group, variant), len(sequences))])
    note = "Medians over the sequences of a group, of each sequence over its starts. Published figures first; no drops: sequences of which no run dropped an image after its first pose."
    return Table("By group", note, ["group", "variant"] + [figure.title for figure in GROUPED] + ["no drops"], rows) if rows else None


def _starts(results):
    count = len(results.experiment.starts)
    return "" if count == 1 else "medians of %d starts; a run that failed counts as the worst" % count


def _ours(results, title, note, which):
    rows = []
    for sequence in results.sequences():
        for variant in results.variants():
            values = results.medians(sequence.name, variant)
            rows.append([sequence.name, variant] + [figures.shown(figure, values[figure.key]) for figure in which])
    starts = _starts(results)
    return Table(title, note + (" Here: %s." % starts if starts else ""),
                 ["sequence", "variant"] + [figure.title for figure in which], rows)


def _with_drops(ate, dropped):
    """ATE (dropped %), as in the paper's tables."""
    if not ate or ate == "fail" or not dropped:
        return ate
    return "%s (%s %%)" % (ate, dropped)


def _side_by_side(results):
    """Ours beside others: those that were run here, then those that were published."""
    published = results.experiment.published
    names = {sequence.published for sequence in results.experiment.sequences}
    columns = [system for system in published if names & set(system.ate_cm)]
    if not results.systems() and not columns:
        return None
    header = ["sequence"]
    for variant in results.variants():
        header += [variant + ", causal", variant + ", smoothed"]
    header += results.systems() + ["published: " + _column(system) for system in columns]
    rows = []
    for sequence in results.experiment.sequences:
        row = [sequence.name]
        for variant in results.variants():
            row += [_cell(results, sequence.name, variant, "map_ate_cm", None),
                    _cell(results, sequence.name, variant, "smoothed_ate_cm", "dropped_percent")]
        row += [_cell(results, sequence.name, system, "smoothed_ate_cm", "dropped_percent") for system in results.systems()]
        row += [_published_cell(system, sequence.published) for system in columns]
        rows.append(row)
    return Table("Beside others", "ATE [cm] (images dropped, where told). Columns that begin with 'published' were not run here; empty: not known.",
                 header, rows)


def _column(system):
    return "%s (%s)" % (system.name, system.data) if system.data else system.name


def _cell(results, sequence, variant, ate, dropped):
    values = results.medians(sequence, variant)
    if values is None:
        return ""
    by_key = {figure.key: figure for figure in figures.OURS}
    share = figures.shown(by_key[dropped], values[dropped]) if dropped and values[dropped] > 0.0 else ""
    return _with_drops(figures.shown(by_key[ate], values[ate]), share)


def _published_cell(system, name):
    ate = system.ate_cm.get(name, "")
    dropped = system.dropped_percent.get(name, "")
    return _with_drops(ate if isinstance(ate, str) else "%g" % ate, "" if dropped == "" else "%g" % dropped)


def _published_sources(results):
    names = {sequence.published for sequence in results.experiment.sequences}
    columns = [system for system in results.experiment.published if names & set(system.ate_cm)]
    rows = [[_column(system), system.input, system.source] for system in columns]
    return Table("Sources of published figures", "", ["system", "input, speed", "source"], rows) if rows else None


def _curves(results):
    rows = [[variant, "%g" % blur, count] + [_ate(q) for q in quartiles]
            for variant, curve in results.curves().items() for blur, quartiles, count in curve]
    note = "Published ATE of pieces of 5 s, each aligned by itself, by the blur that 90 % of the piece's images stay below (motion within the exposure at 2 m)."
    return Table("ATE against blur, figures", note, ["variant", "blur, middle of 10 px [px]", "pieces", "25 % [cm]", "median [cm]", "75 % [cm]"],
                 rows) if rows else None


def _ate(value):
    return "fail" if math.isinf(value) else figures.centimetres(value)


def _all_runs(results):
    shown = [figure for figure in figures.CAUSAL + figures.SMOOTHED if figure.key not in ("smoothed_rotation_deg",)]
    rows = []
    for run in results.runs:
        if run.start is not None and run.reason is None:
            values = results.values[run.name]
            rows.append([run.sequence, run.variant, run.start] + [figures.shown(figure, values[figure.key]) for figure in shown])
    return Table("All runs", "Start: images left out at the beginning.", ["sequence", "variant", "start"] + [f.title for f in shown], rows)


def _failures(results):
    rows = [[run.name, run.reason] for run in results.runs if run.reason is not None]
    return Table("Failed", "Each was repeated alone.", ["run", "reason"], rows) if rows else None


def _missing(results):
    rows = [[sequence.name, sequence.path] for sequence in results.missing]
    return Table("Not there", "", ["sequence", "path"], rows) if rows else None
