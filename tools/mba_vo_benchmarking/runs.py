"""The runs of an experiment as tasks, and what they found."""
import dataclasses
import re

import yaml

from . import experiment as experiments
from . import figures, fingerprint, pieces, worst
from .errors import BenchmarkError
from .scheduler import Task


@dataclasses.dataclass(frozen=True)
class Run:
    """One run of ours, or the trajectory of another system (variant: its name, start: None)."""
    sequence: str
    variant: str
    start: object
    task: Task
    figures: tuple

    @property
    def reason(self):
        """Why it failed."""
        return self.task.record["reason"]

    @property
    def name(self):
        return self.task.name

    def values(self):
        return figures.read(self.task.folder, self.figures) if self.reason is None else figures.worst(self.figures)

    def pieces(self):
        return pieces.read(self.task.folder)


def of_experiment(experiment, programs, output):
    """Runs of the sequences that are there."""
    there = [sequence for sequence in experiment.sequences if sequence.path.exists()]
    runs = [_ours(experiment, sequence, variant, start, programs, output)
            for sequence in there for variant in experiment.variants for start in experiment.starts]
    others = [_other(sequence, system, files[sequence.name], programs, output)
              for system, files in experiment.others.items() for sequence in there if sequence.name in files]
    folders = [run.task.folder for run in runs + others]
    if len(set(folders)) < len(folders):
        raise BenchmarkError("%s: names of sequences and variants must differ in letters and digits" % experiment.title)
    return runs + others


def missing(experiment):
    return [sequence for sequence in experiment.sequences if not sequence.path.exists()]


def _slug(text):
    return re.sub(r"[^A-Za-z0-9._-]+", "_", text)


def _ours(experiment, sequence, variant, start, programs, output):
    config = experiments.merged(sequence.config, variant.config)
    options = experiments.options_of(experiment.options, sequence.options, variant.options)
    # --images names sharp ones as a rule, whose blur is none
    cut = [] if "--images" in options else pieces.of_sequence(sequence.path)

    def prepare(folder):
        if config:
            (folder / "config.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
        pieces.write(folder, cut)

    def steps(folder):
        command = [programs.offline, sequence.path, "--output", folder, "--deterministic", *options, "--skip", str(start)]
        yield command + (["--config", folder / "config.yaml"] if config else []), False
        yield [programs.evaluate, "--groundtruth", sequence.groundtruth, "--run", folder, "--yaml", folder / "evaluation.yaml",
               "--plot", folder / "trajectory.png", *sequence.evaluation], False
        for command in pieces.commands(programs.evaluate, folder, cut):
            yield command, True
        for command in worst.command(programs.export, sequence.path, folder, start, options):
            yield command, True

    key = fingerprint.combined([
        fingerprint.of_program(programs.offline), fingerprint.of_program(programs.export), options, start, config, len(cut), _truth_key(sequence, programs)])
    name = "%s, %s, start %d" % (sequence.name, variant.name, start)
    folder = output / "runs" / ("%s-%s-%d" % (_slug(sequence.name), _slug(variant.name), start))
    return Run(sequence.name, variant.name, start, Task(name, folder, key, steps, prepare), figures.OURS)


def _other(sequence, system, file, programs, output):
    def steps(folder):
        yield [programs.evaluate, "--groundtruth", sequence.groundtruth, "--estimate", file, "--yaml", folder / "evaluation.yaml",
               "--plot", folder / "trajectory.png", *sequence.evaluation], False

    there = fingerprint.of_sequence(file) if file.exists() else ""
    key = fingerprint.combined([there, _truth_key(sequence, programs)])
    folder = output / "runs" / ("%s-%s-other" % (_slug(sequence.name), _slug(system)))
    return Run(sequence.name, system, None, Task("%s, %s" % (sequence.name, system), folder, key, steps), figures.OTHERS)


def _truth_key(sequence, programs):
    truth = fingerprint.of_sequence(sequence.groundtruth) if sequence.groundtruth.exists() else ""
    return [fingerprint.of_program(programs.evaluate), fingerprint.of_sequence(sequence.path), truth,
            list(sequence.evaluation)]
