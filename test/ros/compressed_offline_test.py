#!/usr/bin/python3
"""Images that were compressed without loss give the trajectory of the originals, byte by byte, and are deblurred along it.

compressed_offline_test.py MBA_VO_SIMULATE MBA_VO_OFFLINE MBA_VO_DEBLUR
"""
import csv
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosbag

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
from spoil import compressed_message  # noqa: E402

DEBLUR = sys.argv.pop()
OFFLINE = sys.argv.pop()
SIMULATE = sys.argv.pop()
RAW, COMPRESSED = "/camera/image_raw", "/camera/image_raw/compressed"


def add_compressed(source, target):
    """Each image once more, as PNG."""
    with rosbag.Bag(source) as bag, rosbag.Bag(target, "w") as twins:
        for topic, message, time in bag.read_messages():
            twins.write(topic, message, time)
            if topic == RAW:
                pixels = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
                twins.write(COMPRESSED, compressed_message(pixels, message.header.stamp), time)


class CompressedOffline(unittest.TestCase):
    def test_the_trajectory_is_that_of_the_originals(self):
        with tempfile.TemporaryDirectory() as folder:
            def path(*names):
                return os.path.join(folder, *names)

            def run(*command):
                done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
                self.assertEqual(0, done.returncode, done.stdout)

            run(SIMULATE, "--bag", path("raw.bag"), "--width", "320", "--height", "200", "--fx", "200", "--rate", "20",
                "--duration", "2", "--exposure", "0.01", "--no-cache")
            self.assert_a_camera_is_refused(path("raw.bag"))
            add_compressed(path("raw.bag"), path("twins.bag"))
            for topic in (RAW, COMPRESSED):
                run(OFFLINE, path("twins.bag"), "--output", path(topic.split("/")[-1]), "--image-topic", topic, "--deterministic")
            for name in ("trajectory.txt", "exposure_trajectory.txt", "online_trajectory.txt"):
                with open(path("image_raw", name), "rb") as raw, open(path("compressed", name), "rb") as compressed:
                    poses = raw.read()
                    self.assertGreater(poses.count(b"\n"), 20, name)
                    self.assertEqual(poses, compressed.read(), name)
            run(DEBLUR, path("twins.bag"), "--run", path("compressed"), "--output", path("sharp"), "--image-topic",
                COMPRESSED, "--skip", "20", "--frames", "6")
            with open(path("sharp", "deblur.csv")) as table:
                self.assertEqual(6, len(list(csv.DictReader(table))))
            self.assert_refused(DEBLUR, path("twins.bag"), "--image-topic", RAW, "--run", path("none"), "--output",
                                path("sharp"), expected=path("none", "exposure_trajectory.txt") + ": cannot be read")

    def assert_a_camera_is_refused(self, bag):
        """For there is no calibration that tells of several."""
        self.assert_refused(OFFLINE, bag, "--output", os.devnull, "--camera", "cam1",
                            expected="--camera cam1: for a bag it chooses from --calibration, which is not told")

    def assert_refused(self, *command, expected):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        self.assertEqual(1, done.returncode, done.stdout)
        self.assertIn(expected, done.stdout)


if __name__ == "__main__":
    unittest.main()
