#include "mba_vo/inspection/finding.h"

#include <algorithm>
#include <stdexcept>

namespace mba_vo {

// clang-format off
const std::vector<CheckText>& allChecks() {
  constexpr Severity kNote = Severity::kNote;
  constexpr Severity kProblem = Severity::kProblem;
  static const std::vector<CheckText> kChecks{
    // The recording as a whole.
    {Check::kNotABag, "not-a-bag", kProblem, "nothing can be read", "give a .bag file of ROS 1, or a sequence folder"},
    {Check::kBadFolder, "bad-folder", kProblem, "the folder is not opened, or not read to its end", "add or mend the file that is named"},
    {Check::kNeedsReindex, "needs-reindex", kProblem, "nothing can be read", "rosbag reindex FILE"},
    {Check::kDamagedBag, "damaged-bag", kProblem, "the rest of the topic is lost", "copy the bag again, or rosbag fix, rosbag filter up to there"},
    {Check::kNoImages, "no-images", kProblem, "there is nothing to track", "record a topic of type sensor_msgs/Image or sensor_msgs/CompressedImage"},
    {Check::kWrongType, "wrong-type", kProblem, "the topic is not read", "record or relay it as the type that is named"},
    {Check::kSeveralCameras, "several-cameras", kNote, "nothing, but one has to be named", "--image-topic, or image:="},
    {Check::kMissingImages, "missing-images", kProblem, "the folder is not opened", "take their lines out of times.txt, or add them"},
    {Check::kBadTimes, "bad-times", kProblem, "the folder is not opened", "write times.txt as 'id time[s] exposure[ms]'"},
    // Calibration.
    {Check::kNoCameraInfo, "no-camera-info", kProblem, "every image is rejected", "calibrate the camera, and record its camera_info; or tell --calibration"},
    {Check::kBadCameraInfo, "bad-camera-info", kProblem, "every image is rejected", "calibrate the camera"},
    {Check::kCameraInfoSize, "camera-info-size", kProblem, "every image is rejected", "calibrate at the size of the images, or tell binning and roi"},
    {Check::kOddCalibration, "odd-calibration", kProblem, "a wrong shape of the map, lost tracks, or no map at all", "look at the calibration again; mba_vo_calibrate corrects some per cent"},
    {Check::kCameraInfoChanges, "camera-info-changes", kProblem, "offline the first one is used for all images; live each change begins a new map", "keep zoom, focus and size fixed"},
    // Images.
    {Check::kImageEncoding, "image-encoding", kProblem, "these images are rejected", "let the driver send 8- or 16-bit mono, bgr, rgb, bayer or yuv422"},
    {Check::kImageDamaged, "image-damaged", kProblem, "these images are rejected", "record again; on a slow disk or network, smaller images"},
    {Check::kImageSizeChanges, "image-size-changes", kProblem, "images of another size than the calibration's are rejected", "record at one size"},
    {Check::kFewImages, "few-images", kNote, "a map may need more than there are", "record some seconds of motion"},
    {Check::kImagesRepeat, "images-repeat", kNote, "they are no measurement, and are passed over", "record what the camera sends, not a stream of it"},
    {Check::kWhiteLevel, "white-level", kNote, "too dark at first if the first images do not show it", "image.white_level"},
    {Check::kBlackImages, "black-images", kProblem, "they have no pose", "more light or exposure, and the lens cap off"},
    {Check::kDarkImages, "dark-images", kNote, "noise: fewer points, less accuracy", "more light, or longer exposures: blur costs less than noise"},
    {Check::kOverExposed, "over-exposed", kProblem, "white surfaces tell nothing: fewer points, or none", "shorter exposures; blur is no reason for it, light is"},
    {Check::kFlatImages, "flat-images", kProblem, "they have no pose", "uncover or clean the lens, point it at something"},
    {Check::kNeverSharp, "never-sharp", kProblem, "fine detail is lost everywhere: points are less accurate", "focus the lens and clean it; if all of it is motion, shorter exposures"},
    {Check::kMuchBlur, "much-blur", kNote, "more time per image and less accuracy", "nothing needs to be done; more light allows shorter exposures"},
    {Check::kGamma, "gamma", kNote, "blur is modelled wrongly at strong edges", "switch gamma off in the camera, or tell image.gamma or image.response_file"},
    {Check::kRollingShutter, "rolling-shutter", kNote, "the first map of a live run is bent until the row time is found", "--row-time, or image.row_time: read-out time over rows; mba_vo_calibrate learns it"},
    // Stamps.
    {Check::kStampsZero, "stamps-zero", kProblem, "these images are rejected", "let the driver fill header.stamp"},
    {Check::kStampsRepeated, "stamps-repeated", kProblem, "the later image is rejected", "let the driver stamp each image"},
    {Check::kStampsBackwards, "stamps-backwards", kProblem, "the later image is rejected", "record one camera on one topic; stamp images with the camera's clock"},
    {Check::kClockRestarts, "clock-restarts", kProblem, "a new map begins there", "do not set the clock while recording; cut the bag there (rosbag filter)"},
    {Check::kStampsJitter, "stamps-jitter", kNote, "jitter looks like acceleration until it is smoothed", "stamps of exposure, not of arrival"},
    {Check::kGaps, "gaps", kProblem, "after half a second or so the camera has to be found again", "a faster disk, smaller images, or a larger buffer (rosbag record -b 0)"},
    {Check::kLowRate, "low-rate", kNote, "large motions from image to image: tracking is lost sooner", "15 images a second or more"},
    // Exposure.
    {Check::kNoExposure, "no-exposure", kNote, "it is estimated on the way; what is mapped until then suffers", "publish mba_vo/ExposureStamped, or tell --exposure (exposure_time:=)"},
    {Check::kExposureUnit, "exposure-unit", kProblem, "exposures are treated as unknown", "tell seconds: exposure_relay with the right unit, or --exposure"},
    {Check::kExposureTooLong, "exposure-too-long", kProblem, "these are treated as unknown", "find out what the driver tells: an exposure ends before the next one begins"},
    {Check::kExposureTooShort, "exposure-too-short", kProblem, "if it is not true, blur is taken for sharp edges", "check the unit: 1000 times as long, perhaps; if it is true, --exposure 0"},
    {Check::kExposureInvalid, "exposure-invalid", kProblem, "these are treated as unknown", "NaN where it is not known"},
    {Check::kExposureUnknown, "exposure-unknown", kNote, "it is estimated for these images", "none is needed; better if the driver knows it"},
    {Check::kExposureZero, "exposure-zero", kProblem, "0 is instantaneous: every image is taken for sharp", "NaN where it is not known; --exposure auto or seconds"},
    {Check::kExposureUnmatched, "exposure-unmatched", kProblem, "these images have no exposure", "publish exposures with the stamps of their images"},
  };
  return kChecks;
}
// clang-format on

const CheckText& textOf(Check check) {
  const std::vector<CheckText>& checks = allChecks();
  const auto found =
      std::find_if(checks.begin(), checks.end(), [check](const CheckText& text) { return text.check == check; });
  if (found == checks.end()) throw std::logic_error("a check without a text");
  return *found;
}

bool isProblem(const Finding& finding) { return textOf(finding.check).severity == Severity::kProblem; }

}  // namespace mba_vo
