#!/usr/bin/python3
"""Makes bags that are each spoilt in one way, and looks whether mba_vo_check names what was done.

    scripts/spoil.py --output FOLDER [--check PROGRAM] [--only NAME]

Needs devel/setup.bash sourced, for the message mba_vo/ExposureStamped. Exit status 1 if a fault was not named, if another
problem was seen where there is none, or if the program crashed.
"""
import argparse
import os
import re
import struct
import subprocess
import sys
import zlib

import numpy as np
import rosbag
from genpy import Time
from mba_vo.msg import ExposureStamped
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Float64, String

WIDTH, HEIGHT = 128, 96  # [px]
FRAMES = 40
INTERVAL = 1.0 / 30.0  # [s]
START = 1700000000.0  # [s]
EXPOSURE = 0.010  # [s]
IMAGE, INFO, EXPOSURES = "/camera/image_raw", "/camera/camera_info", "/camera/exposure"


def scene():
    """Blocks of random brightness, linear light, 0..1."""
    random = np.random.default_rng(1)
    small = np.kron(random.uniform(0.0, 0.4, (60, 80)), np.ones((6, 6)))
    large = np.kron(random.uniform(0.1, 0.4, (9, 12)), np.ones((40, 40)))
    return small + large


SCENE = scene()
NOISE = np.random.default_rng(2)


def view(i):
    """What the camera sees in image i, 0..1: it moves to and fro by some pixels an image."""
    x = int(round(120 + 60 * np.sin(0.15 * i)))
    y = int(round(90 + 40 * np.cos(0.11 * i)))
    return SCENE[y : y + HEIGHT, x : x + WIDTH]


def grey(light):
    noisy = 255 * light + NOISE.normal(0, 1, light.shape)
    return np.clip(np.round(noisy), 0, 255).astype(np.uint8)


def blurred(light, size=25):
    kernel = np.ones(size) / size
    for _ in range(2):
        light = np.apply_along_axis(lambda v: np.convolve(v, kernel, "same"), 1, light).T
    return light


def image_message(pixels, stamp, encoding="mono8"):
    message = Image(height=pixels.shape[0], width=pixels.shape[1], encoding=encoding, step=pixels.strides[0])
    message.header.stamp = stamp
    message.data = pixels.tobytes()
    return message


def info_message(stamp, width=WIDTH, height=HEIGHT, focal=110.0):
    message = CameraInfo(width=width, height=height, distortion_model="plumb_bob", D=[0.0] * 5)
    message.header.stamp = stamp
    message.K = [focal, 0, (width - 1) / 2, 0, focal, (height - 1) / 2, 0, 0, 1]
    message.P = [focal, 0, (width - 1) / 2, 0, 0, focal, (height - 1) / 2, 0, 0, 0, 1, 0]
    return message


def exposure_message(stamp, seconds):
    message = ExposureStamped(exposure_time=seconds)
    message.header.stamp = stamp
    return message


def png(pixels):
    """8-bit grey."""

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    header = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def compressed_message(pixels, stamp, keep=1.0):
    message = CompressedImage(format="mono8; png compressed")
    message.header.stamp = stamp
    data = png(pixels)
    message.data = data[: int(keep * len(data))]
    return message


