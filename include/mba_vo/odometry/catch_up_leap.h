#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

namespace mba_vo {

/// How far to leap over frames that wait, so that catching up comes to an end however slow the machine is: to the
/// newest one, by trial. Where that fails, half as far is tried next. Time is that of the images that come in
/// meanwhile: where they wait for nobody, as offline, none passes, and no frame is leapt over, unless very many wait
/// when it begins.
class CatchUpLeap {
 public:
  /// Images come in faster than they can be tracked: there is no time to lose.
  void hurry() { hurried_ = true; }
  bool isHurried() const { return hurried_; }
  /// Of the frames that wait, one or more, the newest of which is of `newest_ns`: how far from the first the next to be
  /// tried is.
  std::size_t over(std::size_t waiting, std::int64_t newest_ns);
  /// That so many were to be leapt over has failed.
  void fail(std::size_t frames) { furthest_ = frames / 2; }
  /// So many were leapt over: the next may be twice as far. What failed was seen from farther away.
  void reach(std::size_t frames);
  /// Not even the oldest one could be aligned.
  void lose() { ++lost_; }
  /// Several in a row, and there is no time for more.
  bool isHopeless() const { return pressed_ && lost_ >= kHopeless; }
  /// What is aligned to has changed: it may reach further.
  void lookFurther() { furthest_ = kAnywhere; }
  /// Images have come in since it began: there is no time for anything else.
  bool isPressed() const { return pressed_; }
  /// Nothing waits any more.
  void reset() { *this = {}; }

 private:
  static constexpr int kHopeless = 3;  // one or two in a row are found again by the next
  static constexpr std::size_t kAnywhere = std::numeric_limits<std::size_t>::max();

  std::optional<std::int64_t> begin_ns_;  // of the newest frame when it began
  bool hurried_ = false;
  bool pressed_ = false;
  std::size_t furthest_ = kAnywhere;
  int lost_ = 0;  // in a row
};

}  // namespace mba_vo
