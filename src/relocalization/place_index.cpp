#include "mba_vo/relocalization/place_index.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "place_search.h"

namespace mba_vo {
namespace {

using D = PlaceDescriptor;

constexpr double kBlur = 0.7;               // [px of either image]: hides that views are not shifted by whole pixels
constexpr double kLeastContrast = 0.02;     // of the mean brightness; below it there is only noise
constexpr double kSharePower = 0.25;        // of what both show, by which likeness is multiplied: found on hand_office
constexpr int kFinerSteps = 2;              // [px of the finer image] around the best coarse shift
constexpr std::size_t kComparedFinely = 8;  // so many times as many keyframes as are asked for

/// Coarse pixels by which the other view is shifted.
cv::Point shiftOf(int number) {
  return {2 * (number % D::kShiftsX - D::kShiftsX / 2), 2 * (number / D::kShiftsX - D::kShiftsY / 2)};
}

/// What two images of that size have in common if what is here in the one, is there + shift in the other.
cv::Rect common(const cv::Size& size, const cv::Point& shift) {
  return cv::Rect({0, 0}, size) & (cv::Rect({0, 0}, size) - shift);
}

cv::Mat1f fineImage(const ImagePyramid& pyramid) {
  int level = 0;
  while (level + 1 < pyramid.levels() && pyramid.level(level + 1).intensity.cols >= 2 * D::kWidth) ++level;
  cv::Mat1f image = pyramid.level(level).intensity.clone();
  const cv::Mat valid = image == image;  // NaN differs from itself
  image.setTo(static_cast<float>(cv::mean(image, valid)[0]), ~valid);
  cv::Mat1f small;
  cv::resize(image, small, {2 * D::kWidth, 2 * D::kHeight}, 0.0, 0.0, cv::INTER_AREA);
  return small;
}

struct Spread {
  float mean, norm;  // norm: without the mean
};

Spread spreadOf(const cv::Mat1f& part) {
  cv::Scalar mean, sigma;
  cv::meanStdDev(part, mean, sigma);
  return {static_cast<float>(mean[0]), static_cast<float>(sigma[0] * std::sqrt(static_cast<double>(part.total())))};
}

/// For each shift the part of the view that the other one shows too, its mean removed and of unit norm.
std::vector<float> shiftedViews(const D& view) {
  std::vector<float> views(static_cast<std::size_t>(D::kShifts * D::kPixels), 0.0F);
  const cv::Mat1f image(D::kHeight, D::kWidth, const_cast<float*>(view.coarse.data()));
  for (int s = 0; s < D::kShifts; ++s) {
    const cv::Rect here = common(image.size(), shiftOf(s));
    const Spread spread = spreadOf(image(here));
    if (!(spread.norm > 0.0F)) continue;
    const cv::Mat1f there(D::kHeight, D::kWidth, views.data() + static_cast<std::ptrdiff_t>(s) * D::kPixels);
    cv::Mat1f part = there(here + shiftOf(s));
    image(here).convertTo(part, CV_32F, 1.0 / static_cast<double>(spread.norm),
                          -static_cast<double>(spread.mean) / static_cast<double>(spread.norm));
  }
  return views;
}

/// Of what both show; -1 where one shows nothing.
double correlation(const cv::Mat1f& view, const cv::Mat1f& other, const cv::Point& shift) {
  const cv::Rect here = common(view.size(), shift);
  if (here.width < view.cols / 2 || here.height < view.rows / 2) return -1.0;
  const Spread a = spreadOf(view(here)), b = spreadOf(other(here + shift));
  const double norms = static_cast<double>(a.norm) * static_cast<double>(b.norm);
  if (!(norms > 0.0)) return -1.0;
  const double means = static_cast<double>(a.mean) * static_cast<double>(b.mean) * here.area();
  // What is small is easily alike.
  const double share = static_cast<double>(here.area()) / static_cast<double>(view.total());
  return std::pow(share, kSharePower) * (view(here).dot(other(here + shift)) - means) / norms;
}

/// The best shift near a coarse one.
PlaceCandidate compareFinely(const D& view, const std::array<float, 4 * D::kPixels>& keyframe, int coarse_shift) {
  const cv::Mat1f here(2 * D::kHeight, 2 * D::kWidth, const_cast<float*>(view.fine.data()));
  const cv::Mat1f there(2 * D::kHeight, 2 * D::kWidth, const_cast<float*>(keyframe.data()));
  PlaceCandidate best;
  for (int y = -kFinerSteps; y <= kFinerSteps; ++y) {
    for (int x = -kFinerSteps; x <= kFinerSteps; ++x) {
      const cv::Point shift = 2 * shiftOf(coarse_shift) + cv::Point(x, y);
      const double value = correlation(here, there, shift);
      if (value <= best.correlation) continue;
      best.correlation = value;
      best.shift_px = {0.5 * shift.x * static_cast<double>(view.px_per_pixel_x),
                       0.5 * shift.y * static_cast<double>(view.px_per_pixel_y)};
    }
  }
  return best;
}

}  // namespace

PlaceDescriptor::PlaceDescriptor(const ImagePyramid& pyramid) {
  const cv::Mat1f& finest = pyramid.level(0).intensity;
  px_per_pixel_x = static_cast<float>(finest.cols) / kWidth;
  px_per_pixel_y = static_cast<float>(finest.rows) / kHeight;
  const cv::Mat1f small = fineImage(pyramid);
  cv::Mat1f fine_image(2 * kHeight, 2 * kWidth, fine.data());
  cv::GaussianBlur(small, fine_image, {}, kBlur, 0.0, cv::BORDER_REPLICATE);
  cv::Mat1f coarse_image(kHeight, kWidth, coarse.data());
  cv::resize(small, coarse_image, coarse_image.size(), 0.0, 0.0, cv::INTER_AREA);
  cv::GaussianBlur(coarse_image, coarse_image, {}, kBlur, 0.0, cv::BORDER_REPLICATE);
  for (int s = 0; s < kShifts; ++s) {
    const cv::Mat1f part = coarse_image(common(coarse_image.size(), shiftOf(s)) + shiftOf(s));
    const Spread spread = spreadOf(part);
    const double least = kLeastContrast * std::abs(static_cast<double>(spread.mean)) * std::sqrt(part.total());
    inverse_norm[static_cast<std::size_t>(s)] = static_cast<double>(spread.norm) > least ? 1.0F / spread.norm : 0.0F;
  }
}

void PlaceIndex::put(std::size_t place, const PlaceDescriptor& descriptor) {
  Block& block = blocks_[place / kLanes];
  const std::size_t lane = place % kLanes;
  for (std::size_t p = 0; p < descriptor.coarse.size(); ++p) block.pixels[p * kLanes + lane] = descriptor.coarse[p];
  for (std::size_t s = 0; s < descriptor.inverse_norm.size(); ++s) {
    block.inverse_norms[s * kLanes + lane] = descriptor.inverse_norm[s];
  }
}

void PlaceIndex::move(std::size_t from, std::size_t to) {
  const Block& source = blocks_[from / kLanes];
  Block& target = blocks_[to / kLanes];
  for (std::size_t p = 0; p < D::kPixels; ++p) {
    target.pixels[p * kLanes + to % kLanes] = source.pixels[p * kLanes + from % kLanes];
  }
  for (std::size_t s = 0; s < D::kShifts; ++s) {
    target.inverse_norms[s * kLanes + to % kLanes] = source.inverse_norms[s * kLanes + from % kLanes];
  }
  keyframes_[to] = keyframes_[from];
}

void PlaceIndex::add(KeyframeId keyframe, const PlaceDescriptor& descriptor) {
  remove(keyframe);
  if (keyframes_.size() % kLanes == 0) blocks_.emplace_back();
  keyframes_.push_back({keyframe, descriptor.fine});
  put(keyframes_.size() - 1, descriptor);
}

void PlaceIndex::remove(KeyframeId keyframe) {
  const auto found = std::find_if(keyframes_.begin(), keyframes_.end(),
                                  [&](const Entry& entry) { return entry.keyframe == keyframe; });
  if (found == keyframes_.end()) return;
  move(keyframes_.size() - 1, static_cast<std::size_t>(found - keyframes_.begin()));
  keyframes_.pop_back();
  if (keyframes_.size() % kLanes == 0) blocks_.pop_back();
}

std::vector<PlaceCandidate> PlaceIndex::search(const PlaceDescriptor& view, std::size_t most,
                                               const std::function<bool(KeyframeId)>& isWanted) const {
  struct Coarse {
    float correlation;
    int shift;
    std::size_t place;
  };
  const std::vector<float> views = shiftedViews(view);
  std::vector<Coarse> found;
  std::array<float, kLanes> best{};
  std::array<int, kLanes> shifts{};
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    bestProducts(views.data(), blocks_[b].pixels.data(), blocks_[b].inverse_norms.data(), best.data(), shifts.data());
    for (std::size_t place = b * kLanes; place < std::min((b + 1) * kLanes, keyframes_.size()); ++place) {
      if (!isWanted(keyframes_[place].keyframe)) continue;
      found.push_back({best[place % kLanes], shifts[place % kLanes], place});
    }
  }
  const auto compared = found.begin() + static_cast<std::ptrdiff_t>(std::min(found.size(), kComparedFinely * most));
  std::partial_sort(found.begin(), compared, found.end(), [](const Coarse& l, const Coarse& r) {
    return std::pair(-l.correlation, l.place) < std::pair(-r.correlation, r.place);
  });
  std::vector<PlaceCandidate> candidates;
  for (auto c = found.begin(); c != compared; ++c) {
    candidates.push_back(compareFinely(view, keyframes_[c->place].fine, c->shift));
    candidates.back().keyframe = keyframes_[c->place].keyframe;
  }
  std::sort(candidates.begin(), candidates.end(), [](const PlaceCandidate& l, const PlaceCandidate& r) {
    return std::pair(-l.correlation, l.keyframe) < std::pair(-r.correlation, r.keyframe);
  });
  if (candidates.size() > most) candidates.resize(most);
  return candidates;
}

}  // namespace mba_vo
