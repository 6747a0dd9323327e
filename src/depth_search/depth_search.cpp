#include "mba_vo/depth_search/depth_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "mba_vo/depth_search/patch_match.h"

namespace mba_vo {
namespace {

constexpr double kFarthest = std::numeric_limits<double>::infinity();
constexpr double kBorder = 6.0;     // of the frame, for the patch and the refinement [px]
constexpr float kMaxOffset = 4.5F;  // of a patch pixel; larger means that the scale changed too much [px]
constexpr float kNoEnergy = std::numeric_limits<float>::infinity();
constexpr int kMaxSteps = 512;     // along the line
constexpr double kNearest = 4.0;   // times the median inverse depth (docs/decisions/2026-11-29-near-things.md)
constexpr double kStep = 1.0;      // along the line [px]
constexpr int kNeighbourhood = 2;  // steps around the best one that do not count as second best
constexpr int kRefinements = 4;
constexpr double kMaxRefinement = 1.0;  // out of the range [px]
constexpr int kMaxSegments = 24;
constexpr double kSegmentLength = 10.0;  // on which the shape of the patch is kept [px]
constexpr double kTolerance = 12.0;      // accepted residual per pixel, apart from misalignment [grey levels]
constexpr double kMisalignment = 0.3;    // accepted misalignment [px]
constexpr double kTellingLength = 10.0;  // range that holds enough alternatives [px]
constexpr double kClearQuality = 20.0;   // from which on the energies of the scan are clear enough
constexpr double kMaxQuality = 1e3;      // where nothing else could be compared
constexpr float kScanSpacing = 2.0F;     // of the samples along the blur [px]
constexpr float kRefineSpacing = 1.0F;   // [px]
constexpr double kBlurError = 0.02;      // of the line, per length of the blur: trajectory and planes are not exact
constexpr double kBlurChange = 2.0;      // within a segment [px]

double huberEnergy(double residual, double threshold) {
  const double r = std::abs(residual);
  return r <= threshold ? r * r : threshold * (2.0 * r - threshold);
}

bool hasUsableShape(const SearchPatch& patch) {
  if (!patch.valid) return false;
  for (std::size_t k = 0; k < SearchPatch::kSize; ++k) {
    if (std::abs(patch.dx[k]) > kMaxOffset || std::abs(patch.dy[k]) > kMaxOffset) return false;
  }
  return true;
}

/// Energy up to which a match counts: some noise, and a misalignment that costs more where the gradients are high.
double energyThreshold(const cv::Mat1f& image, const Eigen::Vector2i& pixel, double huber_threshold) {
  const PatchPattern pattern = PatchPattern::spread8();
  double sum = 0.0;
  for (std::size_t k = 0; k < SearchPatch::kSize; ++k) {
    const int x = std::clamp(pixel.x() + pattern.dx[k], 1, image.cols - 2);
    const int y = std::clamp(pixel.y() + pattern.dy[k], 1, image.rows - 2);
    const double gradient = 0.5 * std::hypot(image(y, x + 1) - image(y, x - 1), image(y + 1, x) - image(y - 1, x));
    sum += huberEnergy(kTolerance + kMisalignment * gradient, huber_threshold);
  }
  return sum;
}

void fail(ImmaturePoint& point) {
  ++point.failures;
  point.state = point.failures >= 2 ? ImmaturePoint::State::kOutlier : ImmaturePoint::State::kBadCondition;
}

}  // namespace

ImmaturePoint makeImmaturePoint(const ImagePyramid& host, const Eigen::Vector2i& pixel,
                                const DepthSearchConfig& config) {
  ImmaturePoint point;
  point.pixel = pixel;
  point.energy_threshold = energyThreshold(host.level(0).intensity, pixel, config.huber_threshold);
  return point;
}

DepthSearcher::DepthSearcher(const ImagePyramid& host, const ImagePyramid& frame, const ExposureTrajectory& T_host,
                             double gain, double offset, const DepthSearchConfig& config,
                             const SearchHost& known_of_host, const VignetteRatio& vignette)
    : DepthSearcher(host.level(0), frame.level(0), withoutBlurOf(known_of_host, T_host), gain, offset, config,
                    known_of_host, vignette) {}

DepthSearcher::DepthSearcher(const ImageLevel& host, const ImageLevel& frame, const ExposureTrajectory& T_host,
                             double gain, double offset, const DepthSearchConfig& config,
                             const SearchHost& known_of_host, const VignetteRatio& vignette)
    : host_(&host),
      frame_(&frame),
      config_(config),
      nearest_(kNearest * known_of_host.inverse_depth),
      T_host_(T_host),
      T_frame_host_(T_host.T_reference_mid.inverse()),
      T_frame_host_row_(T_frame_host_, known_of_host.motion),
      gain_(gain),
      offset_(offset),
      vignette_(vignette),
      transform_(host_->camera, frame_->camera, T_frame_host_),
      patch_maker_(*host_, frame_->camera, ExposedPoses(T_host), gain, offset, vignette, config.min_blur_px) {}

void DepthSearcher::search(ImmaturePoint& point) const {
  if (point.state == ImmaturePoint::State::kOutlier || point.measured.known()) return;
  if (!(point.energy_threshold > 0.0)) {
    point.energy_threshold = energyThreshold(host_->intensity, point.pixel, config_.huber_threshold);
  }
  if (host_->camera.row_time != 0.0 || frame_->camera.row_time != 0.0) {
    searchRolling(point);
    return;
  }
  const EpipolarLine line(transform_, point.pixel.cast<double>());
  Range range{};
  if (chooseRange(line, point, range)) searchRange({line, patch_maker_}, range, point);
}

void DepthSearcher::searchRange(const Line& line, const Range& range, ImmaturePoint& point) const {
  using State = ImmaturePoint::State;
  const Scan found = scan(point, line, range);
  if (!std::isfinite(found.best.energy)) {
    point.state = State::kOutOfBounds;  // nothing but invalid pixels
    return;
  }
  Match match = found.best;
  if (!refine(point, line, range, match)) {
    point.state = State::kBadCondition;
    return;
  }
  if (!(match.energy <= point.energy_threshold)) {
    fail(point);
    return;
  }
  if (!narrow(line.epipolar, range, match, point)) {
    point.state = State::kBadCondition;
    return;
  }
  // A short range holds no alternative: then the quality of an earlier, longer search stands.
  const double quality = qualityOf(point, line, range, match, found);
  const bool is_telling = range.end - range.begin > kTellingLength || point.quality == 0.0;
  point.quality = is_telling ? quality : std::min(point.quality, quality);
  point.failures = 0;
  point.state = State::kGood;
}

bool DepthSearcher::isInside(const Eigen::Vector2d& pixel) const { return frame_->camera.contains(pixel, kBorder); }

/// False if there is nothing to search: the state says why.
bool DepthSearcher::chooseRange(const EpipolarLine& line, ImmaturePoint& point, Range& range) const {
  using State = ImmaturePoint::State;
  if (!line.isValid()) {
    point.state = State::kBadCondition;
    return false;
  }
  range.begin = line.distanceOf(point.inverse_depth_min);
  range.bounded = point.hasDepth();
  range.end = range.bounded ? line.distanceOf(point.inverse_depth_max) : kFarthest;
  if (range.bounded && std::isfinite(range.end)) {
    point.last_search_length_px = range.end - range.begin;
    if (point.last_search_length_px < config_.min_search_px) {
      point.state = State::kSkipped;
      return false;
    }
  }
  if (!std::isfinite(range.begin) || !isInside(line.pixelAt(range.begin))) {
    point.state = State::kOutOfBounds;
    return false;
  }
  const double longest = range.begin + longestSearch(line, range.begin);
  if (range.end > longest) {
    range.end = longest;
    range.bounded = false;
  }
  // Towards an unknown end as far as the image reaches.
  while (!range.bounded && range.end > range.begin && !isInside(line.pixelAt(range.end))) range.end -= kStep;
  if (!isInside(line.pixelAt(range.end)) || range.end - range.begin < config_.min_search_px) {
    point.state = State::kOutOfBounds;
    return false;
  }
  return true;
}

/// [px]
double DepthSearcher::longestSearch(const EpipolarLine& line, double begin) const {
  const double to_nearest = line.distanceOf(nearest_) - begin;
  return std::isfinite(to_nearest) ? std::max(config_.max_search_px, to_nearest) : config_.max_search_px;
}

/// The patch changes with the depth: its shape slowly, its blur by the part that translation has in it.
int DepthSearcher::segmentCount(const Line& line, const Range& range) const {
  double count = std::ceil((range.end - range.begin) / kSegmentLength);
  const std::optional<Eigen::Vector2d> first = line.patches.blurVector(line.epipolar, range.begin);
  const std::optional<Eigen::Vector2d> last = line.patches.blurVector(line.epipolar, range.end);
  if (first && last) {
    count = std::max(count, std::ceil((*last - *first).norm() / kBlurChange));
  } else {
    count = kMaxSegments;
  }
  return static_cast<int>(std::clamp(count, 1.0, static_cast<double>(kMaxSegments)));
}

/// Energies at steps of about 1 px over the whole range.
DepthSearcher::Scan DepthSearcher::scan(const ImmaturePoint& point, const Line& line, const Range& range) const {
  const double length = range.end - range.begin;
  const int intervals = std::clamp(static_cast<int>(std::ceil(length / kStep)), 1, kMaxSteps - 1);
  const double step = length / intervals;
  const int segments = std::min(segmentCount(line, range), intervals + 1);
  const auto threshold = static_cast<float>(config_.huber_threshold);
  std::array<float, kMaxSteps> energies{};
  int best = 0;
  for (int segment = 0; segment < segments; ++segment) {
    const int first = segment * (intervals + 1) / segments;
    const int last = (segment + 1) * (intervals + 1) / segments;
    const SearchPatch patch =
        line.patches.make(point.pixel, line.epipolar, range.begin + 0.5 * (first + last - 1) * step, kScanSpacing);
    const bool usable = hasUsableShape(patch);
    for (int i = first; i < last; ++i) {
      float& energy = energies[static_cast<std::size_t>(i)];
      energy = kNoEnergy;
      if (!usable) continue;
      const float found =
          patchEnergy(frame_->intensity, patch, line.epipolar.pixelAt(range.begin + i * step), threshold);
      if (found < kNoEnergy) energy = found;  // not NaN
      if (energy < energies[static_cast<std::size_t>(best)]) best = i;
    }
  }
  Scan result;
  const auto energyOf = [&](int i) { return static_cast<double>(energies[static_cast<std::size_t>(i)]); };
  result.best = {range.begin + best * step, energyOf(best), 0.0};
  result.second.energy = kFarthest;
  // The flanks of the best place are no places of their own.
  int low = best;
  while (low > 0 && (best - low < kNeighbourhood || energyOf(low - 1) >= energyOf(low))) --low;
  int high = best;
  while (high < intervals && (high - best < kNeighbourhood || energyOf(high + 1) >= energyOf(high))) ++high;
  for (int i = 0; i <= intervals; ++i) {
    if ((i >= low && i <= high) || !(energyOf(i) < result.second.energy)) continue;
    result.second = {range.begin + i * step, energyOf(i), 0.0};
  }
  return result;
}

/// Gauss-Newton along the line from a step of the scan. Returns false if the place cannot be measured.
bool DepthSearcher::refine(const ImmaturePoint& point, const Line& line, const Range& range, Match& match) const {
  const SearchPatch patch = line.patches.make(point.pixel, line.epipolar, match.s, kRefineSpacing);
  if (!hasUsableShape(patch)) return false;
  const auto threshold = static_cast<float>(config_.huber_threshold);
  const auto energyAt = [&](double s) {
    return static_cast<double>(patchEnergy(frame_->intensity, patch, line.epipolar.pixelAt(s), threshold));
  };
  match.energy = energyAt(match.s);
  if (!std::isfinite(match.energy)) return false;
  LineStep step = linearise(frame_->intensity, patch, line.epipolar.pixelAt(match.s), line.epipolar.direction(),
                            config_.huber_threshold);
  for (int i = 0; i < kRefinements; ++i) {
    if (!(step.hessian > 0.0)) return false;
    const double move = std::clamp(-step.gradient / step.hessian, -0.5 * kStep, 0.5 * kStep);
    const double moved = match.s + move;
    if (moved > range.end + kMaxRefinement && !range.bounded) return false;
    if (moved < range.begin - kMaxRefinement || moved > range.end + kMaxRefinement) {
      match.energy = kFarthest;  // what fits better contradicts the interval
      break;
    }
    const double energy = energyAt(moved);
    if (!(energy < match.energy)) break;
    match.s = moved;
    match.energy = energy;
    step = linearise(frame_->intensity, patch, line.epipolar.pixelAt(match.s), line.epipolar.direction(),
                     config_.huber_threshold);
    if (std::abs(move) < 0.01) break;
  }
  match.error = matchError(step, config_.line_error_px + kBlurError * patch.blur_px);
  return std::isfinite(match.error);
}

/// Energy of the best place away from the match over that of the match; noise makes up for differences near zero.
double DepthSearcher::qualityOf(const ImmaturePoint& point, const Line& line, const Range& range, const Match& match,
                                const Scan& scan) const {
  constexpr double kFloor = static_cast<double>(SearchPatch::kSize);
  Match second = scan.second;
  const auto quality = [&] { return std::min((second.energy + kFloor) / (match.energy + kFloor), kMaxQuality); };
  // Between the steps a repetition may fit as well as the match itself.
  if (quality() < kClearQuality && !refine(point, line, range, second)) second = scan.second;
  return quality();
}

/// Takes the match's interval, cut down by the one known before. Returns false if that would be no improvement.
bool DepthSearcher::narrow(const EpipolarLine& line, const Range& range, const Match& match,
                           ImmaturePoint& point) const {
  double low = match.s - 2.0 * match.error;
  double high = match.s + 2.0 * match.error;
  // Errors of successive searches have causes in common: the earlier interval is trusted up to one standard error.
  low = std::max(low, std::min(range.begin, match.s) - match.error);
  if (range.bounded) high = std::min(high, std::max(range.end, match.s) + match.error);
  if (range.bounded && high - low > range.end - range.begin) return false;
  const double inverse_depth_max = line.inverseDepthAt(high);
  if (!std::isfinite(inverse_depth_max) || inverse_depth_max <= 0.0) return false;
  point.inverse_depth_min = std::max(line.inverseDepthAt(low), 0.0);
  point.inverse_depth_max = inverse_depth_max;
  point.last_search_length_px = high - low;
  return true;
}

}  // namespace mba_vo
