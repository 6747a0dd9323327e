#!/usr/bin/python3
"""exposure_relay without a master: messages of the definitions that drivers publish, made byte by byte."""
import importlib.machinery
import importlib.util
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

import genpy
import rosbag
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Int32

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools", "ros")
sys.dont_write_bytecode = True
sys.path.insert(0, FOLDER)
import exposure_matching  # noqa: E402
import exposure_source  # noqa: E402

_loader = importlib.machinery.SourceFileLoader("exposure_relay", os.path.join(FOLDER, "exposure_relay"))
exposure_relay = importlib.util.module_from_spec(importlib.util.spec_from_loader("exposure_relay", _loader))
_loader.exec_module(exposure_relay)

RULE = "\n" + 80 * "=" + "\n"
HEADER = RULE + "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
REGION = RULE + ("MSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\n"
                 "bool do_rectify\n")
IMAGE = "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n"
CAMERA_INFO = RULE + ("MSG: sensor_msgs/CameraInfo\nstd_msgs/Header header\nuint32 height\nuint32 width\n"
                      "string distortion_model\nfloat64[] D\nfloat64[9] K\nfloat64[9] R\nfloat64[12] P\n"
                      "uint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n")
SECONDS, NANOSECONDS = 1700000000, 123456789


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def header(frame="camera", seq=7):
    return struct.pack("<III", seq, SECONDS, NANOSECONDS) + text(frame)


def image(frame="camera"):
    return header(frame) + struct.pack("<II", 2, 3) + text("mono8") + struct.pack("<BI", 0, 3) + text("pixels")


def camera_info():
    return (header() + struct.pack("<II", 2, 3) + text("plumb_bob") + struct.pack("<I5d", 5, *[0.1] * 5) +
            struct.pack("<30d", *range(30)) + struct.pack("<II", 1, 1) + struct.pack("<4IB", 0, 0, 2, 3, 0))


# preset: definition, bytes, exposure [s]
DRIVERS = {
    "realsense": ("std_msgs/Header header\nstring json_data\n" + HEADER,
                  header() + text('{"frame_number":12,"clock_domain":"global_time","actual_exposure":8500,'
                                  '"gain_level":16}'), 0.0085),
    "realsense_color": ("std_msgs/Header header\nstring json_data\n" + HEADER,
                        header() + text('{"actual_exposure":156}'), 0.0156),
    "wfov": ("Header header\nstring time_reference\nsensor_msgs/Image image\nsensor_msgs/CameraInfo info\nfloat32 shutter\n"
             "float32 gain\nuint16 white_balance_blue\nuint16 white_balance_red\nfloat32 temperature\nuint16 frame_counter\n" +
             HEADER + RULE + "MSG: sensor_msgs/Image\n" + IMAGE + CAMERA_INFO + REGION,
             header() + text("") + image() + camera_info() + struct.pack("<ffHHfH", 0.0125, 3.0, 800, 550, 40.0, 9),
             0.0125),
    "flir": ("Header header\nuint32[] shutter\nfloat32 gain\nuint16 white_balance_blue\nuint16 white_balance_red\n" +
             HEADER, header() + struct.pack("<III", 2, 9000, 18000) + struct.pack("<fHH", 1.0, 800, 550), 0.009),
    "davis": ("int32 data\n", struct.pack("<i", 15000), 0.015),
    "versavis": ("Header header\nsensor_msgs/Image image\nuint64 number\nfloat32 exposure\n" + HEADER + RULE +
                 "MSG: sensor_msgs/Image\n" + IMAGE, header() + image() + struct.pack("<Qf", 41, 4000.0), 0.004),
    "roboception": ("std_msgs/Header header\nbool is_color_camera\nfloat32 exposure_time\nfloat32 gain\nfloat32 noise\n"
                    "uint32 line_status_all\nKeyValue[] line_source\n" + HEADER + RULE +
                    "MSG: rc_common_msgs/KeyValue\nstring key\nstring value\n",
                    header() + struct.pack("<BfffII", 0, 0.0075, 1.0, 0.5, 3, 1) + text("out1") + text("Low"), 0.0075),
    "pylon": ("uint32 offset_x\nuint32 offset_y\nbool reverse_x\nbool reverse_y\nint32 black_level\nint32 pgi_mode\n"
              "int32 demosaicing_mode\nfloat32 noise_reduction\nfloat32 sharpness_enhancement\nint32 light_source_preset\n"
              "int32 balance_white_auto\nint32 sensor_readout_mode\nint32 acquisition_frame_count\nint32 trigger_selector\n"
              "int32 trigger_mode\nint32 trigger_source\nint32 trigger_activation\nfloat32 trigger_delay\n"
              "int32 user_set_selector\nint32 user_set_default_selector\nbool is_sleeping\nfloat32 brightness\n"
              "float32 exposure\nfloat32 gain\nfloat32 gamma\nuint32 binning_x\nuint32 binning_y\n"
              "sensor_msgs/RegionOfInterest roi\nstring[] available_image_encoding\nstring current_image_encoding\n"
              "string current_image_ros_encoding\nbool sucess\nstring message\n" + REGION,
              struct.pack("<IIBBiiiffiiiiiiiifii", 0, 0, 0, 0, -10000, -1, -1, -1e4, -1e4, 0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0, 0) +
              struct.pack("<BffffII", 0, 90.0, 20000.0, 1.0, 1.0, 1, 1) + struct.pack("<4IB", 0, 0, 2, 3, 0) +
              struct.pack("<I", 1) + text("Mono8") + text("Mono8") + text("mono8") + struct.pack("<B", 1) + text(""), 0.02),
    "tumvi": (IMAGE + HEADER, image("1234500"), 0.0012345),
}


