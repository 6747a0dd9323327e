"""The page of results, from a folder of runs that were never made."""
import json
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
STARTS = [0, 10, 20]


def run(variant, start, ate_cm):
    figures = {"map_ate_cm": ate_cm, "odom_ate_cm": 2 * ate_cm, "smoothed_ate_cm": ate_cm / 2, "in_time_percent": 90.0,
               "moving_percent": 95.0, "first_pose_s": 0.5, "latency_95_ms": 12.0, "dropped_after_first": 0.0}
    return {"sequence": "room", "variant": variant, "start": start, "failed": None, "figures": figures}


def failed(variant, start):
    return {"sequence": "room", "variant": variant, "start": start, "failed": "lost its way"}


class ResultsPage(unittest.TestCase):
    def page(self, runs, environment=None):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "blurred").mkdir()
            (folder / "blurred" / "results.json").write_text(json.dumps({"runs": runs}))
            (folder / "blurred.yaml").write_text(json.dumps({"starts": STARTS, "sequences": {"room": {"path": str(folder / "none")}}}))
            (folder / "sequences.txt").write_text("room\ta room that is not there\n")
            command = ["/usr/bin/python3", "-B", str(ROOT / "scripts" / "results_page.py"), name, "--command", "results --of this", "--jobs", "2"]
            return subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout

    def test_medians_with_the_least_and_the_most(self):
        page = self.page([run("live", start, ate) for start, ate in zip(STARTS, (0.2, 0.1, 1.2))])
        self.assertIn("| `room` | 2.0 (1.0-12) | 4.0 (2.0-24) | 90 | 95 | 0.50 | 12 |", page)

    def test_a_run_that_failed_counts_as_the_worst(self):
        self.assertIn("2.0 (1.0-fail)", self.page([run("live", 0, 0.2), run("live", 10, 0.1), failed("live", 20)]))
        self.assertIn("| `room` | fail (1.0-fail)", self.page([run("live", 0, 0.1), failed("live", 10), failed("live", 20)]))

    def test_causal_figures_come_before_smoothed_ones(self):
        page = self.page([run("live", start, 0.1) for start in STARTS])
        self.assertLess(page.index("## As published, live"), page.index("## Smoothed"))
        self.assertLess(page.index("## Smoothed"), page.index("## Time and memory"))

    def test_sources_may_have_come_without_git(self):
        page = self.page([run("live", start, 0.1) for start in STARTS], {"PATH": "/nonexistent"})
        self.assertIn("not known", page)

    def test_the_head_tells_the_command_and_the_page_is_short(self):
        page = self.page([run("live", start, 0.1) for start in STARTS])
        self.assertIn("\n    results --of this\n", page)
        self.assertLess(page.count("\n"), 150)


if __name__ == "__main__":
    unittest.main()
