"""Exposure times in messages of any type: which field of which message, in which unit."""
import json
import re

import genpy
import genpy.dynamic


class FieldError(Exception):
    """A field cannot be read; says which, and what there is instead."""


def _step(value, part):
    """What `part`, a name or an index, is of a message, a list, or of JSON, which begins where text is stepped into."""
    if isinstance(value, str):
        try:
            value = json.loads(value)
        except ValueError:
            raise FieldError("'%s' is asked of a text that is no JSON: '%.60s'" % (part, value))
    if isinstance(value, genpy.Message):
        if part in value.__slots__:
            return getattr(value, part)
        raise FieldError("%s has no field '%s'; it has: %s" % (value._type, part, ", ".join(value.__slots__)))
    if isinstance(value, dict):
        if part in value:
            return value[part]
        raise FieldError("the JSON has no '%s'; it has: %s" % (part, ", ".join(sorted(map(str, value)))))
    if isinstance(value, (list, tuple, bytes)) and part.isdigit():
        if int(part) < len(value):
            return value[int(part)]
        raise FieldError("element %s is asked of a list of %d" % (part, len(value)))
    raise FieldError("'%s' is asked of %s" % (part, value))


def read_field(message, path):
    """The value at a path as 'camera.exposure', 'shutter[0]' or 'json_data.actual_exposure'."""
    for part in re.findall(r"[^.\[\]]+", path):
        message = _step(message, part)
    return message


def read_number(message, path):
    """The same as a number; texts are read, durations are seconds."""
    value = read_field(message, path)
    if isinstance(value, (genpy.Duration, genpy.Time)):
        return value.to_sec()
    try:
        if not isinstance(value, bool):
            return float(value)
    except (TypeError, ValueError):
        pass
    raise FieldError("'%s' is no number: '%.60s'" % (path, value))


class MessageDecoder:
    """Makes messages of bytes by the definition that came with them; their packages need not be there."""

    def __init__(self):
        self._classes = {}

    def decode(self, datatype, definition, data):
        if (datatype, definition) not in self._classes:
            self._classes[datatype, definition] = genpy.dynamic.generate_dynamic(datatype, definition)[datatype]
        message = self._classes[datatype, definition]()
        message.deserialize(data)
        return message


class ExposureSource:
    """Where drivers put the exposure time, in which unit [s], and how it belongs to the images."""

    def __init__(self, datatype, field, unit, match):
        self.datatype = datatype  # None = any
        self.field = field
        self.unit = unit
        self.match = match

    def exposure(self, message):
        """[s]; NaN where the driver has not filled it in. Raises FieldError."""
        if self.datatype not in (None, message._type):
            raise FieldError("the preset reads %s, this is %s: tell field and unit" % (self.datatype, message._type))
        value = self.unit * read_number(message, self.field)
        return value if value > 0.0 else float("nan")


# Definitions as published by the drivers.
PRESETS = {
    # realsense2_camera, <stream>/metadata. Of infrared and depth in microseconds; the colour cameras of the D400 tell
    # the control of USB video, 100 microseconds.
    "realsense": ExposureSource("realsense2_camera/Metadata", "json_data.actual_exposure", 1e-6, "stamp"),
    "realsense_color": ExposureSource("realsense2_camera/Metadata", "json_data.actual_exposure", 1e-4, "stamp"),
    # pointgrey_camera_driver and its successors for FLIR. Some never fill in the shutter.
    "wfov": ExposureSource("wfov_camera_msgs/WFOVImage", "shutter", 1.0, "stamp"),
    "flir": ExposureSource("image_exposure_msgs/ExposureSequence", "shutter[0]", 1e-6, "stamp"),
    # rpg_dvs_ros, davis_ros_driver: a bare number with every image.
    "davis": ExposureSource("std_msgs/Int32", "data", 1e-6, "arrival"),
    # The numbered images of a VersaVIS camera driver; those with the trigger's stamps follow from another node.
    "versavis": ExposureSource("image_numbered_msgs/ImageNumbered", "exposure", 1e-6, "arrival"),
    # rc_visard_driver, rc_genicam_driver: camera_param.
    "roboception": ExposureSource("rc_common_msgs/CameraParam", "exposure_time", 1.0, "stamp"),
    # pylon_camera of Basler: currentParams, with enable_current_params_publisher. The setting, not the image's own.
    "pylon": ExposureSource("camera_control_msgs/currentParams", "exposure", 1e-6, "latest"),
    # Bags of TUM-VI: nanoseconds in the name of the frame.
    "tumvi": ExposureSource("sensor_msgs/Image", "header.frame_id", 1e-9, "stamp"),
}
