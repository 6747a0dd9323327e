#!/usr/bin/python3
"""What the launch files make of their arguments, as roslaunch understands them; nothing is started."""
import os
import re
import unittest

import numpy as np
import roslaunch.config
import rospkg

FOLDER = "/where/roslaunch/is/started"
PACKAGE = rospkg.RosPack().get_path("mba_vo")


def read(name):
    with open(os.path.join(PACKAGE, name), encoding="utf-8") as file:
        return file.read()


def launched(name, *arguments):
    """Parameters by name, and nodes by full name."""
    config = roslaunch.config.load_config_default([(os.path.join(PACKAGE, name), list(arguments))], None, verbose=False)
    parameters = {key: parameter.value for key, parameter in config.params.items()}
    return parameters, {node.namespace + node.name: node for node in config.nodes}


def rotation(axis, angle):
    """About the axis x, y or z, by its number."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i] = np.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix


class LaunchFiles(unittest.TestCase):
    def setUp(self):
        os.environ["PWD"] = FOLDER
        os.environ["HOME"] = "/home/somebody"

    def test_webcam_passes_on_what_the_camera_takes(self):
        parameters, _ = launched("launch/webcam.launch", "max_exposure:=0.01", "read_out:=0.026", "dynamic_frame_rate:=true",
                                 "color:=true", "camera_frame:=eye", "calibration_camera:=cam1")
        expected = {"max_exposure": 0.01, "read_out": 0.026, "dynamic_frame_rate": True, "color": True, "frame_id": "eye",
                    "calibration_camera": "cam1"}
        self.assertEqual(expected, {key: parameters["/camera/" + key] for key in expected})

    def test_webcam_passes_on_what_the_odometry_takes(self):
        parameters, nodes = launched("launch/webcam.launch", "extrinsic:=0.1 0 0 -1.5708 0 -1.5708", "base_frame:=robot",
                                     "camera_frame:=eye", "publish_tf:=false", "tf_prediction:=0.2", "save_on_shutdown:=true")
        expected = {"base_frame": "robot", "publish_tf": False, "tf_prediction": 0.2, "save_on_shutdown": True}
        self.assertEqual(expected, {key: parameters["/mba_vo/" + key] for key in expected})
        self.assertEqual("0.1 0 0 -1.5708 0 -1.5708 robot eye", nodes["/mba_vo/extrinsic"].args)

    def test_a_device_is_a_number_or_a_path_from_where_one_launches(self):
        for device, path in (("0", "0"), ("12", "12"), ("/dev/video0", "/dev/video0"),
                             ("~/v.mp4", "/home/somebody/v.mp4"), ("2024-walk.mp4", FOLDER + "/2024-walk.mp4"),
                             ("a b.mp4", FOLDER + "/a b.mp4"), ("../walk", FOLDER + "/../walk")):
            parameters, _ = launched("launch/webcam.launch", "device:=" + device)
            self.assertEqual(path, parameters["/camera/device"])

    def test_rviz_shows_the_namespace_and_the_map_frame_that_are_told(self):
        _, nodes = launched("launch/mba_vo.launch", "ns:=left", "map_frame:=left_map", "rviz:=true")
        rviz = nodes["/left/rviz"]
        self.assertIn('-f "left_map"', rviz.args)
        shown = set(re.findall(r"Topic: (\S+)", read("rviz/mba_vo.rviz")))
        self.assertEqual({(topic, topic.replace("/mba_vo/", "")) for topic in shown}, set(map(tuple, rviz.remap_args)))

    def test_what_ends_is_started_again_but_where_a_bag_is_played(self):
        for arguments, required in (((), False), (("bag:=x.bag",), True), (("bag:=x.bag", "required:=false"), False),
                                    (("required:=true",), True)):
            _, nodes = launched("launch/mba_vo.launch", *arguments)
            for name in ("mapping", "tracking"):
                self.assertEqual((required, not required), (nodes["/mba_vo/" + name].required, nodes["/mba_vo/" + name].respawn))
            self.assertEqual(not required, nodes["/mba_vo/manager"].respawn)

    def test_all_frames_can_be_told(self):
        frames = {name + "_frame": "left_" + name for name in ("map", "odom", "base", "exposure_start", "exposure_end")}
        parameters, _ = launched("launch/mba_vo.launch", *("%s:=%s" % item for item in frames.items()))
        self.assertEqual(frames, {key: parameters["/mba_vo/" + key] for key in frames})

    def test_the_example_of_a_camera_fits_together(self):
        parameters, nodes = launched("examples/camera.launch", "rviz:=false")
        self.assertEqual({"/camera", "/camera_on_base", "/mba_vo/manager", "/mba_vo/mapping", "/mba_vo/tracking"}, set(nodes))
        self.assertIn(["image", "/camera/image_raw"], nodes["/mba_vo/tracking"].remap_args)
        base, camera = nodes["/camera_on_base"].args.split()[-2:]
        self.assertEqual((parameters["/mba_vo/base_frame"], parameters["/camera/camera_frame_id"]), (base, camera))
        self.assertEqual("start", parameters["/mba_vo/stamp_reference"])

    def test_the_transform_of_the_example_looks_ahead(self):
        _, nodes = launched("examples/camera.launch")
        yaw, pitch, roll = map(float, nodes["/camera_on_base"].args.split()[3:6])
        axes = rotation(2, yaw) @ rotation(1, pitch) @ rotation(0, roll)  # of the image on the base
        right, down, ahead = [0, -1, 0], [0, 0, -1], [1, 0, 0]
        np.testing.assert_allclose(axes, np.transpose([right, down, ahead]), atol=1e-4)


if __name__ == "__main__":
    unittest.main()
