#pragma once

#include <string>

#include "mba_vo/io/calibration_report.h"

/// Draws how each number became known, keyframe after keyframe, and the vignette, each with a band of one standard
/// deviation. The ending of `file`, .png or .svg, chooses the format.
void plotCalibration(const std::string& file, const mba_vo::ToldCamera& told, const mba_vo::CalibrationStudy& study);
