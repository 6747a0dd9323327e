#!/usr/bin/python3
"""What the launch files make of their arguments, as roslaunch understands them; nothing is started."""
import os
import unittest

import roslaunch.config
import rospkg

FOLDER = "/where/roslaunch/is/started"
PACKAGE = rospkg.RosPack().get_path("mba_vo")


def launched(name, *arguments):
    """Parameters by name, and nodes by full name."""
    config = roslaunch.config.load_config_default([(os.path.join(PACKAGE, name), list(arguments))], None, verbose=False)
    parameters = {key: parameter.value for key, parameter in config.params.items()}
    return parameters, {node.namespace + node.name: node for node in config.nodes}


class LaunchFiles(unittest.TestCase):
    def setUp(self):
        os.environ["PWD"] = FOLDER
        os.environ["HOME"] = "/home/somebody"

    def test_webcam_passes_on_what_the_camera_takes(self):
        parameters, _ = launched("launch/webcam.launch", "max_exposure:=0.01", "read_out:=0.026", "dynamic_frame_rate:=true",
                                 "color:=true", "camera_frame:=eye")
        expected = {"max_exposure": 0.01, "read_out": 0.026, "dynamic_frame_rate": True, "color": True, "frame_id": "eye"}
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


if __name__ == "__main__":
    unittest.main()
