#include "mba_vo/inspection/camera_inspection.h"

namespace mba_vo {

void CameraInspection::add(const SeenImage& seen) {
  ImageFacts facts;
  facts.stamp_ns = seen.stamp_ns;
  facts.encoding = seen.encoding;
  facts.problem = seen.problem;
  facts.bad_encoding = seen.bad_encoding;
  const int depth = seen.image.depth();
  if (seen.image.empty()) {
    if (facts.problem.empty()) facts.problem = "not a readable image";
  } else if (depth != CV_8U && depth != CV_16U) {
    facts.problem = "pixels are " + cv::typeToString(seen.image.type()) + ", not 8 or 16 bits";
    facts.bad_encoding = true;
  } else {
    measure(seen.image, facts);
  }
  facts_.images.push_back(facts);
}

void CameraInspection::measure(const cv::Mat& image, ImageFacts& facts) {
  facts.size = image.size();
  facts.repeats = repeats_.isRepeat(image);
  const double white = white_level_.of(image);
  facts_.white_level = white_level_.found();
  const cv::Mat1f grey = greyImage(image, white);
  facts.pixels = measurePixels(image, grey, white);
  if (facts.repeats) {
    motion_ = {};  // the next motion is that of more than one interval
  } else {
    facts.motion = motion_.add(grey);
  }
}

}  // namespace mba_vo
