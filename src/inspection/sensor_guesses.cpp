#include <algorithm>
#include <cmath>

#include "mba_vo/inspection/judgements.h"
#include "wording.h"

namespace mba_vo {
namespace {

constexpr double kSure = 6.0;          // standard deviations of the row time from 0
constexpr double kShortestRow = 3e-6;  // [s]; what less rolls does no harm
constexpr std::size_t kFewest = 40;    // images with motion
constexpr double kSteady = 1.7;        // intervals; beyond, an image is missing in between

/// One image whose motion differs from that of the next: rows that come later are ahead in the change.
struct Sample {
  double change;  // of the velocity within the interval [px / s]
  double shear;   // [px / row]
};

void addSamples(const ImageFacts& a, const ImageFacts& b, const ImageFacts& c, double interval,
                std::vector<Sample>& samples) {
  if (!a.motion || !b.motion || !c.motion) return;
  const double dt = interval;
  samples.push_back({(c.motion->flow.x - a.motion->flow.x) / (2.0 * dt), b.motion->shear_x});
  samples.push_back({(c.motion->flow.y - a.motion->flow.y) / (2.0 * dt), b.motion->shear_y});
}

}  // namespace

/// Between two images, row r sees the motion from r row times later on: its flow differs by r row_time times the change
/// of the velocity. What else shears the flow, depths above all, goes with the velocity, not with its change.
std::optional<RowTime> guessRowTime(const std::vector<ImageFacts>& images) {
  const double interval = usualInterval(images);
  std::vector<Sample> samples;
  for (std::size_t i = 1; i + 1 < images.size(); ++i) {
    const double around = 1e-9 * static_cast<double>(images[i + 1].stamp_ns - images[i - 1].stamp_ns);
    if (i < 2 || around <= 0.0 || around > 2.0 * kSteady * interval) continue;
    addSamples(images[i - 1], images[i], images[i + 1], interval, samples);
  }
  if (samples.size() < 2 * kFewest) return std::nullopt;
  double row_time = 0.0;
  double information = 0.0;
  double squares = 0.0;
  double scale = 1e9;  // of the errors; what is far beyond does not count
  for (int round = 0; round < 10; ++round) {
    double sum = 0.0;
    information = 0.0;
    squares = 0.0;
    double weights = 0.0;
    std::vector<double> errors;
    for (const Sample& s : samples) {
      const double error = s.shear - row_time * s.change;
      errors.push_back(std::abs(error));
      const double weight = 1.0 / (1.0 + (error / scale) * (error / scale));
      sum += weight * s.change * s.shear;
      information += weight * s.change * s.change;
      squares += weight * error * error;
      weights += weight;
    }
    if (information <= 0.0) return std::nullopt;
    row_time = sum / information;
    squares /= weights;
    scale = std::max(1e-9, 2.0 * quantile(errors, 0.5));
  }
  return RowTime{row_time, std::sqrt(squares / information)};
}

std::vector<Finding> guessSensor(const CameraFacts& facts) {
  std::vector<Finding> findings;
  const std::optional<RowTime> row_time = guessRowTime(facts.images);
  if (row_time && std::abs(row_time->seconds) > std::max(kShortestRow, kSure * row_time->sigma)) {
    findings.push_back({Check::kRollingShutter,
                        "a guess: where the motion changes, lower rows see it sooner or later (" +
                            number(std::abs(row_time->seconds) / row_time->sigma, 2) + " standard deviations)"});
  }
  return findings;
}

std::vector<Finding> judge(const CameraFacts& facts) {
  std::vector<Finding> all = judgeCalibration(facts);
  for (const auto& some : {judgeStamps(facts.images), judgeImages(facts), judgeExposures(facts), judgeResponse(facts),
                           guessSensor(facts)}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace mba_vo
