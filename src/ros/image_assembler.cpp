#include "mba_vo/ros/image_assembler.h"

#include "mba_vo/ros/conversions.h"

namespace mba_vo {
namespace {

constexpr std::uint32_t kLargestGap = 10'000;  // beyond: another sender, not a gap
constexpr std::int64_t kExposureMemoryNs = 10'000'000'000;
constexpr double kDepthMemory = 1.0;  // [s] without a depth image, after which none is waited for

}  // namespace

std::uint64_t ImageAssembler::addImage(const sensor_msgs::ImageConstPtr& image, double now,
                                       const std::string& problem) {
  std::uint64_t missing = 0;
  const std::uint32_t sender = image->header.seq;
  // Senders that do not number their images repeat one number; those tell nothing.
  if (last_sender_sequence_ && sender > *last_sender_sequence_ + 1 && sender - *last_sender_sequence_ < kLargestGap) {
    missing = sender - *last_sender_sequence_ - 1;
  }
  last_sender_sequence_ = sender;
  InputImage input;
  input.message = image;
  input.problem = problem;
  input.sequence = next_sequence_ + missing;
  input.arrival = now;
  next_sequence_ = input.sequence + 1;
  waiting_.push_back(input);
  return missing;
}

void ImageAssembler::addExposure(std::int64_t stamp_ns, double exposure) {
  exposures_expected_ = true;
  exposures_.add(stamp_ns, exposure);
  exposures_.forgetBefore(stamp_ns - kExposureMemoryNs);
}

void ImageAssembler::addDepth(const sensor_msgs::ImageConstPtr& depth, double now) {
  depths_.add(depth);
  last_depth_ = now;
}

bool ImageAssembler::ready(const InputImage& input, double now) const {
  const double waited = now - input.arrival;
  const bool lacks_calibration = !calibrated_ && waited < options_.calibration_wait;
  return !lacks_calibration && !lacksExposure(input, waited) && !lacksDepth(input, waited, now);
}

bool ImageAssembler::lacksExposure(const InputImage& input, double waited) const {
  if (options_.fixed_exposure || !exposures_expected_ || waited >= options_.exposure_wait) {
    return false;
  }
  const std::int64_t stamp = toNanoseconds(input.message->header.stamp);
  return !exposures_.find(stamp).has_value() && !exposures_.hasLater(stamp);
}

bool ImageAssembler::lacksDepth(const InputImage& input, double waited, double now) const {
  const bool expected = last_depth_ && now - *last_depth_ < kDepthMemory;
  return expected && waited < options_.depth_wait && !depths_.isSettled(toNanoseconds(input.message->header.stamp));
}

std::vector<InputImage> ImageAssembler::takeReady(double now) {
  std::vector<InputImage> ready_images;
  while (!waiting_.empty() && ready(waiting_.front(), now)) {
    InputImage input = waiting_.front();
    waiting_.pop_front();
    input.exposure = options_.fixed_exposure;
    if (!input.exposure) {
      const std::optional<double> found = exposures_.find(toNanoseconds(input.message->header.stamp));
      input.exposure_from_topic = found.has_value();
      input.exposure_unmatched = !found && exposures_.size() > 0;
      input.exposure = found ? exposureFromMessage(*found) : std::nullopt;
    }
    input.depth = depths_.find(toNanoseconds(input.message->header.stamp));
    ready_images.push_back(input);
  }
  return ready_images;
}

}  // namespace mba_vo
