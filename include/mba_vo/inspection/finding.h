#pragma once

#include <string>
#include <vector>

namespace mba_vo {

/// All that can be found in a recording. docs/checks.md explains each by its name.
enum class Check {
  kNotABag,
  kBadFolder,
  kNeedsReindex,
  kDamagedBag,
  kNoImages,
  kWrongType,
  kSeveralCameras,
  kNoCameraInfo,
  kBadCameraInfo,
  kCameraInfoSize,
  kOddCalibration,
  kCameraInfoChanges,
  kImageEncoding,
  kImageDamaged,
  kImageSizeChanges,
  kMissingImages,
  kBadTimes,
  kFewImages,
  kStampsZero,
  kStampsRepeated,
  kStampsBackwards,
  kClockRestarts,
  kStampsJitter,
  kGaps,
  kLowRate,
  kImagesRepeat,
  kNoExposure,
  kExposureUnit,
  kExposureTooLong,
  kExposureTooShort,
  kExposureInvalid,
  kExposureUnknown,
  kExposureZero,
  kExposureUnmatched,
  kWhiteLevel,
  kBlackImages,
  kDarkImages,
  kOverExposed,
  kFlatImages,
  kNeverSharp,
  kMuchBlur,
  kGamma,
  kRollingShutter,
};

enum class Severity {
  kNote,     // worth knowing
  kProblem,  // poses will be missing or wrong
};

/// What is always said of a check.
struct CheckText {
  Check check;
  const char* name;  // in kebab-case
  Severity severity;
  const char* cost;
  const char* remedy;
};

const std::vector<CheckText>& allChecks();
const CheckText& textOf(Check check);

/// Something found in one recording.
struct Finding {
  Check check;
  std::string what;  // with the numbers of this recording
};

bool isProblem(const Finding& finding);

}  // namespace mba_vo
