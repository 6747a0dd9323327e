"""mba_vo_benchmark: runs an experiment and writes its pages."""
import argparse
import contextlib
import dataclasses
import fcntl
import os
import pathlib
import shutil
import signal
import sys

from . import experiment as experiments
from . import figures, pages, processes, results, runs
from .errors import BenchmarkError
from .progress import Progress
from .scheduler import Scheduler, remove_leftovers

DESCRIPTION = """Runs mba_vo_offline over sequences, variants and starts, several at a time, and writes tables and plots of what
mba_vo_evaluate says: results.json, results.csv, results.md and results.html. Runs that are there already, with the same
program, options and sequence, are not made again."""


@dataclasses.dataclass(frozen=True)
class Programs:
    offline: str
    evaluate: str
    export: str


def find_programs(folder, beside):
    """In `folder`; if that is None beside this program or on the path."""
    found = []
    for name in ("mba_vo_offline", "mba_vo_evaluate", "mba_vo_export"):
        places = [str(folder)] if folder else [str(beside), *os.environ.get("PATH", "").split(os.pathsep)]
        file = shutil.which(name, path=os.pathsep.join(places))
        if file is None:
            raise BenchmarkError("%s: not in %s; --bin names its folder" % (name, folder or "the folder of this program, nor on the path"))
        found.append(os.path.abspath(file))
    return Programs(*found)


@contextlib.contextmanager
def _locked(folder):
    """Two benchmarks must not write into one folder."""
    folder.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise BenchmarkError("%s: another benchmark is writing there" % folder) from None
    finally:
        os.close(descriptor)


def _describe(task):
    if task.record["reason"] is not None:
        return "failed: " + task.record["reason"]
    values = figures.read(task.folder, figures.CAUSAL)
    other = figures.value_at(figures.load_yaml(task.folder / "evaluation.yaml"), "ate.rmse")
    ate = values["map_ate_cm"] if other != other else 100.0 * other
    return "ATE %s cm, %.0f s" % (figures.shown(figures.CAUSAL[0], ate), task.record["seconds"])


def _write(file, text):
    part = file.with_name(file.name + ".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, file)


def _write_all(found, command, output):
    curves = found.curves()
    curve = ""
    if curves:
        from . import plots  # matplotlib takes a second to load
        curve = plots.ate_against_blur(curves)
        _write(output / "ate_against_blur.svg", curve)
    _write(output / "results.json", results.as_json(found))
    _write(output / "results.csv", results.as_csv(found))
    _write(output / "results.md", pages.as_markdown(found, command, output, curve))
    _write(output / "results.html", pages.as_page(found, command, curve))


def _arguments(words):
    parser = argparse.ArgumentParser(prog="mba_vo_benchmark", description=DESCRIPTION)
    parser.add_argument("file", metavar="FILE.yaml", help="the experiment (docs/benchmark.md)")
    parser.add_argument("--output", metavar="DIR", help="folder for runs and pages (output/benchmark/<name of the file>)")
    parser.add_argument("--data", metavar="DIR", help="folder of the sequences, in place of the experiment's")
    parser.add_argument("--bin", metavar="DIR", help="folder of the programs (where this one is, or the path)")
    parser.add_argument("--jobs", type=int, metavar="N", help="runs side by side (as many as cores may be used)")
    arguments = parser.parse_args(words)
    if arguments.jobs is not None and not 1 <= arguments.jobs <= 1000:
        parser.error("--jobs: %d: must be 1 to 1000" % arguments.jobs)
    return arguments


def _run(arguments, beside, stopped):
    experiment = experiments.load(arguments.file, arguments.data)
    output = pathlib.Path(arguments.output or pathlib.Path("output", "benchmark", pathlib.Path(arguments.file).stem)).resolve()
    missing = runs.missing(experiment)
    for sequence in missing:
        print("%s: %s: not there, left out" % (sequence.name, sequence.path), file=sys.stderr)
    if len(missing) == len(experiment.sequences):
        raise BenchmarkError("%s: none of its sequences is there; --data names their folder" % arguments.file)
    programs = find_programs(arguments.bin, beside)
    cores = processes.usable_cores()
    with _locked(output):
        remove_leftovers(output / "runs")
        found = runs.of_experiment(experiment, programs, output)
        scheduler = Scheduler(cores, arguments.jobs or len(cores), experiment.time_limit, Progress(_describe), stopped)
        scheduler.run([run.task for run in found])
        _write_all(results.Results(experiment, found, missing), "mba_vo_benchmark %s" % arguments.file, output)
    failed = sum(run.reason is not None for run in found)
    print("%d runs, %d failed: %s" % (len(found), failed, output / "results.html"))
    return 1 if failed == len(found) else 0


def main(words, beside):
    """Exit status: 0 if at least one run succeeded, 1 with a message, 130 if interrupted."""
    signals = []
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda arrived, _: signals.append(arrived))
    try:
        return _run(_arguments(words), beside, lambda: bool(signals))
    except BenchmarkError as error:
        print("mba_vo_benchmark: %s" % error, file=sys.stderr)
        return 1
    except OSError as error:
        print("mba_vo_benchmark: %s: %s" % (error.filename or "a file", error.strerror), file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\nmba_vo_benchmark: interrupted; the runs that are finished are kept", file=sys.stderr)
        return 130
