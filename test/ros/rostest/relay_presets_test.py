#!/usr/bin/python3
"""Every preset of exposure_relay as a node, started as the documentation says, with messages as the drivers publish them."""
import os
import subprocess
import sys
import threading
import time
import unittest

import genpy
import rospy
import rostest
from mba_vo.msg import ExposureStamped
from sensor_msgs.msg import CameraInfo

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from exposure_relay_test import DRIVERS, NANOSECONDS, SECONDS, exposure_source  # noqa: E402

TIMEOUT = 120.0  # [s]
STAMP = genpy.Time(SECONDS, NANOSECONDS)


class Driver:
    """Publishes like the driver of a preset, to a relay of its own, and listens to what that makes of it."""

    def __init__(self, preset):
        definition, data, self.exposure = DRIVERS[preset]
        source = exposure_source.PRESETS[preset]
        kind = genpy.dynamic.generate_dynamic(source.datatype, definition)[source.datatype]
        self._message = kind().deserialize(data)
        self._is_stamped = source.match == "stamp"
        self._come = []
        self._changed = threading.Condition()
        topics = {name: "/%s/%s" % (preset, name) for name in ("input", "image", "exposure")}
        self._input = rospy.Publisher(topics["input"], kind, queue_size=10)
        self._image = rospy.Publisher(topics["image"], CameraInfo, queue_size=10)
        self._subscriber = rospy.Subscriber(topics["exposure"], ExposureStamped, self._on_exposure, queue_size=10)
        self._relay = subprocess.Popen(
            ["rosrun", "mba_vo", "exposure_relay", "preset:=" + preset, "timeout:=5", "__name:=relay_of_" + preset] +
            ["%s:=%s" % item for item in topics.items()], stdin=subprocess.DEVNULL)

    def _on_exposure(self, message):
        with self._changed:
            self._come.append(message)
            self._changed.notify()

    def stop(self):
        self._relay.terminate()
        self._relay.wait()

    def is_connected(self):
        return (self._input.get_num_connections() > 0 and self._subscriber.get_num_connections() > 0 and
                (self._is_stamped or self._image.get_num_connections() > 0))

    def wait_for_relay(self, deadline):
        while not self.is_connected():
            if time.monotonic() > deadline or self._relay.poll() is not None:
                return False
            time.sleep(0.05)
        return True

    def send(self, deadline):
        """Goes on sending, as drivers do: on a busy machine an image may overtake the settings, which hold for those after
        them. The first message that comes back; None if none does."""
        info = CameraInfo()
        info.header.stamp = STAMP
        while time.monotonic() < deadline:
            self._input.publish(self._message)
            if not self._is_stamped:
                time.sleep(0.3)
                self._image.publish(info)
            with self._changed:
                if self._changed.wait_for(lambda: self._come, 2.0):
                    return self._come[0]
        return None


class RelayPresets(unittest.TestCase):
    def test_each_makes_exposures_of_the_messages_of_its_driver(self):
        drivers = {preset: Driver(preset) for preset in exposure_source.PRESETS}
        try:
            deadline = time.monotonic() + TIMEOUT
            for preset, driver in drivers.items():
                self.assertTrue(driver.wait_for_relay(deadline), preset)
                exposure = driver.send(deadline)
                self.assertIsNotNone(exposure, preset)
                self.assertEqual(STAMP, exposure.header.stamp, preset)
                self.assertAlmostEqual(driver.exposure, exposure.exposure_time, delta=1e-8, msg=preset)
        finally:
            for driver in drivers.values():
                driver.stop()


if __name__ == "__main__":
    rospy.init_node("relay_presets_test")
    rostest.rosrun("mba_vo", "relay_presets", RelayPresets)
