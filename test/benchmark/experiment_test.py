#!/usr/bin/python3
"""Experiment files, figures and tables of mba_vo_benchmark."""
import math
import pathlib
import sys
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent
TOOLS = FOLDER.parents[1] / "tools"
CONFIG = FOLDER.parents[1] / "config"
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOOLS), str(FOLDER)]
from fakes import InFolder  # noqa: E402
from mba_vo_benchmarking import experiment, figures, page_tables, pieces, plots, published, tables, worst  # noqa: E402
from mba_vo_benchmarking.errors import BenchmarkError  # noqa: E402


class ExperimentFiles(InFolder):
    def assert_says(self, text, *words):
        with self.assertRaises(BenchmarkError) as caught:
            experiment.load(self.write(text))
        for word in ("experiment.yaml", *words):
            self.assertIn(word, str(caught.exception))

    def test_says_what_is_wrong(self):
        self.assert_says("sequence: {a: b}", "sequence", "no such key", "sequences")
        self.assert_says("title: x", "sequences", "missing")
        self.assert_says("sequences: {a: {pth: b}}", "sequences.a.pth", "allowed: path")
        self.assert_says("sequences: {a: {options: --live}}", "sequences.a.path", "missing")
        self.assert_says("sequences: {a: {path: 3}}", "sequences.a.path", "'3'", "must be text")
        self.assert_says("sequences: {a: b}\nstarts: [0, -5]", "starts[1]", "'-5'", "0 or more")
        self.assert_says("sequences: {a: b}\nstarts: 3", "starts", "'3'", "list")
        self.assert_says("sequences: {a: b}\nstarts: [1, 1]", "starts[1]", "once")
        self.assert_says("sequences: {a: b}\noptions: --skip 3", "options", "--skip", "itself")
        self.assert_says("sequences: {a: b}\nvariants: {v: {options: '\"'}}", "variants.v.options", "command line")
        self.assert_says("sequences: {a: b}\nvariants: {a/b: {}}", "a/b", "without '/'")
        self.assert_says("sequences: {a: b}\ntime_limit: 0", "time_limit", "'0'", "at least 1")
        self.assert_says("sequences: {a: b}\nothers: {DSO: {c: d}}", "others.DSO.c", "allowed: a")
        self.assert_says("sequences: {a: b, a: c}", "'a' is there twice")
        self.assert_says("sequences: [", "no YAML", "line 1")

    def test_reads_all(self):
        self.write("tracker: {levels: 3}", "few.yaml")
        read = experiment.load(self.write("""
            data: data
            options: [--live, --frames, 30]
            starts: [0, 10]
            sequences:
              short: x
              long: {path: y, groundtruth: y/truth.txt, options: --exposure 0.02, config: {tracker: {levels: 4, other: 1}}}
            variants: {few: {config: few.yaml}}
            others: {DSO: {short: dso.txt}}
            """))
        short, long = read.sequences
        self.assertEqual(short.path, self.folder / "data/x")
        self.assertEqual(short.groundtruth, short.path)
        self.assertEqual(long.groundtruth, self.folder / "data/y/truth.txt")
        self.assertEqual(read.options, ("--live", "--frames", "30"))
        self.assertEqual(read.others, {"DSO": {"short": self.folder / "dso.txt"}})
        self.assertEqual(experiment.merged(long.config, read.variants[0].config), {"tracker": {"levels": 3, "other": 1}})

    def test_the_last_of_equal_options_counts(self):
        self.assertEqual(experiment.options_of(["--live", "--exposure", "auto"], ["--skip=3"], ["--exposure", "0"]),
                         ["--live", "--exposure", "0", "--skip", "3"])

    def test_shipped_experiments_are_right(self):
        files = sorted((CONFIG / "experiments").glob("*.yaml"))
        table = CONFIG / "experiments" / "published.yaml"
        self.assertIn(table, files)
        known = {name for system in published.load(table) for name in system.ate_cm}
        for file in files:
            if file != table:
                read = experiment.load(file)
                if read.published:
                    self.assertTrue(known & {sequence.published for sequence in read.sequences}, file)


