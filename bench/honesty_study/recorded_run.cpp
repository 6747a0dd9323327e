#include "recorded_run.h"

#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/io/sequence.h"
#include "mba_vo/odometry/odometry.h"

namespace mba_vo::study {
namespace {

class Recorder {
 public:
  void take(const OdometryResult& result) {
    // The references of the very same call are those that its later results were aligned to.
    for (const MapperOutput& output : result.mapping) {
      if (output.reference) references_[key(output.reference->id)] = output.reference;
    }
    for (const TrackedFrameConstPtr& late : result.late) add(late);
    add(result.tracked());
  }
  RecordedRun& run() { return run_; }

 private:
  using Key = std::tuple<MapId, KeyframeId, std::uint32_t>;
  static Key key(const ReferenceId& id) { return {id.map_id, id.keyframe_id, id.revision}; }

  void add(const TrackedFrameConstPtr& tracked) {
    if (!tracked || !tracked->tracked() || !seen_.insert(tracked->frame->sequence).second) return;
    run_.reported.push_back({tracked, references_.at(key(tracked->reference))});
  }

  std::map<Key, ReferenceConstPtr> references_;
  std::set<std::uint64_t> seen_;  // frames that were reported already
  RecordedRun run_;
};

}  // namespace

RecordedRun runOver(const std::string& folder, const OdometryConfig& config, int skip) {
  const auto reader = openSequenceFolder(folder, "images");
  for (int i = 0; i < skip; ++i) reader->skip();
  const FrameBuilder builder(reader->calibration(), {}, config.image);
  Odometry odometry(config, 0);
  Recorder recorder;
  while (const std::optional<CameraImage> image = reader->next()) {
    recorder.take(odometry.process(
        builder.build(image->image, image->sequence, image->stamp_ns, image->mid_exposure_ns, image->exposure)));
  }
  recorder.take(odometry.finish());
  recorder.run().trajectory = odometry.trajectory();
  return std::move(recorder.run());
}

}  // namespace mba_vo::study
