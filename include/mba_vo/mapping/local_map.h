#pragma once

#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mba_vo/depth_search/surface_slope.h"
#include "mba_vo/mapping/calibration_estimator.h"
#include "mba_vo/mapping/keyframe_report.h"
#include "mba_vo/mapping/mapper_config.h"
#include "mba_vo/mapping/point_budget.h"
#include "mba_vo/pose_graph/loop_keyframe.h"
#include "mba_vo/tracking/map_point.h"
#include "mba_vo/trajectory/pose_interpolation.h"
#include "mba_vo/trajectory/trajectory_store.h"
#include "mba_vo/window/window.h"

namespace mba_vo {

/// One map from its initialisation on: the window of keyframes with their active and immature points.
class LocalMap {
 public:
  /// Where the first keyframe is.
  struct Place {
    SE3 T_map_keyframe;
    KeyframeId keyframe = 0;
    AffineBrightness brightness;
    bool has_depths = false;  // that an earlier window of the map has found: they keep its unit of length
  };
  /// Begins with the initial map's reference, moving by `reference_motion`, as first keyframe.
  LocalMap(const MapperConfig& config, MapId id, const InitialMap& initial, const BodyMotion& reference_motion,
           const Place& place, TrajectoryStore& store, CalibrationEstimator& calibration);

  /// What a further window of the same map begins from.
  struct Identity {
    MapId id = 0;
    bool metric = false;           // the unit of length is the metre
    KeyframeId next_keyframe = 0;  // ids of earlier ones are taken
    std::vector<MapPoint> points;  // known so far, for display
  };
  Identity identity() const { return {id_, metric_, newestKeyframe() + 1, points()}; }

  MapId id() const { return id_; }
  /// The unit of length is the metre.
  bool isMetric() const { return metric_; }
  bool has(KeyframeId keyframe) const { return keyframes_.count(keyframe) > 0; }
  KeyframeId oldestKeyframe() const { return keyframes_.begin()->first; }
  KeyframeId newestKeyframe() const { return keyframes_.rbegin()->first; }
  /// The last one before that is still in the window.
  std::optional<KeyframeId> keyframeBefore(KeyframeId keyframe) const {
    const auto next = keyframes_.lower_bound(keyframe);
    if (next == keyframes_.begin()) return std::nullopt;
    return std::prev(next)->first;
  }
  /// The next one that is still in the window.
  std::optional<KeyframeId> keyframeAfter(KeyframeId keyframe) const {
    const auto next = keyframes_.upper_bound(keyframe);
    if (next == keyframes_.end()) return std::nullopt;
    return next->first;
  }
  StampedPose stampedPose(KeyframeId keyframe) const;

  /// Refines the depths of all immature points with a tracked frame.
  void searchDepths(const TrackedFrame& tracked);

  /// Makes the tracked frame, which moved by `motion`, a keyframe and activates points: a reference from then on.
  KeyframeReport insertKeyframe(const TrackedFrame& tracked, const BodyMotion& motion);
  /// Does a piece of what makes it a better one: an iteration of the window's optimisation, at last marginalisation and
  /// the selection of new points. False: that was the last, the report is complete. Frames may be used between.
  bool refineWindow(KeyframeReport& report);
  /// The last piece at once, because the next keyframe cannot wait: the window stays as far as it is optimised.
  void refineWindowNoFurther(KeyframeReport& report);
  /// How the newest keyframe moved is known better now. Adopted before or after an optimisation, never within it.
  void reviseNewestMotion(const BodyMotion& motion) { revised_motion_ = motion; }
  /// Evaluated by the last piece of the refinement.
  int evaluatedResiduals() const {
    return refinement_.next == Refinement::Piece::kBegin ? 0 : window_.evaluatedResiduals();
  }

