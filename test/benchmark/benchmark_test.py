#!/usr/bin/python3
"""mba_vo_benchmark with programs that stand in for the real ones."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent
TOOLS = FOLDER.parents[1] / "tools"
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOOLS), str(FOLDER)]
from fakes import Fakes, InFolder, alive, files_below  # noqa: E402
from mba_vo_benchmarking import experiment  # noqa: E402


class Programs(InFolder):
    def setUp(self):
        super().setUp()
        self.fakes = Fakes(self.folder)
        self.output = self.folder / "out"

    def command(self, *options):
        return [sys.executable, TOOLS / "mba_vo_benchmark", self.folder / "experiment.yaml", "--bin", self.fakes.bin, "--data",
                self.fakes.data, "--output", self.output, *options]

    def run_it(self, *options, status=0):
        done = subprocess.run(self.command(*options), capture_output=True, text=True, timeout=100, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr

    def results(self):
        return json.loads((self.output / "results.json").read_text())

    def pages(self):
        return {name: (self.output / name).read_bytes() for name in ("results.json", "results.csv", "results.md", "results.html")}

    def test_starts_and_variants(self):
        self.fakes.add_sequence("one")
        self.fakes.add_sequence("two", "0.3")
        (self.folder / "dso.txt").write_text("")
        self.write("""
            starts: [1, 5, 3]
            sequences: {one: one, two: {path: two, published: known}, three: three}
            variants: {with: {}, without: {options: --exposure 0, config: {mapper: {window: {max_points: 5}}}}}
            others: {DSO: {two: dso.txt}}
            published: table.yaml
            """)
        self.write("""
            sources: {paper: "A paper, Table 1"}
            figures: [{system: Theirs, source: paper, ate_cm: {known: 4.5, other: 9}, dropped_percent: {known: 7}}]
            """, "table.yaml")
        said = self.run_it("--jobs", "3")
        self.assertIn("three", said)
        self.assertIn("[13/13]", said)
        medians = self.results()["medians"]
        self.assertAlmostEqual(medians["one"]["with"]["map_ate_cm"], 1.3)  # of the starts 1, 3 and 5: the number is their last digit
        self.assertAlmostEqual(medians["two"]["DSO"]["smoothed_ate_cm"], 2.0)
        without = self.output / "runs/two-without-3"
        self.assertIn("--exposure\n0\n--skip\n3\n--config", (without / "options.txt").read_text())
        self.assertIn("max_points: 5", (without / "config.yaml").read_text())
        page = (self.output / "results.md").read_text()
        self.assertRegex(page, r"\| two \| 33.0 \| fail.*\| 2.00 \| 4.5 \(7 %\) \|")
        self.assertRegex(page, r"\| three \| +\|.*\| +\|")
        self.assertIn("| published: Theirs |", page)
        self.assertIn("A paper, Table 1", page)
        self.assertLess(page.index("## Causal figures"), page.index("## Smoothed"))
        html = (self.output / "results.html").read_text()
        self.assertNotIn("src='runs", html)
        self.assertIn("data:image/png;base64,cGljdHVyZQo=", html)

    def test_the_worst_frame_is_shown(self):
        self.fakes.add_sequence("one")
        self.fakes.add_sequence("cannot_be_exported")
        self.write("sequences: {one: {path: one, options: --images sharp --live}, other: cannot_be_exported}\nstarts: [4]")
        self.run_it()
        said = (self.output / "runs/one-mba_vo-4/worst/dso/options.txt").read_text()
        self.assertIn("--skip 6 --frames 1 --images sharp\n", said)
        html = (self.output / "results.html").read_text()
        self.assertIn("src='data:image/png;base64,d29yc3QK'", html)
        self.assertIn("<figcaption>one, mba_vo, start 4, image 6: 0.25 px off, blur of 4.5 px</figcaption>", html)
        page = (self.output / "results.md").read_text()
        self.assertIn("(runs/one-mba_vo-4/worst/dso/images/000000.png)", page)
        self.assertEqual(page.count("/worst/"), 1)
        self.assertIsNone(self.results()["runs"][1]["failed"])  # for want of a picture

    def test_groups_come_first(self):
        for name, ate in (("one", "0.1"), ("two", "0.3"), ("three", "0.2"), ("alone", "0.4")):
            self.fakes.add_sequence(name, ate)
        self.write("""
            sequences:
              one: {path: one, group: 20 ms}
              two: {path: two, group: 20 ms}
              three: {path: three, group: 20 ms}
              alone: alone
            starts: [5]
            variants: {with: {}, without: {}}
            """)
        self.run_it()
        self.assertAlmostEqual(self.results()["groups"]["20 ms"]["with"]["map_ate_cm"], 25.0)
        self.assertEqual(list(self.results()["groups"]), ["20 ms"])
        page = (self.output / "results.md").read_text()
        self.assertRegex(page, r"\| 20 ms \| without \| 25.0 \|")
        self.assertLess(page.index("## By group"), page.index("## Causal figures"))

    def test_of_many_runs_the_worst_are_drawn(self):
        names = ["s%d" % i for i in range(30)]
        for i, name in enumerate(names):
            self.fakes.add_sequence(name, "0.%d" % (100 + i))
        self.write("sequences: {%s}\nstarts: [5]" % ", ".join("%s: %s" % (name, name) for name in names))
        self.run_it()
        page = (self.output / "results.md").read_text()
        self.assertIn("of 30 runs the 24 that are worst", page)
        self.assertNotIn("(runs/s5-mba_vo-5/", page)
        self.assertIn("(runs/s6-mba_vo-5/trajectory.png)", page)

    def test_two_hundred_runs_leave_nothing_behind(self):
        for i in range(20):
            self.fakes.add_sequence("s%d" % i)
        sequences = ", ".join("s%d: s%d" % (i, i) for i in range(20))
        self.write("sequences: {%s}\nstarts: %s" % (sequences, list(range(10))))
        self.run_it("--jobs", "16")
        self.assertEqual(len(self.fakes.made()), 200)
        self.assertEqual(len(list((self.output / "runs").iterdir())), 200)
        self.assertFalse([file for file in files_below(self.output) if file.endswith(".part") or "tmp" in file])
        self.assertEqual({file for file in os.listdir(self.output) if file != "runs"},
                         {"results.json", "results.csv", "results.md", "results.html"})
        self.assertFalse([process for process in self.fakes.processes() if alive(process)])

    def test_failures_are_repeated_alone(self):
        for name in ("good", "broken", "once", "killed"):
            self.fakes.add_sequence(name)
        self.write("sequences: {good: good, broken: broken, once: once, killed: killed}")
        said = self.run_it("--jobs", "2")
        self.assertIn("3 failed: once more", said)
        self.assertEqual(len(self.fakes.made()), 7)
        failed = {run["sequence"]: run["failed"] for run in self.results()["runs"]}
        self.assertEqual(failed["good"], None)
        self.assertEqual(failed["once"], None)
        self.assertIn("spoilt on purpose", failed["broken"])
        self.assertIn("signal 9", failed["killed"])
        self.assertIn("spoilt on purpose", (self.output / "results.md").read_text())
        self.assertEqual(self.results()["medians"]["broken"]["mba_vo"]["map_ate_cm"], None)

    def test_too_long_is_a_failure(self):
        self.fakes.add_sequence("hangs")
        self.write("sequences: {hangs: hangs}\ntime_limit: 1")
        said = self.run_it(status=1)
        self.assertIn("stopped after 1 s", said)
        self.assertFalse([process for process in self.fakes.processes() if alive(process)])

    def test_makes_only_what_has_changed(self):
        one = self.fakes.add_sequence("one")
        self.fakes.add_sequence("two")
        self.write("sequences: {one: one, two: two}\nstarts: [1, 2]")
        self.run_it()
        first = self.pages()
        self.assertIn("4 of 4 runs are there", self.run_it())
        self.assertEqual(len(self.fakes.made()), 4)
        self.assertEqual(first, self.pages())
        (one / "image.png").write_text("another")
        self.run_it()
        self.assertEqual(len(self.fakes.made()), 6)
        self.write("sequences: {one: one, two: {path: two, options: --live}}\nstarts: [1, 2]")
        self.run_it()
        self.assertEqual(len(self.fakes.made()), 8)
        program = self.fakes.bin / "mba_vo_offline"
        program.write_text(program.read_text() + "# changed\n")
        self.run_it()
        self.assertEqual(len(self.fakes.made()), 12)

    def interrupt(self, number, running):
        """Starts, waits until so many runs hang, and sends the signal."""
        os.mkfifo(self.fakes.children)  # each run that hangs writes a line
        process = subprocess.Popen(self.command("--jobs", str(running)), stderr=subprocess.PIPE, text=True)
        guard = threading.Timer(100, process.kill)
        guard.start()
        children = []
        with os.fdopen(os.open(self.fakes.children, os.O_RDWR), encoding="ascii") as lines:  # so that opening waits for nobody
            while len(children) < running:
                children.append(int(lines.readline()))
            process.send_signal(number)
            said = process.communicate()[1]
        guard.cancel()
        os.remove(self.fakes.children)
        return process.returncode, said, children

    def test_nothing_is_left_of_an_interrupted_run(self):
        for index in range(40):
            self.fakes.add_sequence("hangs%d" % index)
        good = ["good%d" % index for index in range(160)]
        for name in good:
            self.fakes.add_sequence(name)
        names = good + ["hangs%d" % index for index in range(40)]
        self.write("sequences:\n" + "".join("  %s: %s\n" % (name, name) for name in names))
        status, said, children = self.interrupt(signal.SIGINT, 40)
        self.assertEqual(status, 130)
        self.assertIn("interrupted", said)
        self.assertEqual([p for p in children + self.fakes.processes() if alive(p)], [])
        self.assertEqual([file for file in files_below(self.output) if ".part" in file or "hangs" in file], [])
        self.assertEqual(len(list((self.output / "runs").iterdir())), 160)

    def test_resumed_and_uninterrupted_give_the_same(self):
        for name in ("a", "b", "hangs"):
            self.fakes.add_sequence(name)
        self.write("sequences: {a: a, hangs: hangs, b: b}")
        self.interrupt(signal.SIGTERM, 1)
        self.assertEqual(len(list((self.output / "runs").iterdir())), 1)
        program = self.fakes.bin / "mba_vo_offline"
        times = os.stat(program)
        (self.fakes.data / "hangs").rename(self.fakes.data / "c")
        self.write("sequences: {a: a, hangs: c, b: b}")
        os.utime(program, ns=(times.st_atime_ns, times.st_mtime_ns))
        self.assertIn("1 of 3 runs are there", self.run_it())
        resumed = self.pages()
        self.output = self.folder / "again"
        self.run_it()
        self.assertEqual(resumed, self.pages())

    def test_what_a_killed_benchmark_leaves_goes(self):
        self.fakes.add_sequence("hangs")
        self.write("sequences: {hangs: hangs}\ntime_limit: 1")
        status, _, _ = self.interrupt(signal.SIGKILL, 1)
        self.assertEqual(status, -signal.SIGKILL)
        (self.fakes.data / "hangs").rename(self.fakes.data / "fine")
        self.write("sequences: {fine: fine}")
        self.run_it()
        self.assertEqual([file for file in files_below(self.output) if ".part" in file], [])

    def test_two_do_not_write_into_one_folder(self):
        self.fakes.add_sequence("one")
        self.write("sequences: {one: one}")
        self.output.mkdir()
        with subprocess.Popen(["flock", self.output, "sh", "-c", "echo locked; read line"], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE) as other:
            other.stdout.readline()
            self.assertIn("another benchmark", self.run_it(status=1))
            other.communicate(b"\n")

    def test_says_what_is_missing(self):
        self.write("sequences: {one: one}")
        self.assertIn("none of its sequences is there", self.run_it(status=1))
        self.fakes.add_sequence("one")
        os.remove(self.fakes.bin / "mba_vo_evaluate")
        self.assertIn("mba_vo_evaluate: not in", self.run_it(status=1))


if __name__ == "__main__":
    unittest.main()