class Figures(InFolder):
    def test_failures_count_as_the_worst(self):
        good = dict(figures.worst(figures.OURS), map_ate_cm=2.0, in_time_percent=80.0)
        bad = figures.worst(figures.OURS)
        self.assertEqual(figures.medians([good, good, bad], figures.OURS)["map_ate_cm"], 2.0)
        self.assertEqual(figures.medians([good, bad, bad], figures.OURS)["map_ate_cm"], math.inf)
        self.assertEqual(figures.medians([good, bad, bad], figures.OURS)["in_time_percent"], 0.0)
        self.assertTrue(math.isnan(figures.medians([good, bad], figures.OURS)["tracking_ms"]))

    def test_shown(self):
        ate = figures.CAUSAL[0]
        self.assertEqual([figures.shown(ate, value) for value in (0.0123456, 1.234, 123.4, math.inf, math.nan)],
                         ["0.0123", "1.23", "123", "fail", ""])

    def test_pieces_by_blur(self):
        (self.folder / "groundtruth.txt").write_text("# t\n" + "".join("%g 0 0 0 0 0 0 1\n" % (t / 10) for t in range(120)))
        (self.folder / "blur_px.txt").write_text("".join("%d\n" % (5 if t < 50 else t - 50) for t in range(120)))
        cut = pieces.of_sequence(self.folder)
        self.assertEqual([len(lines) for lines, _ in cut], [50, 50])  # what is left has less than 2 s
        self.assertEqual(cut[0][1], 5.0)
        self.assertAlmostEqual(cut[1][1], 0.9 * 49)
        (self.folder / "blur_px.txt").write_text("5\n")
        self.assertEqual(pieces.of_sequence(self.folder), [])

    def test_few_poses_are_no_ate_of_a_piece(self):
        truth = ["%g 0 0 0 0 0 0 1\n" % t for t in range(10)]
        pieces.write(self.folder, [(truth, 7.0)] * 3)
        for index, text in enumerate(("{rmse: 0.02, count: 5}", "{rmse: 0.001, count: 4}", "{rmse: .nan, count: 0}")):
            (self.folder / pieces.FOLDER / ("%03d.yaml" % index)).write_text("ate: " + text)
        self.assertEqual(pieces.read(self.folder), [(7.0, 2.0), (7.0, math.inf), (7.0, math.inf)])

    def test_quartiles_by_blur(self):
        curve = pieces.curve([(5.0, ate) for ate in (1.0, 2.0, 3.0, 4.0, 5.0)] + [(55.0, 1.0), (55.0, math.inf), (70.0, 1.0)])
        self.assertEqual(curve, [(5.0, [2.0, 3.0, 4.0], 5), (55.0, [math.inf, math.inf, math.inf], 2)])

    def test_the_picture_shows_where_runs_failed(self):
        good, bad = [1.0, 2.0, 3.0], [math.inf] * 3
        picture = plots.ate_against_blur({"a": [(5.0, good, 3), (15.0, bad, 3), (25.0, good, 3)], "b": [(5.0, good, 3)]})
        self.assertIn("a: failed", picture)
        self.assertNotIn("b: failed", picture)

    def test_tables_hold_what_would_end_a_cell(self):
        table = tables.Table("A", "", ["x"], [["a|b <c>"]])
        self.assertIn("| a\\|b <c> |", tables.markdown(table))
        self.assertIn("<td>a|b &lt;c&gt;</td>", tables.as_html(table))


class Worst(unittest.TestCase):
    @staticmethod
    def rows(*online):
        return [{"online_status": status, "reason": "", "blur_px": "", "error_px": str(error)} for status, error in online]

    def test_the_longest_gap_comes_first(self):
        track, lost, shed = ("TRACKING", 0.1), ("LOST", ""), ("SHED", "")
        self.assertEqual(worst.choose(self.rows(lost, lost, lost, track, lost, track, shed, lost, track)), (6, "no pose (SHED)"))
        self.assertEqual(worst.choose(self.rows(track, lost, track, shed))[0], 1)  # of equal ones the first
        self.assertEqual(worst.choose(self.rows(track, track, shed))[0], 2)
        self.assertEqual(worst.choose(self.rows(lost, lost))[0], 0)

    def test_else_the_largest_error(self):
        self.assertEqual(worst.choose(self.rows(("TRACKING", 0.1), ("DEGRADED", 0.3), ("TRACKING", 0.2))), (1, "0.30 px off"))
        self.assertIsNone(worst.choose(self.rows(("TRACKING", ""))))
        self.assertIsNone(worst.choose([]))
        self.assertIsNone(worst.of_run(FOLDER / "nothing_there"))

    def test_options_that_choose_from_the_recording(self):
        self.assertEqual(worst.choices_of(["--live", "--images", "sharp", "--exposure", "0", "--rectified", "--frames", "9"]),
                         ["--images", "sharp", "--rectified"])


class Causal(unittest.TestCase):
    def test_causal_figures_come_first(self):
        self.assertEqual([figure.key for figure in figures.CAUSAL[:4]],
                         ["map_ate_cm", "odom_ate_cm", "in_time_percent", "moving_percent"])
        self.assertTrue(all("smoothed" in figure.title or "dropped" in figure.title for figure in figures.SMOOTHED))
        self.assertIn("published", page_tables.CAUSAL_NOTE)


if __name__ == "__main__":
    unittest.main()
