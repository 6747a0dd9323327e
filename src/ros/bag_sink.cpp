#include "mba_vo/ros/bag_sink.h"

#include <geometry_msgs/PoseStamped.h>
#include <mba_vo/ExposureMotion.h>

#include "mba_vo/ros/bag_image_writer.h"
#include "mba_vo/ros/bag_reader.h"

namespace mba_vo {
namespace {

class BagSink final : public SequenceSink {
 public:
  BagSink(const std::string& file, const CameraCalibration& calibration)
      : writer_(file, calibration, StampReference::kMiddle), ground_truth_(kGroundTruthNamespace) {}

  void write(const SimulatedFrame& frame) override {
    writer_.write(frame.mid_exposure_ns, frame.exposure, frame.blurred);
    writePoses(frame);
    if (!frame.sharp.empty()) {
      writer_.writeImage(ground_truth_ + "image_sharp", frame.sharp);
    }
    if (!frame.depth.empty()) writer_.writeImage(BagImageWriter::kDepthTopic, frame.depth);
  }

  void finish() override { writer_.close(); }

 private:
  void writePoses(const SimulatedFrame& frame) {
    geometry_msgs::PoseStamped pose;
    pose.header = writer_.header();
    pose.header.frame_id = "world";
    pose.pose = toPoseMsg(frame.T_world_mid);
    writer_.writeMessage(ground_truth_ + "pose", pose);
    ExposureMotion motion;
    motion.header = pose.header;
    motion.child_frame_id = writer_.header().frame_id;
    motion.mid_time = toRosTime(frame.mid_exposure_ns);
    motion.exposure_time = frame.exposure;
    motion.start = toPoseMsg(frame.T_world_start);
    motion.end = toPoseMsg(frame.T_world_end);
    motion.blur_length = frame.blur_px;
    motion.confidence = 1.0;
    writer_.writeMessage(ground_truth_ + "exposure_motion", motion);
  }

  BagImageWriter writer_;
  std::string ground_truth_;
};

}  // namespace

std::unique_ptr<SequenceSink> makeBagSink(const std::string& file, const CameraCalibration& calibration) {
  return std::make_unique<BagSink>(file, calibration);
}

}  // namespace mba_vo
