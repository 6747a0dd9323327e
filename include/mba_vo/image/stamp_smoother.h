#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace mba_vo {

/// Stamps of arrival jitter and come in bursts; the camera has taken the images at its own rate. Where the stamps
/// themselves say so, they are taken back to that rate. All others, dropped frames and changes of the rate included,
/// stay as they are.
class StampSmoother {
 public:
  /// For the next image, `images` after the last one by its number: its stamp, or a better one. Stamps must increase,
  /// and so do those returned.
  std::int64_t smooth(std::int64_t stamp_ns, std::uint64_t images);
  void reset() { *this = StampSmoother(); }

 private:
  struct Stamp {
    double index;  // in images
    std::int64_t ns;
  };
  struct Line {
    double offset;  // of the newest stamp from it [ns]
    double period;  // [ns] of an image
  };

  void judge(double interval);
  Line fit() const;
  void followCamera();

  std::deque<double> intervals_;  // the newest two [ns]
  std::deque<bool> unexplained_;  // of the newest intervals
  bool jitters_ = false;
  std::deque<Stamp> stamps_;             // the newest
  int off_ = 0;                          // so many of them in a row are far from the line, all to one side: the sign
  std::optional<std::int64_t> last_ns_;  // returned
};

}  // namespace mba_vo