def truncate(path):
    os.truncate(path, os.path.getsize(path) * 2 // 3)


def damage(path):
    """Nonsense in the middle, which is in one of the compressed chunks."""
    with open(path, "r+b") as file:
        file.seek(os.path.getsize(path) // 2)
        file.write(b"\xff\x00\xaa" * 200)


def time(i):
    return START + i * INTERVAL


class OtherImage(Image):
    _md5sum = "0" * 32


class Recipe:
    """How to write a bag; one thing or another is replaced."""

    def __init__(self, expected, status=1, also=(), **changes):
        self.expected = set(expected.split())  # names of problems
        self.also = set(also.split() if also else [])  # names of notes, and texts
        self.status = status
        self.pixels = lambda i: grey(view(i))
        self.encoding = "mono8"
        self.stamp = time
        self.image = lambda i, pixels, stamp: image_message(pixels, stamp, self.encoding)
        self.info = lambda i, stamp: info_message(stamp)
        self.exposure = lambda i: EXPOSURE
        self.exposure_stamp = lambda stamp: stamp
        self.exposure_message = exposure_message
        self.extra = lambda i, stamp: []
        self.frames = FRAMES
        self.compression = "none"
        self.chunk = 768 * 1024  # bytes
        self.after = lambda path: None
        for name, value in changes.items():
            assert hasattr(self, name), name
            setattr(self, name, value)

    def write(self, path):
        with rosbag.Bag(path, "w", compression=self.compression, chunk_threshold=self.chunk) as bag:
            for i in range(self.frames):
                written = Time.from_sec(time(i))
                stamp = Time.from_sec(self.stamp(i))
                info = self.info(i, stamp)
                if info is not None:
                    bag.write(INFO, info, written)
                exposure = self.exposure(i)
                if exposure is not None:
                    at = Time.from_sec(self.exposure_stamp(stamp.to_sec()))
                    bag.write(EXPOSURES, self.exposure_message(at, exposure), written)
                message = self.image(i, self.pixels(i), stamp)
                topic = IMAGE + "/compressed" if isinstance(message, CompressedImage) else IMAGE
                bag.write(topic, message, written)
                for extra_topic, extra in self.extra(i, stamp):
                    bag.write(extra_topic, extra, written)
        self.after(path)


def no_bag(path):
    with open(path, "w", encoding="ascii") as file:
        file.write("this is no bag\n" * 100)


def unindexed(path):
    """As rosbag record leaves it when it is killed: the index is told to be at 0."""
    with open(path, "r+b") as file:
        head = file.read(4096)
        at = head.index(b"index_pos=") + len(b"index_pos=")
        file.seek(at)
        file.write(b"\0" * 8)


def short_data(i, pixels, stamp):
    message = image_message(pixels, stamp)
    if i % 4 == 1:
        message.data = message.data[:-500]
    return message


def other_definition(i, pixels, stamp):
    message = OtherImage(height=HEIGHT, width=WIDTH, encoding="mono8", step=WIDTH, data=pixels.tobytes())
    message.header.stamp = stamp
    return message


def recipes():
    ramp = np.linspace(0.2, 0.21, WIDTH) * np.ones((HEIGHT, 1))
    return {
        "clean": Recipe("", status=0),
        "clean_compressed": Recipe("", status=0, image=lambda i, p, s: compressed_message(p, s)),
        "not_a_bag": Recipe("not-a-bag", status=2, after=no_bag),
        "truncated": Recipe("needs-reindex", status=2, after=truncate),
        "unindexed": Recipe("needs-reindex", status=2, after=unindexed),
        "empty": Recipe("no-images", frames=0),
        "damaged_chunk": Recipe("damaged-bag", compression="lz4", chunk=40000, after=damage),
        "wrong_type": Recipe("wrong-type no-images", image=lambda i, p, s: String(data="image")),
        "other_definition": Recipe("wrong-type no-images", image=other_definition),
        "no_camera_info": Recipe("no-camera-info", info=lambda i, s: None),
        "camera_info_of_another_size": Recipe("camera-info-size", also="scaled", info=lambda i, s: info_message(s, 256, 192, 220.0)),
        "camera_info_zero": Recipe("bad-camera-info", info=lambda i, s: info_message(s, focal=0.0)),
        "camera_info_changes": Recipe("camera-info-changes", info=lambda i, s: info_message(s, focal=110.0 + i // 20)),
        "camera_info_odd": Recipe("odd-calibration", info=lambda i, s: info_message(s, focal=4000.0)),
        "stamps_zero": Recipe("stamps-zero", stamp=lambda i: 0.0),
        "stamps_going_back": Recipe("stamps-backwards", stamp=lambda i: time(i) - (0.05 if i == 20 else 0.0)),
        "stamps_repeated": Recipe("stamps-repeated", stamp=lambda i: time(i - i % 2)),
        "clock_restarts": Recipe("clock-restarts", stamp=lambda i: time(i) - (1000.0 if i >= 20 else 0.0)),
        "stamps_of_arrival": Recipe("", status=0, also="stamps-jitter", stamp=lambda i: time(i) + 0.006 * (-1) ** i * (1 + i % 3) / 2),
        "gap": Recipe("gaps", stamp=lambda i: time(i) + (1.5 if i >= 20 else 0.0)),
        "slow": Recipe("", status=0, also="low-rate", stamp=lambda i: START + 0.25 * i),
        "repeated_images": Recipe("", status=0, also="images-repeat", pixels=lambda i, kept={}: kept.setdefault(i // 4, grey(view(i)))),
        "exposure_milliseconds": Recipe("exposure-unit", also="milliseconds", exposure=lambda i: 1e3 * EXPOSURE),
        "exposure_microseconds": Recipe("exposure-unit", also="microseconds", exposure=lambda i: 1e6 * EXPOSURE),
        "exposure_nanoseconds": Recipe("exposure-unit", also="nanoseconds", exposure=lambda i: 1e9 * EXPOSURE),
        "exposure_too_short": Recipe("exposure-too-short", exposure=lambda i: 1e-3 * EXPOSURE),
        "exposure_too_long": Recipe("exposure-too-long", exposure=lambda i: 0.06),
        "exposure_negative": Recipe("exposure-invalid", exposure=lambda i: -EXPOSURE if i % 2 else EXPOSURE),
        "exposure_not_a_number": Recipe("", status=0, also="exposure-unknown", exposure=lambda i: float("nan") if i % 2 else EXPOSURE),
        "exposure_infinite": Recipe("exposure-invalid", exposure=lambda i: float("inf") if i % 2 else EXPOSURE),
        "exposure_zero": Recipe("exposure-zero", exposure=lambda i: 0.0),
        "exposure_of_other_stamps": Recipe("exposure-unmatched", exposure_stamp=lambda s: s + 0.012),
        "exposure_of_another_type": Recipe("wrong-type", also="no-exposure", exposure_message=lambda s, e: Float64(e)),
        "no_exposure": Recipe("", status=0, also="no-exposure", exposure=lambda i: None),
        "unknown_encoding": Recipe("image-encoding", encoding="nv21"),
        "data_too_short": Recipe("image-damaged", image=short_data),
        "compressed_damaged": Recipe("image-damaged", image=lambda i, p, s: compressed_message(p, s, 0.5 if i % 5 == 2 else 1.0)),
        "twelve_bits": Recipe("", status=0, also="white-level", encoding="mono16", pixels=lambda i: (4095 * view(i)).astype(np.uint16)),
        "images_change_size": Recipe("image-size-changes", pixels=lambda i: grey(view(i))[: HEIGHT - (16 if i >= 25 else 0)].copy()),
        "black": Recipe("black-images", pixels=lambda i: grey(0.002 * view(i))),
        "dark": Recipe("", status=0, also="dark-images", pixels=lambda i: grey(0.1 * view(i))),
        "over_exposed": Recipe("over-exposed", pixels=lambda i: grey(3.0 * view(i))),
        "covered": Recipe("flat-images", pixels=lambda i: grey(ramp)),
        "very_blurred": Recipe("never-sharp", pixels=lambda i: grey(blurred(view(i)))),
        "two_cameras": Recipe("", status=0, also="several-cameras", extra=lambda i, s: [("/right/image_raw", image_message(grey(view(i + 3)), s)), ("/right/camera_info", info_message(s))]),
        "few_images": Recipe("", status=0, also="few-images", frames=8),
    }


def problems_of(recipe, program, path):
    """What is wrong with what the program says of the bag; empty if nothing."""
    result = subprocess.run([program, path], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    named = set(re.findall(r"^ *PROBLEM ([a-z-]+):", result.stdout, re.MULTILINE))
    wrong = []
    if result.returncode != recipe.status:
        wrong.append(f"exit status {result.returncode}, must be {recipe.status}")
    if named != recipe.expected:
        wrong.append(f"problems {sorted(named)}, must be {sorted(recipe.expected)}")
    wrong += [f"'{text}' is not said" for text in recipe.also if text not in result.stdout]
    return "; ".join(wrong) + ("\n" + result.stdout if wrong else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", required=True)
    parser.add_argument("--check", help="mba_vo_check")
    parser.add_argument("--only", help="one of the bags")
    arguments = parser.parse_args()
    os.makedirs(arguments.output, exist_ok=True)
    chosen = {name: r for name, r in recipes().items() if arguments.only in (None, name)}
    failed = 0
    for name, recipe in chosen.items():
        path = os.path.join(arguments.output, name + ".bag")
        recipe.write(path)
        wrong = problems_of(recipe, arguments.check, path) if arguments.check else ""
        failed += wrong != ""
        print(f"{name}: {wrong or 'made' if not arguments.check or wrong else 'named'}")
    print(f"{len(chosen)} bags, {failed} wrong")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
