#!/usr/bin/python3
"""Watches the live odometry until interrupted, then prints how late its poses were and what became of the images.

Latency is the time on the wall from the arrival of an image's camera_info, which is sent with the image, to the arrival
of its exposure_motion.
"""
import argparse
import time

import rosgraph
import rospy
from sensor_msgs.msg import CameraInfo

from mba_vo.msg import ExposureMotion, Status

COUNTS = ("in", "tracked", "degraded", "initializing", "lost", "rejected", "shed", "missing")


class LiveReport:
    def __init__(self, namespace, camera_info):
        self._arrival = {}  # stamp [ns] -> steady clock [s]
        self._latency = []  # [s]
        self._poses = 0
        self._status = None
        queue = {"queue_size": 1000, "tcp_nodelay": True}
        self._subscribers = [
            rospy.Subscriber(camera_info, CameraInfo, self._on_camera_info, **queue),
            rospy.Subscriber(namespace + "/exposure_motion", ExposureMotion, self._on_motion, **queue),
            rospy.Subscriber(namespace + "/status", Status, self._on_status, **queue),
        ]

    def _on_camera_info(self, info):
        self._arrival[info.header.stamp.to_nsec()] = time.monotonic()

    def _on_motion(self, motion):
        self._poses += 1
        arrival = self._arrival.get(motion.header.stamp.to_nsec())
        if arrival is not None:
            self._latency.append(time.monotonic() - arrival)

    def _on_status(self, status):
        self._status = status

    def _frame_interval(self):
        stamps = sorted(self._arrival)
        intervals = sorted(b - a for a, b in zip(stamps, stamps[1:]))
        return 1e-9 * intervals[len(intervals) // 2] if intervals else float("nan")

    def print(self):
        if self._status is not None:
            print("frames: " + ", ".join("%s %d" % (name, getattr(self._status, "frames_" + name)) for name in COUNTS)
                  + ", shed by the mapper %d" % self._status.mapper.frames_shed)
        print("seen: %d images, %d poses" % (len(self._arrival), self._poses))
        latency = sorted(self._latency)
        if not latency:
            print("latency: no pose was seen")
            return
        interval = self._frame_interval()
        in_time = sum(value <= interval for value in latency)
        print("latency [ms]: median %.1f, 95 %% %.1f, max %.1f; %.1f %% of %d poses within one frame interval (%.1f ms)"
              % (1e3 * latency[len(latency) // 2], 1e3 * latency[int(0.95 * (len(latency) - 1))], 1e3 * latency[-1],
                 100.0 * in_time / len(latency), len(latency), 1e3 * interval))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--namespace", default="/mba_vo", help="of the odometry")
    parser.add_argument("--camera-info", default="/camera/camera_info", help="topic")
    arguments = parser.parse_args()
    while not rosgraph.is_master_online():
        time.sleep(0.1)
    rospy.init_node("live_report", anonymous=True)
    report = LiveReport(arguments.namespace, arguments.camera_info)
    try:
        while not rospy.is_shutdown():
            time.sleep(0.1)
    except KeyboardInterrupt:
        pass
    report.print()


if __name__ == "__main__":
    main()