def decoded(preset):
    definition, data, _ = DRIVERS[preset]
    return exposure_source.MessageDecoder().decode(exposure_source.PRESETS[preset].datatype, definition, data)


class Presets(unittest.TestCase):
    def test_each_has_a_message_here(self):
        self.assertEqual(set(DRIVERS), set(exposure_source.PRESETS))

    def test_exposures_are_read_from_messages_of_the_published_definitions(self):
        for preset, (_, _, exposure) in DRIVERS.items():
            read = exposure_source.PRESETS[preset].exposure(decoded(preset))
            self.assertAlmostEqual(read, exposure, delta=1e-8, msg=preset)

    def test_each_gives_its_image_an_exposure(self):
        for preset, (_, _, exposure) in DRIVERS.items():
            warnings = []
            relay = exposure_relay.Relay(exposure_relay.read_options({"preset": preset}), warnings.append)
            relay.add_message(5.0, decoded(preset))
            if relay.needs_images:
                relay.add_image(5.002, decoded("tumvi"))  # any with a header
            out = relay.take(5.01)
            self.assertEqual(warnings, [], preset)
            self.assertEqual(len(out), 1, preset)
            self.assertEqual(out[0].header.stamp, genpy.Time(SECONDS, NANOSECONDS), preset)
            self.assertAlmostEqual(out[0].exposure_time, exposure, delta=1e-8, msg=preset)

    def test_another_type_is_named(self):
        with self.assertRaisesRegex(exposure_source.FieldError, "wfov_camera_msgs/WFOVImage.*std_msgs/Int32"):
            exposure_source.PRESETS["wfov"].exposure(decoded("davis"))


class Fields(unittest.TestCase):
    def error_of(self, preset, path):
        with self.assertRaises(exposure_source.FieldError) as caught:
            exposure_source.read_number(decoded(preset), path)
        return str(caught.exception)

    def test_paths_lead_through_messages_lists_and_json(self):
        self.assertEqual(exposure_source.read_number(decoded("flir"), "shutter[1]"), 18000.0)
        self.assertEqual(exposure_source.read_number(decoded("wfov"), "info.K[8]"), 8.0)
        self.assertEqual(exposure_source.read_field(decoded("roboception"), "line_source[0].value"), "Low")
        self.assertEqual(exposure_source.read_field(decoded("realsense"), "json_data.clock_domain"), "global_time")

    def test_what_cannot_be_read_is_named_with_what_there_is(self):
        self.assertIn("'exposure'; it has: header, shutter", self.error_of("flir", "exposure"))
        self.assertIn("actual_exposure, clock_domain", self.error_of("realsense", "json_data.exposure"))
        self.assertIn("list of 2", self.error_of("flir", "shutter[2]"))
        self.assertIn("no JSON", self.error_of("tumvi", "encoding.exposure"))
        self.assertIn("'json_data.clock_domain' is no number", self.error_of("realsense", "json_data.clock_domain"))
        self.assertIn("is no number", self.error_of("roboception", "is_color_camera"))

    def test_what_the_driver_does_not_fill_in_is_unknown(self):
        message = decoded("wfov")
        for value in (0.0, -1.0):
            message.shutter = value
            self.assertTrue(math.isnan(exposure_source.PRESETS["wfov"].exposure(message)))

    def test_wrong_units_look_suspicious(self):
        self.assertIsNone(exposure_matching.suspicion(0.012))
        self.assertIsNone(exposure_matching.suspicion(math.nan))
        self.assertIn("unit", exposure_matching.suspicion(12.0))
        self.assertIn("unit", exposure_matching.suspicion(12e-6))


