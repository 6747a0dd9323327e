#!/usr/bin/python3
"""What play_bag and the launch files say about bags that cannot be played, and cameras that are not there."""
import os
import socket
import subprocess
import sys
import tempfile
import unittest

import rosbag
import rospy
from std_msgs.msg import String

PLAY_BAG = sys.argv.pop()


class BadBags(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, content):
        with open(os.path.join(self.folder, name), "wb") as file:
            file.write(content)

    def run_in_folder(self, *command):
        return subprocess.run(command, cwd=self.folder, env=dict(os.environ, PWD=self.folder), text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)

    def complaint_about(self, bag):
        played = self.run_in_folder(PLAY_BAG, bag)
        self.assertEqual(played.returncode, 1, played.stdout)
        self.assertIn("bag '%s' cannot be played: " % bag, played.stdout)
        return played.stdout

    def test_a_bag_that_is_cut_off_asks_for_reindexing(self):
        whole = os.path.join(self.folder, "whole.bag")
        with rosbag.Bag(whole, "w") as bag:
            for i in range(100):
                bag.write("/text", String("x" * 1000), rospy.Time(i + 1))
        with open(whole, "rb") as file:
            content = file.read()
        for length in (len(content) // 2, len(content) - 10):
            self.write("cut.bag", content[:length])
            self.assertIn("'rosbag reindex cut.bag' saves what is in it", self.complaint_about("cut.bag"))

    def test_what_is_no_bag_is_named(self):
        self.assertIn("no such file in " + self.folder, self.complaint_about("missing.bag"))
        self.write("text.bag", b"this is no bag, but long enough to be one\n" * 10)
        self.assertNotIn("reindex", self.complaint_about("text.bag"))
        self.write("empty.bag", b"")
        self.assertIn("empty", self.complaint_about("empty.bag"))

    def test_a_relative_path_is_that_of_who_launches(self):
        for launch, bag, expected in (("mba_vo.launch", "/x/y.bag", "/x/y.bag"),
                                      ("demo.launch", "a b.bag", self.folder + "/a b.bag")):
            shown = self.run_in_folder("roslaunch", "--args", "/mba_vo/player", "mba_vo", launch, "bag:=" + bag)
            self.assertIn(" %s __name:=player" % expected, shown.stdout)

    def test_a_device_that_is_not_there_ends_the_launch_and_nothing_else(self):
        with socket.socket() as listener:
            listener.bind(("127.0.0.1", 0))
            port = str(listener.getsockname()[1])
        for _ in range(2):  # `nodelet manager` ended with boost::lock_error in seven of eight
            said = self.run_in_folder("roslaunch", "-p", port, "mba_vo", "webcam.launch", "rviz:=false",
                                      "device:=/dev/video99").stdout
            self.assertIn("/dev/video99: no such device", said)
            self.assertIn("REQUIRED process [camera-", said)
            self.assertNotIn("terminate called", said)


if __name__ == "__main__":
    unittest.main()
