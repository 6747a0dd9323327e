#!/usr/bin/python3
"""Miniatures of six data sets: mba_vo_offline runs over each with no option but the folder, and stamps, exposures and true
poses are those of a reading that shares no code with it.

  miniatures_test.py FOLDER_OF_THE_PROGRAMS
"""
import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(FOLDER))
import miniatures  # noqa: E402

PROGRAMS = None
SIZE = [320, 200]
INTRINSICS = [200.0, 200.0, 159.5, 99.5]
KINECT = ["--width", 640, "--height", 480, "--max-step", 2, "--exposure", 0.005, "--duration", 1.3, "--rate", 30]


def run(name, *words):
    done = subprocess.run([PROGRAMS / name, *map(str, words)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


class Miniatures(unittest.TestCase):
    def setUp(self):
        self._temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self._temporary.cleanup)
        self.folder = pathlib.Path(self._temporary.name)

    def simulate(self, *options):
        status, said = run("mba_vo_simulate", "--output", self.folder / "simulated", "--no-cache",
                           "--start-time", 1403715273.25, *options)
        self.assertEqual(status, 0, said)
        return miniatures.Simulated(self.folder / "simulated")

    def small(self, model, distortion):
        return self.simulate("--duration", 1.95, "--rate", 20, "--exposure", 0.01, "--width", SIZE[0], "--height", SIZE[1], "--fx", INTRINSICS[0],
                             "--distortion-model", model, *(["--distortion", ",".join(map(str, distortion))] if distortion else []))

    def check(self, root, form, reading):
        stamps, exposures, poses = reading
        self.assertEqual(len(stamps), 40)
        self.compare_export(root, form, stamps, exposures, poses)
        status, said = run("mba_vo_offline", root, "--output", self.folder / "run")
        self.assertEqual(status, 0, said)
        with open(self.folder / "run" / "frames.csv", newline="", encoding="utf-8") as stream:
            frames = list(csv.DictReader(stream))
        self.assertEqual([miniatures._ns(frame["stamp"]) for frame in frames], stamps)
        tracked = [frame for frame in frames if frame["status"] in ("TRACKING", "DEGRADED")]
        self.assertGreater(len(tracked), len(frames) // 2, said)

    def compare_export(self, root, form, stamps, exposures, poses):
        """What the readers found, as mba_vo_export writes it."""
        out = self.folder / "export"
        status, said = run("mba_vo_export", root, "--output", out, "--form", "dso", "--rectify")
        self.assertEqual(status, 0, said)
        self.assertIn(form, said)
        times = miniatures.rows_of(out / "dso" / "times.txt")
        self.assertEqual([miniatures._ns(row[1]) for row in times], stamps)
        for row, exposure in zip(times, exposures or [0.0] * len(times)):
            self.assertAlmostEqual(float(row[2]), 1000 * exposure, places=8)
        true = miniatures.rows_of(out / "dso" / "groundtruth.txt")
        self.assertEqual(len(true), len(poses))
        for row, (time, pose) in zip(true, sorted(poses.items())):
            self.assertAlmostEqual(float(row[0]), time, places=6)
            found = miniatures.matrix(*map(float, row[1:]))
            self.assertLess(max(abs(found[i][j] - pose[i][j]) for i in range(3) for j in range(4)), 1e-7)

    def test_euroc(self):
        distortion = [-0.28, 0.07, 0.0002, 0.00002]
        root = self.folder / "MH_01_easy"
        miniatures.euroc(self.small("plumb_bob", distortion), root, INTRINSICS, SIZE, distortion)
        self.check(root, "EuRoC", miniatures.read_asl(root, "state_groundtruth_estimate0"))

    def test_tum_vi(self):
        distortion = [0.0035, 0.0007, -0.0021, 0.0002]
        root = self.folder / "dataset-room1_512_16"
        miniatures.tum_vi(self.small("equidistant", distortion), root, INTRINSICS, SIZE, distortion)
        self.check(root, "TUM-VI", miniatures.read_asl(root, "mocap0", True))

    def test_tum_mono(self):
        root = self.folder / "sequence_01"
        miniatures.tum_mono(self.small("fov", [0.9]), root, INTRINSICS, SIZE, "0.9")
        self.check(root, "TUM-mono", miniatures.read_mono(root))

    def test_eth3d(self):
        root = self.folder / "camera_shake_1"
        miniatures.eth3d(self.small("plumb_bob", []), root, INTRINSICS)
        self.check(root, "ETH3D", miniatures.read_rgbd(root))

    def test_tum_rgbd(self):
        simulated = self.simulate(*KINECT, "--fx", "517.306408", "--fy", "516.469215", "--cx", "318.643040", "--cy", "255.313989",
                                  "--distortion", "0.262383,-0.953104,-0.005358,0.002628,1.163314")
        root = self.folder / "rgbd_dataset_freiburg1_desk"
        miniatures.tum_rgbd(simulated, root)
        self.check(root, "TUM RGB-D", miniatures.read_rgbd(root))

    def test_seven_scenes(self):
        root = self.folder / "seq-01"
        miniatures.seven_scenes(self.simulate(*KINECT, "--fx", 525), root)
        self.check(root, "7-Scenes", miniatures.read_seven_scenes(root))


if __name__ == "__main__":
    PROGRAMS = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
