#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <sensor_msgs/Image.h>

#include "mba_vo/ros/depth_lookup.h"
#include "mba_vo/ros/exposure_lookup.h"

namespace mba_vo {

/// An image with its exposure, as it goes to the tracker's thread.
struct InputImage {
  sensor_msgs::ImageConstPtr message;
  std::string problem;             // why it could not be decoded; empty = nothing is wrong
  std::uint64_t sequence = 0;      // counts the images sent from 0 on, those that never arrived included
  std::optional<double> exposure;  // [s]; nullopt = unknown; not checked yet
  bool exposure_from_topic = false;
  bool exposure_unmatched = false;   // exposures come, but none with its stamp
  sensor_msgs::ImageConstPtr depth;  // null = none
  double arrival = 0.0;              // [s]
};

struct ImageAssemblerOptions {
  std::optional<double> fixed_exposure;  // [s]; overrides the topic
  double exposure_wait = 0.1;            // [s]
  double calibration_wait = 1.0;         // [s]
  double depth_wait = 0.05;              // [s]
  double depth_tolerance = 0.02;         // [s]
};

/// Numbers the images, and joins them with their exposures and depth images by stamp. An image waits for these no
/// longer than the bounds, and not at all once that of a later image has come, or where none come; order is kept. Times
/// `now` [s] come from a steady clock.
class ImageAssembler {
 public:
  explicit ImageAssembler(const ImageAssemblerOptions& options) : options_(options), depths_(options.depth_tolerance) {}

  /// Returns how many images never arrived before this one, by the sequence numbers of the sender.
  std::uint64_t addImage(const sensor_msgs::ImageConstPtr& image, double now, const std::string& problem = "");
  void addExposure(std::int64_t stamp_ns, double exposure);
  void addDepth(const sensor_msgs::ImageConstPtr& depth, double now);
  /// Whether anybody sends exposures; without a sender images do not wait for them.
  void expectExposures(bool expected) { exposures_expected_ = expected; }
  /// Until the calibration is known, images wait for it.
  void setCalibrated() { calibrated_ = true; }

  /// Images that wait no longer, in order.
  std::vector<InputImage> takeReady(double now);

 private:
  bool ready(const InputImage& input, double now) const;
  bool lacksExposure(const InputImage& input, double waited) const;
  bool lacksDepth(const InputImage& input, double waited, double now) const;

  ImageAssemblerOptions options_;
  ExposureLookup exposures_;
  DepthLookup depths_;
  std::optional<double> last_depth_;  // when it came [s]
  std::deque<InputImage> waiting_;
  bool exposures_expected_ = false;
  bool calibrated_ = false;
  std::uint64_t next_sequence_ = 0;
  std::optional<std::uint32_t> last_sender_sequence_;
};

}  // namespace mba_vo
