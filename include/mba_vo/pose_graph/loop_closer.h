#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mba_vo/pose_graph/loop_verifier.h"
#include "mba_vo/relocalization/place_index.h"

namespace mba_vo {

struct LoopConfig {
  bool close = false;
  int candidates = 2;
  double max_megabytes = 300.0;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("close", c.close,
      "recognise places that were seen before and correct map and trajectory by them; odometry stays as it is");
    v("candidates", c.candidates, 1, 100, "earlier keyframes that each keyframe is compared with, the likeliest first");
    v("max_megabytes", c.max_megabytes, 1.0, 1e6,
      "memory for keyframes that places, and maps that were lost, are recognised by; those that say what others say go "
      "first [MB]");
  }
};

/// A keyframe that was compared with an earlier one that looks like it, of the same map or of another.
struct LoopTrial {
  MapId older_map = 0;
  MapId newer_map = 0;
  KeyframeId older = 0;
  KeyframeId newer = 0;
  std::int64_t older_ns = 0;  // mid-exposure times [ns]
  std::int64_t newer_ns = 0;
  SE3 T_map_newer;                    // by odometry
  std::optional<double> correlation;  // of their small images; nullopt: odometry led there
  LoopVerdict verdict;
  double weight = 1.0;  // in the pose graph: 1 = believed, towards 0 = taken for wrong
};

/// Keeps keyframes that have left the window and finds out where the camera has come back: in the same map, if loops
/// are to be closed, and in maps that were lost, until it is known how these stand to the present one. Ids of keyframes
/// are unique among all maps.
class LoopCloser {
 public:
  LoopCloser(const LoopConfig& config, const TrackerConfig& tracker);

  /// A keyframe leaves the window: it is looked for among those that left before, and kept.
  void add(const ArchivedKeyframeConstPtr& keyframe);
  /// A keyframe that is still in the window is looked for in other maps; it counts only if it is found. `beside`:
  /// others of the window.
  void look(const ArchivedKeyframeConstPtr& keyframe, const std::vector<ArchivedKeyframeConstPtr>& beside);
  /// Keeps a keyframe of which all is known that is to be found out.
  void know(const ArchivedKeyframeConstPtr& keyframe);
  /// The keyframes of all maps; what was found stays.
  void forgetKeyframes();
  /// The keyframes of a map that was given up, and what was found with it.
  void forget(MapId map);

  /// In the order in which they were made: all that show one place, and the last ones that do not.
  const std::vector<LoopTrial>& trials() const { return trials_; }
  /// How many there were in all.
  std::uint64_t compared() const { return compared_; }
  /// How many of them were found to show one place, those of maps that were given up too.
  std::uint64_t closed() const { return closed_; }
  /// What the keyframes that are kept take.
  std::size_t bytes() const { return bytes_; }
  /// By map, the median over the keyframes of their points' median depth, in the unit of the map.
  std::map<MapId, double> usualDepths() const;

 private:
  struct Kept {
    ArchivedKeyframeConstPtr keyframe;
    double median_depth = 1.0;
    MapId map() const { return keyframe->reference.id.map_id; }
  };
  using Neighbours = std::map<KeyframeId, ArchivedKeyframeConstPtr>;
  void keep(const ArchivedKeyframeConstPtr& keyframe, const PlaceDescriptor& descriptor);
  void drop(KeyframeId keyframe);
  void dropMostRedundant();
  MapId largestMap() const;
  double usualDepth(MapId map) const;
  bool isElsewhere(const Kept& candidate, const ArchivedKeyframe& keyframe) const;
  enum class Among { kItsMap, kOtherMaps };
  /// Compares it with those among them that it looks like, until one shows the same place. `beside`: keyframes of its
  /// map.
  std::vector<LoopTrial> compare(const ArchivedKeyframeConstPtr& keyframe, const PlaceDescriptor& descriptor,
                                 const Neighbours& beside, Among among) const;
  void remember(LoopTrial trial);
  /// A keyframe that may show the same place, and where the camera would be relative to it.
  struct Candidate {
    KeyframeId keyframe = 0;
    std::optional<double> correlation;  // of the small images; nullopt: it was not looked at
    std::vector<SE3> starts;            // T_old_new
  };
  std::vector<Candidate> candidatesFor(const ArchivedKeyframe& keyframe, const PlaceDescriptor& descriptor,
                                       Among among) const;
  std::optional<Candidate> nearestByOdometry(const ArchivedKeyframe& keyframe) const;
  std::set<MapId> mapsShownBy(KeyframeId keyframe) const;
  std::vector<SE3> startsFor(const PlaceCandidate& alike, const ArchivedKeyframe& keyframe) const;
  /// T_old_new.
  static SE3 byOdometry(const ArchivedKeyframe& older, const ArchivedKeyframe& newer);
  std::vector<LoopWitness> witnessesOf(const ArchivedKeyframe& older, const ArchivedKeyframe& newer,
                                       const Neighbours& beside_newer) const;
  static std::vector<LoopWitness> nearestOf(const Neighbours& others, const ArchivedKeyframe& keyframe, bool is_old);
  /// The keyframes that are kept, near this one in its map.
  Neighbours keptBeside(const ArchivedKeyframe& keyframe) const;
  /// Odometry may drift, but not by as much as that; empty if it has not.
  std::string contradiction(const LoopTrial& trial) const;

  LoopConfig config_;
  LoopVerifier verifier_;
  PlaceIndex index_;
  std::map<KeyframeId, Kept> kept_;
  std::size_t bytes_ = 0;  // of kept_
  std::vector<LoopTrial> trials_;
  std::uint64_t compared_ = 0, closed_ = 0;
};

}  // namespace mba_vo
