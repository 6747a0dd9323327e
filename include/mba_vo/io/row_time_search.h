#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "mba_vo/io/offline_run.h"

namespace mba_vo {

/// A row time of a rolling shutter that was tried, and how badly the images agree with the map then.
struct RowTimeTrial {
  double row_time = 0.0;  // [s]
  double residual = 0.0;  // mean over the keyframes' windows [grey levels]
};

/// Minimum of `residual` over row times in [-limit, limit] [s], found by trying ever smaller steps around the best one.
RowTimeTrial findRowTime(double limit, const std::function<double(double)>& residual);

struct RowTimeSearch {
  std::function<std::unique_ptr<SequenceReader>()> open;  // the sequence, from its beginning
  OfflineOptions options;
  std::size_t images = 400;                          // used of it, after the skipped ones
  std::function<void(const RowTimeTrial&)> onTrial;  // may be empty
};

/// The row time with which the odometry explains the sequence best. All rows are read within one frame interval, which
/// limits it; a negative one reads the image from below.
RowTimeTrial estimateRowTime(const RowTimeSearch& search);

}  // namespace mba_vo
