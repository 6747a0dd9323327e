#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mba_vo/mapping/mapper.h"
#include "mba_vo/odometry/bounded_queue.h"
#include "mba_vo/odometry/pipeline_messages.h"

namespace mba_vo {

/// What one step of the mapper half did.
struct MapperStep {
  enum class Kind {
    kFrame,       // a tracked frame has been taken in
    kRefinement,  // a piece of the refinement of a keyframe has been done
    kDeferred,    // a piece of what can wait has been done
    kPassed       // nothing of a frame: a question was answered, or a map loaded, which the reference tells the tracker
  };
  Kind kind = Kind::kPassed;
  TrackerMessage cause;  // the frame that was taken in, or the last one
  MapperOutput output;
  MapperMessage reference;  // with `output.reference`, for the tracker half; null if there is none
  bool was_reset = false;   // the tracker had begun anew: the map was forgotten first
  bool had_time = true;     // else what other frames may do as well was left out
  bool stale = false;       // the frame was tracked in a map that is no more

  /// There may be something new to see.
  bool isOfFrame() const { return kind == Kind::kFrame || kind == Kind::kRefinement; }
};

/// The mapper half of the pipeline: tracked frames go in at any time, from any thread; step(), which one thread calls,
/// takes in the next one; while none waits, it refines the newest keyframe, and then does what has been put off. So the
/// draft of a keyframe is never late because of the one before.
class MapperPipeline {
 public:
  /// `max_queue_bytes`: of frames that wait for the mapper.
  MapperPipeline(const MapperConfig& config, std::size_t max_queue_bytes);

  /// Thread-safe. Returns the frames that had to be shed, because too many wait.
  std::vector<TrackerMessage> addFrame(const TrackerMessage& message);
  /// Thread-safe. What `question`, a function of a const Mapper&, says after all frames added so far, or throws; the
  /// map goes on as if nobody had asked. Broken if the pipeline ends before.
  template <typename Question>
  auto ask(Question question) {
    using Answer = decltype(question(std::declval<const Mapper&>()));
    const auto task = std::make_shared<std::packaged_task<Answer(const Mapper&)>>(std::move(question));
    queue_.push(Job([task](const Mapper& mapper) { (*task)(mapper); }));
    return task->get_future();
  }
  /// Thread-safe. After all frames added so far: begins anew in a map of an earlier run (Mapper::beginIn).
  void beginIn(std::shared_ptr<const SavedMap> map) { queue_.push(std::move(map)); }
  std::size_t queueBytes() const { return queue_.bytes(); }

  // The rest is for the one thread.

  /// nullopt if there is nothing to do until something comes in.
  std::optional<MapperStep> step();
  /// After something has gone wrong: forgets the map. Returns what tells the tracker so, null if there was none.
  MapperMessage recover(const std::string& reason);
  void reset();
  void watchSharpKeyframes(bool watched) { mapper_.watchSharpKeyframes(watched); }

  const Mapper& mapper() const { return mapper_; }

 private:
  using Question = std::function<void(const Mapper&)>;
  using Job = std::variant<TrackerMessage, Question, std::shared_ptr<const SavedMap>>;

  static std::size_t bytesOf(const Job& job);
  static std::size_t mostDispensable(const std::deque<Job>& jobs);
  MapperStep take(const TrackerMessage& message);
  MapperStep refine();
  /// What tells the tracker that its map is no more, null if there was none.
  MapperMessage closeMap(const std::string& reason);
  void address(MapperStep& step);
  bool followSession(const TrackerMessage& message);

  BoundedQueue<Job> queue_;

  // Of the one thread from here on.
  std::uint64_t session_ = 0;  // of the newest frame; 0 = none yet
  MapId map_id_ = 0;           // of the newest reference
  TrackerMessage newest_;      // that was taken in
  Mapper mapper_;
};

}  // namespace mba_vo
