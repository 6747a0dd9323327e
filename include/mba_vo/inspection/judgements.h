#pragma once

#include <string>
#include <vector>

#include "mba_vo/inspection/camera_facts.h"
#include "mba_vo/inspection/finding.h"
#include "mba_vo/io/exposure_advice.h"

namespace mba_vo {

/// What is wrong with the stamps of the images: missing, repeated, out of order, gaps, jitter, rate.
std::vector<Finding> judgeStamps(const std::vector<ImageFacts>& images);

/// What is wrong with the exposures, and their unit.
std::vector<Finding> judgeExposures(const CameraFacts& facts);

/// What cannot be read, what repeats, light, detail.
std::vector<Finding> judgeImages(const CameraFacts& facts);

/// The calibration by itself and against the size of the images. A missing one is for the reader to tell.
std::vector<Finding> judgeCalibration(const CameraFacts& facts);

/// How grey values follow the light: measured where exposures change; else what cannot be known is said.
std::vector<Finding> judgeResponse(const CameraFacts& facts);

/// What can only be guessed, where the evidence is decent: a rolling shutter.
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

/// Grey values grow with this power of the exposure, by points that were followed while it changed; 1 = linear, 1/2.2
/// with the gamma of most cameras. With its standard deviation.
struct ResponsePower {
  double power = 1.0;
  double sigma = 0.0;
};

/// Nullopt where exposures are unknown, do not change enough, or the gain changes with them.
std::optional<ResponsePower> measureResponse(const CameraFacts& facts);

/// Whether that is a gamma, rather than linear light.
bool isGamma(const std::optional<ResponsePower>& response);

/// The unit that exposures of `usual` [s] must be in where images are `interval` [s] apart; nullopt if they are not ten
/// times too long for the interval, or fit in no unit.
std::optional<ExposureUnit> mistakenUnit(double usual, double interval);

}  // namespace mba_vo
