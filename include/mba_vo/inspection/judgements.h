#pragma once

#include <string>
#include <vector>

#include "mba_vo/inspection/camera_facts.h"
#include "mba_vo/inspection/finding.h"

namespace mba_vo {

/// What is wrong with the stamps of the images: missing, repeated, out of order, gaps, jitter, rate.
std::vector<Finding> judgeStamps(const std::vector<ImageFacts>& images);

/// What is wrong with the exposures, and their unit.
std::vector<Finding> judgeExposures(const CameraFacts& facts);

/// What cannot be read, what repeats, light, detail.
std::vector<Finding> judgeImages(const CameraFacts& facts);

/// The calibration by itself and against the size of the images. A missing one is for the reader to tell.
std::vector<Finding> judgeCalibration(const CameraFacts& facts);

/// What can only be guessed, where the evidence is decent: gamma and rolling shutter.
std::vector<Finding> guessSensor(const CameraFacts& facts);

/// All of them.
std::vector<Finding> judge(const CameraFacts& facts);

/// Time from one row to the next that the motion of the rows tells [s], with its standard deviation.
struct RowTime {
  double seconds = 0.0;
  double sigma = 0.0;
};

/// Nullopt where motion does not change enough to tell.
std::optional<RowTime> guessRowTime(const std::vector<ImageFacts>& images);

/// The unit that exposures of `usual` [s] must be in where images are `interval` [s] apart.
struct ExposureUnit {
  const char* name;
  double seconds;  // in one unit
};

/// Nullopt if they are not ten times too long for the interval, or fit in no unit.
std::optional<ExposureUnit> mistakenUnit(double usual, double interval);

}  // namespace mba_vo
