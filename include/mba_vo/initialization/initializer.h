#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mba_vo/depth_search/measured_depth.h"
#include "mba_vo/tracking/tracked_frame.h"

namespace mba_vo {

struct InitializerConfig {
  double buffer_seconds = 2.0;
  double min_parallax = 0.02;  // translation over median depth
  int max_points = 500;
  double depth_wait = 0.3;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("buffer_seconds", c.buffer_seconds, 0.2, 10.0, "how far back frames are kept for initialisation [s]");
    v("min_parallax", c.min_parallax, 0.001, 0.5, "least translation over median depth of an initial map");
    v("max_points", c.max_points, 100, 5000, "corners of the reference that are tracked");
    v("depth_wait", c.depth_wait, 0.0, 10.0,
      "where frames come with depth images: longest wait for a less blurred one, if the first are very blurred [s]");
  }
};

/// First structure and motion of a map. Scale: median depth of the points = 1, unless depths were measured.
struct InitialMap {
  struct Pose {
    FrameConstPtr frame;
    SE3 T_reference_frame;  // at mid-exposure
  };
  FrameConstPtr reference;             // the sharpest frame of the buffer
  std::vector<ReferencePoint> points;  // in the reference, at the times of their rows; inverse depths are positive
  std::vector<Pose> poses;             // of some or all buffered frames, the reference excluded, by time
  bool metric = false;                 // the points' depths were measured [m]
  double row_time = 0.0;               // of a rolling shutter, found beyond that of the frames [s]
};

/// Collects frames until motion and structure can be told. Where they come with depth images, that is soon.
class Initializer {
 public:
  /// `find_row_time`: of cameras that have none, as found; else they have a global shutter.
  explicit Initializer(const InitializerConfig& config, const DepthSensorConfig& sensor = {},
                       bool find_row_time = false);
  ~Initializer();

  /// Adds a frame (increasing time; a frame that is not later than the last, or much later, or of another camera,
  /// starts anew).
  /// Returns a map once one is found that explains frames that took no part, else null.
  std::unique_ptr<InitialMap> add(const FrameConstPtr& frame);

  /// Frames held now, oldest first. After success: every frame since the oldest useful one.
  std::vector<FrameConstPtr> bufferedFrames() const;
  /// Why there is no map yet, e.g. "only rotation so far".
  const std::string& reason() const;
  /// Residuals of the bundles that add() has adjusted; 0: it only took the frame in.
  int residuals() const;
  void reset();
  /// A map made with depth images was wrong, surely because of them, or perhaps. Before long they are not used any
  /// more, also after reset().
  void doubtDepths(bool surely);
  void trustDepths();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mba_vo