  /// Whether with the sharp image in place of its own the keyframe would explain the others of the window no worse.
  bool explainsAsWell(KeyframeId keyframe, const std::shared_ptr<const ImagePyramid>& sharp) const;
  /// From now on the sharp image is what the keyframe's points are seen in.
  void replaceImage(KeyframeId keyframe, const std::shared_ptr<const ImagePyramid>& sharp);
  /// That the keyframe was made of.
  const FrameConstPtr& frame(KeyframeId keyframe) const { return keyframes_.at(keyframe).frame; }

  SE3 T_map_camera(const TrackedFrame& tracked) const;
  /// Pose and motion of a blurred frame by all points of the window, from where it was tracked, relative to the same
  /// keyframe. nullopt if they do not tell.
  std::optional<ExposureTrajectory> align(const TrackedFrame& tracked) const;

  /// Snapshot for the tracker about one keyframe of the window.
  std::shared_ptr<Reference> makeReference(KeyframeId keyframe, const std::string& doubt = {}) const;

  /// A keyframe as it left the window.
  struct Departed {
    ReferenceConstPtr reference;
    FrameConstPtr frame;
  };
  /// Those that have left since the last call.
  std::vector<Departed> takeDeparted() { return std::exchange(just_departed_, {}); }
  /// The newest of the window, by id.
  std::vector<ArchivedKeyframeConstPtr> archived(std::size_t most = std::numeric_limits<std::size_t>::max()) const;

  /// The newest of those that are known by their positions only, and all of the window.
  std::vector<MapPoint> points() const;
  /// Of an earlier window of the same map, for display.
  void inheritPoints(std::vector<MapPoint> points) { old_points_ = std::move(points); }

 private:
  struct HostKeyframe {
    FrameConstPtr frame;
    std::shared_ptr<const ImagePyramid> image;  // the frame's own, or a sharp one
    std::optional<double> exposure;             // as the window has it, where none came with the image; 0 = sharp [s]
    std::vector<ImmaturePoint> immature;
  };
  /// How far the window is refined with its newest keyframe.
  struct Refinement {
    enum class Piece { kSelect, kBegin, kIterate, kConclude };
    Piece next = Piece::kSelect;
    int calibration_steps = 0;  // taken
    int iterations = 0;         // of the optimisation, with any calibration
  };

  void addKeyframe(const FrameConstPtr& frame, WindowKeyframe keyframe);
  void reviseExposures(const ExposureHistory& exposures);
  static std::optional<double> exposureOf(const HostKeyframe& keyframe);
  std::shared_ptr<const ImagePyramid> imageAsKnownNow(const HostKeyframe& keyframe) const;
  int activatePoints();
  void alignBlurred(double blur_length_px);
  void adoptRevisedMotion();
  void beginOptimization(KeyframeReport& report);
  void iterate(KeyframeReport& report);
  void endOptimization(KeyframeReport& report);
  void conclude(KeyframeReport& report);
  void updateSlopes();
  void selectImmaturePoints(HostKeyframe& host) const;
  void selectNewestPoints(KeyframeReport& report);
  void marginalizeKeyframes();
  void storePoses();
  bool refineImaging(KeyframeReport& report);
  void keepForDisplay(KeyframeId keyframe);
  MapPoint displayPoint(const WindowPoint& point) const;

  MapperConfig config_;
  MapId id_;
  TrajectoryStore& store_;
  CalibrationEstimator& calibration_;
  bool metric_;
  Window window_;
  std::map<KeyframeId, HostKeyframe> keyframes_;
  KeyframeId next_keyframe_ = 0;
  Refinement refinement_;
  std::optional<BodyMotion> revised_motion_;  // of the newest keyframe, to be adopted once the window is optimised
  int departed_ = 0;                          // keyframes that have left the window
  PointBudget budget_;                        // of the window
  double activation_distance_px_ = 4.0;       // adapted so that it holds about as many points
  double depth_search_ms_ = 0.0;              // since the last keyframe
  std::vector<MapPoint> old_points_;
  std::vector<Departed> just_departed_;
};

}  // namespace mba_vo
