#!/usr/bin/env python3
"""Makes of a sequence what another sensor would have seen: the same light, motion and truth, other numbers.

usage: sensor_twin.py SENSOR SEQUENCE TWIN
"""
import argparse
import pathlib
import shutil

import cv2
import numpy as np

DARK_MEAN = 20.0  # [grey levels]
RAW_GAINS = (0.6, 1.0, 0.5)  # of red, green and blue pixels before white balance, as of daylight on silicon


def rounded(values, white, kind):
    return np.clip(np.rint(values), 0, white).astype(kind)


def twelve_bits(grey, rng):
    """Of images with less noise than a grey level: what rounding took away comes back as noise."""
    return rounded(4095 / 255 * (grey + rng.uniform(-0.5, 0.5, grey.shape)), 4095, np.uint16)


def demosaiced(grey):
    """Raw red, green and blue pixels, mixed to grey by the library that cv_bridge uses."""
    red, green, blue = (np.minimum(gain * grey, 255) for gain in RAW_GAINS)
    raw = green.copy()
    raw[0::2, 0::2] = red[0::2, 0::2]
    raw[1::2, 1::2] = blue[1::2, 1::2]
    return cv2.cvtColor(rounded(raw, 255, np.uint8), cv2.COLOR_BayerBG2GRAY)


def sense(sensor, grey, dimming, rng):
    if sensor == "bits12":
        return twelve_bits(grey, rng)
    if sensor == "dark":
        return rounded(dimming * grey + rng.normal(0.0, 2.0, grey.shape), 255, np.uint8)
    if sensor == "dark12":
        return twelve_bits(dimming * grey, rng)
    if sensor == "bayer":
        return demosaiced(grey)
    if sensor == "bright":
        return rounded(2.0 * grey, 255, np.uint8)
    return rounded(grey, 255, np.uint8)  # what is left is the compression


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sensor", choices=["bits12", "dark", "dark12", "bayer", "bright", "jpeg60"])
    parser.add_argument("sequence", type=pathlib.Path)
    parser.add_argument("twin", type=pathlib.Path)
    arguments = parser.parse_args()
    files = sorted((arguments.sequence / "images").iterdir())
    (arguments.twin / "images").mkdir(parents=True, exist_ok=True)
    sample = [cv2.imread(str(file), cv2.IMREAD_GRAYSCALE).mean() for file in files[:: max(1, len(files) // 10)]]
    dimming = DARK_MEAN / np.mean(sample)
    rng = np.random.default_rng(1)
    for file in files:
        grey = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE).astype(np.float64)
        suffix = ".jpg" if arguments.sensor == "jpeg60" else ".png"
        image = sense(arguments.sensor, grey, dimming, rng)
        options = [cv2.IMWRITE_JPEG_QUALITY, 60] if suffix == ".jpg" else [cv2.IMWRITE_PNG_COMPRESSION, 1]
        cv2.imwrite(str(arguments.twin / "images" / (file.stem + suffix)), image, options)
    for file in arguments.sequence.glob("*.*"):
        shutil.copy(file, arguments.twin / file.name)


if __name__ == "__main__":
    main()
