#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/deblur/deblurrer.h"

namespace mba_vo {

struct DeblurQueueConfig {
  int length = 2;
  double per_second = 1.0;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("length", c.length, 1, 100, "most keyframes that wait to be deblurred; the one with the least blur gives way");
    v("per_second", c.per_second, 0.001, 1000.0, "most keyframes deblurred, in the time of the images [1/s]");
  }
};

/// A keyframe that is to be deblurred.
struct DeblurTask {
  std::uint32_t keyframe = 0;
  double blur_px = 0.0;  // the longer, the more there is to gain [px]
  DeblurInput input;
};

struct DeblurredKeyframe {
  std::uint32_t keyframe = 0;
  DeblurResult result;  // sharpened
};

/// What became of the keyframes offered; each is counted in exactly one of the others, in_map aside.
struct DeblurCounts {
  std::uint64_t offered = 0;
  std::uint64_t waiting = 0;      // that is being worked on, too
  std::uint64_t sharpened = 0;    // their sharp images were handed out
  std::uint64_t in_map = 0;       // of these, have taken the place of the blurred ones in the map
  std::uint64_t unsuited = 0;     // the deblurrer left them as they are
  std::string unsuited_reason;    // of the last one
  std::uint64_t passed_over = 0;  // others had more to gain, at the rate allowed
  std::uint64_t too_slow = 0;     // at their turn the CPU was still busy, or they left the window before it was done
  std::uint64_t forgotten = 0;    // with their map
};

/// Keyframes wait here until they are deblurred, one at a time on a thread of its own; who has most to gain goes first.
/// Used by one thread, which is never held up, unless it asks for results that do not depend on time.
class DeblurQueue {
 public:
  using IsKept = std::function<bool(std::uint32_t)>;

  /// `waits`: take() waits for the result, so that runs can be repeated; so does clear().
  DeblurQueue(const DeblurQueueConfig& config, std::shared_ptr<const Deblurrer> deblurrer, bool waits);
  /// Waits for the deblurrer, which may be in the middle of an image.
  ~DeblurQueue() = default;
  DeblurQueue(const DeblurQueue&) = delete;
  DeblurQueue& operator=(const DeblurQueue&) = delete;

  void offer(DeblurTask task);
  /// The result of the keyframe begun last, if it is there, was sharpened and `isKept` still knows the keyframe.
  std::optional<DeblurredKeyframe> take(const IsKept& isKept);
  /// Begins with the next keyframe if it is time to. To be called with every image, at its time [ns].
  void begin(std::int64_t now_ns, const IsKept& isKept);
  /// The keyframes are no more. A result that is still being worked on will be thrown away.
  void clear();

  DeblurCounts counts() const;

 private:
  struct Waiting {
    DeblurTask task;
    bool held_up = false;  // it was its turn, but the thread was busy
  };
  struct Running {
    std::uint32_t keyframe = 0;
    bool wanted = true;
    std::future<DeblurResult> result;
  };

  void giveUp(const Waiting& waiting);
  void dropDeparted(const IsKept& isKept);
  bool isPeriodSince(const std::optional<std::int64_t>& turn_ns, std::int64_t now_ns) const;

  DeblurQueueConfig config_;
  std::shared_ptr<const Deblurrer> deblurrer_;
  bool waits_;
  std::vector<Waiting> waiting_;           // by blur, longest first; at most config_.length
  std::optional<Running> running_;         // its thread is joined when it goes
  std::optional<std::int64_t> begun_ns_;   // when the last one was begun
  std::optional<std::int64_t> missed_ns_;  // when the last turn was missed, or one was begun
  DeblurCounts counts_;
};

}  // namespace mba_vo