class Matchings(unittest.TestCase):
    """Images at 0, 1, 2, ... with these as stamps and numbers; the exposure of image i is i + 1."""

    def run_through(self, matching, events, end=100.0):
        """What is settled at once at each event, then at the end; events: time, 'i' or 'v', index."""
        settled = []
        for now, kind, index in sorted(events):
            if kind == "i":
                matching.add_image(now, index, index)
            else:
                matching.add_value(now, index + 1.0, index, index)
            settled += matching.take(now)
        return [(stamp, None if math.isnan(exposure) else exposure)
                for stamp, exposure in settled + matching.take(end)]

    def test_arrival_before_after_and_jittering(self):
        for delays in ([0.001] * 6, [-0.001] * 6, [0.005, -0.003, 0.001, 0.012, -0.01, 0.002]):
            events = [(0.03 * i, "i", i) for i in range(6)] + [(0.03 * i + d, "v", i) for i, d in enumerate(delays)]
            matching = exposure_matching.ArrivalMatching(0.05)
            self.assertEqual(self.run_through(matching, events), [(i, i + 1.0) for i in range(6)])

    def test_arrival_with_losses_on_either_side(self):
        events = ([(0.03 * i, "i", i) for i in range(6) if i != 2] +
                  [(0.03 * i + 0.001, "v", i) for i in range(6) if i != 4])
        matching = exposure_matching.ArrivalMatching(0.05)
        self.assertEqual(self.run_through(matching, events), [(0, 1.0), (1, 2.0), (3, 4.0), (4, None), (5, 6.0)])

    def test_arrival_is_settled_as_soon_as_nothing_nearer_can_come(self):
        matching = exposure_matching.ArrivalMatching(0.05)
        matching.add_image(1.0, 0, 0)
        matching.add_value(1.004, 0.5, None, None)
        self.assertEqual(matching.take(1.006), [])
        self.assertEqual(matching.take(1.009), [(0, 0.5)])

    def test_images_wait_no_longer_than_the_timeout_and_keep_their_order(self):
        for name in ("arrival", "sequence", "latest"):
            matching = exposure_matching.MATCHINGS[name](0.05)
            matching.add_image(1.0, 0, 0)
            self.assertEqual(matching.take(1.04), [], name)
            [(stamp, exposure)] = matching.take(1.06)
            self.assertEqual(stamp, 0)
            self.assertTrue(math.isnan(exposure), name)

    def test_values_that_no_image_wants_are_forgotten(self):
        for name in ("arrival", "sequence"):
            matching = exposure_matching.MATCHINGS[name](0.05)
            for i in range(100):
                matching.add_value(0.03 * i, 1.0, None, i)
                matching.take(0.03 * i)
            self.assertLess(len(matching.values), 6, name)

    def test_sequence_with_offset_in_any_order(self):
        events = [(0.01, "v", 3), (0.02, "v", 1), (0.03, "i", 11), (0.04, "i", 12), (0.05, "i", 13)]
        matching = exposure_matching.SequenceMatching(0.5, 10)
        self.assertEqual(self.run_through(matching, events), [(11, 2.0), (12, None), (13, 4.0)])

    def test_latest_holds_until_the_next(self):
        events = [(0.0, "i", 0), (0.1, "v", 6), (0.2, "i", 1), (9.0, "i", 2), (9.1, "v", 8), (9.2, "i", 3)]
        matching = exposure_matching.LatestMatching(0.05)
        self.assertEqual(self.run_through(matching, events), [(0, None), (1, 7.0), (2, 7.0), (3, 9.0)])
        matching.add_image(200.0, 4, 4)
        matching.add_value(200.1, 5.0, None, None)  # came after the image, looked at together
        self.assertEqual(matching.take(200.2), [(4, 9.0)])


