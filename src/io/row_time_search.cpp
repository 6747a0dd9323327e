#include "mba_vo/io/row_time_search.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

namespace mba_vo {
namespace {

constexpr double kFirstStep = 0.5;      // of the limit
constexpr int kHalvings = 3;            // of the step
constexpr double kNothingAgrees = 1e3;  // [grey levels] residual where no keyframe came about
constexpr std::size_t kIntervals = 30;  // that tell the frame interval

/// The first images of a sequence.
class FirstImages : public SequenceReader {
 public:
  FirstImages(std::unique_ptr<SequenceReader> sequence, std::size_t images)
      : sequence_(std::move(sequence)), left_(images) {}
  CameraCalibration calibration() const override { return sequence_->calibration(); }
  std::size_t size() const override { return std::min(sequence_->size(), left_); }
  std::optional<SequenceImage> next() override {
    if (left_ == 0) return std::nullopt;
    --left_;
    return sequence_->next();
  }

 private:
  std::unique_ptr<SequenceReader> sequence_;
  std::size_t left_;
};

double medianInterval(SequenceReader& reader) {  // [s]
  std::vector<double> intervals;
  std::optional<SequenceImage> last = reader.next();
  while (last && intervals.size() < kIntervals) {
    std::optional<SequenceImage> next = reader.next();
    if (!next) break;
    intervals.push_back(1e-9 * static_cast<double>(next->stamp_ns - last->stamp_ns));
    last = std::move(next);
  }
  if (intervals.empty()) throw std::runtime_error("a single image does not tell the row time");
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// Of the windows, whose keyframes move as the frames around them say. The tracker's residuals tell less: it finds the
/// velocity by the rows, which makes up for a wrong row time.
double meanResidual(const RunLog& log) {
  double sum = 0.0;
  for (const KeyframeReport& keyframe : log.keyframes()) sum += keyframe.rms;
  return log.keyframes().empty() ? kNothingAgrees : sum / static_cast<double>(log.keyframes().size());
}

/// Minimum of the parabola through the best trial and its neighbours at `step`.
double vertex(double at, double left, double best, double right, double step) {
  const double curvature = left - 2.0 * best + right;
  return curvature > 0.0 ? at + 0.5 * step * (left - right) / curvature : at;
}

}  // namespace

RowTimeTrial findRowTime(double limit, const std::function<double(double)>& residual) {
  RowTimeTrial best{0.0, residual(0.0)};
  double left = best.residual;
  double right = best.residual;
  const auto tryOut = [&](double row_time, RowTimeTrial& better) {
    if (std::abs(row_time) > limit * 1.001) return best.residual;
    const double found = residual(row_time);
    if (found < better.residual) better = {row_time, found};
    return found;
  };
  double step = kFirstStep * limit;
  RowTimeTrial first = best;
  for (const double factor : {-2.0, -1.0, 1.0, 2.0}) tryOut(factor * step, first);
  best = first;
  for (int i = 0; i < kHalvings; ++i) {
    step *= 0.5;
    RowTimeTrial better = best;
    left = tryOut(best.row_time - step, better);
    right = tryOut(best.row_time + step, better);
    if (i + 1 < kHalvings) best = better;
  }
  best.row_time =
      std::clamp(best.row_time + std::clamp(vertex(0.0, left, best.residual, right, step), -step, step), -limit, limit);
  return best;
}

RowTimeTrial estimateRowTime(const RowTimeSearch& search) {
  const auto first = search.open();
  const double limit = medianInterval(*first) / first->calibration().height;
  return findRowTime(limit, [&](double row_time) {
    OfflineOptions options = search.options;
    options.config.image.row_time = row_time;
    FirstImages images(search.open(), options.skip + search.images);
    const OfflineResult result = runOffline(images, options, [](std::size_t) {});
    const RowTimeTrial trial{row_time, meanResidual(result.log)};
    if (search.onTrial) search.onTrial(trial);
    return trial.residual;
  });
}

}  // namespace mba_vo