class Options(unittest.TestCase):
    def error_of(self, **given):
        with self.assertRaises(exposure_relay.OptionError) as caught:
            exposure_relay.read_options(given)
        return str(caught.exception)

    def test_presets_are_changed_by_what_is_told_beside_them(self):
        options = exposure_relay.read_options({"preset": "realsense", "unit": "1e-4", "match": "", "timeout": 0.2})
        self.assertEqual(options["field"], "json_data.actual_exposure")
        self.assertEqual(options["unit"], 1e-4)
        self.assertEqual(options["match"], "stamp")
        self.assertEqual(options["timeout"], 0.2)

    def test_wrong_ones_are_named(self):
        self.assertIn("unknown parameter 'feild'; allowed: field", self.error_of(feild="x"))
        self.assertIn("preset is 'kinect'; allowed: davis", self.error_of(preset="kinect"))
        self.assertIn("unit is 'us'", self.error_of(field="x", unit="us"))
        self.assertIn("unit is 0", self.error_of(field="x", unit=0))
        self.assertIn("match is 'time'; allowed: arrival", self.error_of(field="x", match="time"))
        self.assertIn("neither field nor preset", self.error_of())


class Bags(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.source, self.target = (os.path.join(folder.name, name) for name in ("in.bag", "out.bag"))
        with rosbag.Bag(self.source, "w") as bag:
            for i in range(5):
                info = CameraInfo()
                info.header.stamp = genpy.Time(100, 40000000 * i)
                bag.write("/info", info, genpy.Time(200, 40000000 * i))
                bag.write("/dvs/exposure", Int32(10000 + i), genpy.Time(200, 40000000 * i + 2000000))

    def relay(self, **topics):
        all_topics = dict({"input": "/dvs/exposure", "image": "/info", "exposure": "/camera/exposure"}, **topics)
        options = exposure_relay.read_options({"preset": "davis"})
        return exposure_relay.relay_bag(options, all_topics, self.source, self.target)

    def test_exposures_are_written_beside_what_was_there(self):
        self.assertEqual(self.relay(), 5)
        with rosbag.Bag(self.target) as bag:
            topics = bag.get_type_and_topic_info().topics
            self.assertEqual(topics["/info"].message_count, 5)
            self.assertEqual(topics["/dvs/exposure"].message_count, 5)
            self.assertEqual(topics["/camera/exposure"].msg_type, "mba_vo/ExposureStamped")
            read = [message for _, message, _ in bag.read_messages("/camera/exposure")]
        self.assertEqual([m.header.stamp.nsecs for m in read], [40000000 * i for i in range(5)])
        for i, message in enumerate(read):
            self.assertAlmostEqual(message.exposure_time, 0.01 + 1e-6 * i)

    def test_topics_that_are_not_there_are_named(self):
        with self.assertRaisesRegex(exposure_relay.OptionError, "image is '/cam'; .* has: /dvs/exposure, /info"):
            self.relay(image="/cam")

    def test_a_bag_without_any_exposure_is_no_success(self):
        with rosbag.Bag(self.source, "w") as bag:
            bag.write("/info", CameraInfo(), genpy.Time(200))
            bag.write("/dvs/exposure", Int32(10000), genpy.Time(300))
        with self.assertRaisesRegex(exposure_relay.OptionError, "no image of .*in.bag gets an exposure"):
            self.relay()
        self.assertFalse(os.path.exists(self.target))


class Master(unittest.TestCase):
    def test_one_that_is_not_there_is_named(self):
        environment = dict(os.environ, ROS_MASTER_URI="http://localhost:1")
        found = subprocess.run([sys.executable, os.path.join(FOLDER, "exposure_relay"), "preset:=davis"], env=environment,
                               capture_output=True, text=True, check=False)
        self.assertEqual(found.returncode, 1)
        self.assertIn("no ROS master at http://localhost:1", found.stderr)


if __name__ == "__main__":
    unittest.main()
