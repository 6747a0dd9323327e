#include "mba_vo/window/window.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "mba_vo/image/parallel_for.h"
#include "mba_vo/window/gauge_fixing.h"
#include "mba_vo/window/imaging_system.h"
#include "mba_vo/window/keyframe_image_error.h"
#include "mba_vo/window/marginalization_policy.h"
#include "mba_vo/window/motion_alignment.h"
#include "mba_vo/window/window_marginalizer.h"
#include "mba_vo/window/window_optimizer.h"
#include "mba_vo/window/window_point_activation.h"
#include "mba_vo/window/window_points.h"
#include "mba_vo/window/window_prior.h"

namespace mba_vo {
namespace {

// Gauge: nothing observes the first window's scale; any strong prior holds it.
constexpr double kScalePrior = 1e10;  // information of the log of the scale

ResidualOptions residualOptions(const WindowConfig& config) {
  ResidualOptions options;
  options.huber_threshold = static_cast<float>(config.huber_threshold);
  options.gradient_constant = static_cast<float>(config.gradient_constant);
  options.sample_spacing_px = static_cast<float>(config.sample_spacing_px);
  options.max_samples = config.max_samples;
  return options;
}

WindowOptimizerOptions optimizerOptions(const WindowConfig& config) {
  WindowOptimizerOptions options;
  options.min_relative_decrease = config.min_relative_decrease;
  return options;
}

}  // namespace

class Window::Impl {
 public:
  explicit Impl(const WindowConfig& config)
      : config_(config),
        residual_options_(residualOptions(config)),
        linearizer_(residual_options_, config.reblur_targets),
        optimizer_(linearizer_, config.huber_threshold, optimizerOptions(config)),
        marginalizer_(linearizer_, WindowMarginalizerOptions()),
        activation_(residual_options_, WindowPointActivationOptions()),
        scale_prior_(kScalePrior) {}

  KeyframeState stateOf(const WindowKeyframe& keyframe) const;
  const KeyframeState& keyframe(KeyframeId id) const { return state_.keyframe(state_.indexOf(id)); }
  void addKeyframe(const WindowKeyframe& keyframe);
  PointId insert(PointState point);
  void addResidual(PointState& point, int target) const;
  std::vector<KeyframeId> keyframesToMarginalize() const;
  void marginalizePoints();
  void marginalize(KeyframeId keyframe);
  const std::vector<PairGeometry>& pairs();

  WindowConfig config_;
  ResidualOptions residual_options_;
  WindowLinearizer linearizer_;
  WindowOptimizer optimizer_;
  std::optional<GaugeFixing> gauge_;  // of the optimisation that goes on, or went on last
  WindowMarginalizer marginalizer_;
  WindowPointActivation activation_;
  ScalePrior scale_prior_;
  bool scale_prior_chosen_ = false;
  WindowState state_;
  std::vector<PairGeometry> pairs_;  // of the current state; empty: not made yet
  PointId next_point_ = 0;
  int keyframes_so_far_ = 0;
  CalibrationCorrection correction_;
};

/// The state in which a keyframe enters the window.
KeyframeState Window::Impl::stateOf(const WindowKeyframe& keyframe) const {
  checkImages(keyframe, config_.reblur_targets);
  KeyframeState added(keyframe);
  added.lacking = keyframe.correction.lacks(correction_);
  // Until its own residuals are known: as strict as the previous keyframe, at first twice the square of the Huber
  // threshold per pixel.
  added.outlier_energy = 2.0 * kResidualPixels * config_.huber_threshold * config_.huber_threshold;
  if (!state_.keyframes.empty()) {
    const KeyframeState& previous = state_.keyframes.back();
    added.outlier_energy = previous.outlier_energy;
    added.huber_threshold = previous.huber_threshold;
    added.precision = previous.precision;
  }
  return added;
}

void Window::Impl::addKeyframe(const WindowKeyframe& keyframe) {
  for (const KeyframeState& k : state_.keyframes) {
    if (k.id == keyframe.id) {
      throw std::invalid_argument("window: keyframe " + std::to_string(keyframe.id) + " is already in it");
    }
  }
  pairs_.clear();
  state_.keyframes.push_back(stateOf(keyframe));
  state_.prior.appendKeyframe();
  addPriorOf(state_.size() - 1, config_, state_);
  ++keyframes_so_far_;
}

PointId Window::Impl::insert(PointState point) {
  point.id = next_point_++;
  state_.points.push_back(std::move(point));
  return state_.points.back().id;
}

void Window::Impl::addResidual(PointState& point, int target) const {
  const bool known = std::any_of(point.residuals.begin(), point.residuals.end(),
                                 [target](const PatchResidual& r) { return r.target == target; });
  if (known || target == point.host) return;
  point.residuals.emplace_back();
  point.residuals.back().target = target;
}

std::vector<KeyframeId> Window::Impl::keyframesToMarginalize() const {
  const MarginalizationPolicyOptions options{config_.max_keyframes, config_.min_keyframes, config_.max_residuals,
                                             config_.max_residuals_blurred, config_.long_blur_px};
  std::vector<KeyframeId> ids;
  for (const int i : chooseKeyframesToMarginalize(state_, options)) ids.push_back(state_.keyframe(i).id);
  return ids;
}

void Window::Impl::marginalizePoints() {
  scale_prior_.moveToPrior(state_);
  marginalizer_.marginalizeUnseen(state_);
}

void Window::Impl::marginalize(KeyframeId keyframe) {
  const int index = state_.indexOf(keyframe);
  pairs_.clear();
  marginalizePoints();
  marginalizer_.marginalizeHosted(state_, index);
  marginalizer_.marginalizeKeyframe(state_, index);
}

const std::vector<PairGeometry>& Window::Impl::pairs() {
  if (pairs_.empty()) pairs_ = makePairGeometries(state_, config_.reblur_targets);
  return pairs_;
}

Window::Window(const WindowConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Window::~Window() = default;

void Window::addKeyframe(const WindowKeyframe& keyframe) { impl_->addKeyframe(keyframe); }

void Window::replaceImage(KeyframeId id, std::shared_ptr<const ImagePyramid> sharp) {
  impl_->state_.replaceImage(impl_->state_.indexOf(id), std::move(sharp));
  impl_->pairs_.clear();
}

void Window::setExposure(KeyframeId id, double exposure, bool image_is_blurred) {
  impl_->state_.setExposure(impl_->state_.indexOf(id), exposure, image_is_blurred);
  impl_->pairs_.clear();
}

void Window::setMotion(KeyframeId id, const BodyMotion& motion) {
  impl_->state_.setMotion(impl_->state_.indexOf(id), motion);
  impl_->pairs_.clear();
}

bool Window::explainsAsWell(KeyframeId host, const std::shared_ptr<const ImagePyramid>& sharp,
                            const std::vector<ReferencePoint>& points) const {
  const int index = impl_->state_.indexOf(host);
  const auto error = compareHostImages(impl_->state_, index, sharp, points, impl_->linearizer_);
  return error && error->with_sharp_image <= error->with_own_image;
}

PointId Window::addPoint(KeyframeId host, const Eigen::Vector2d& pixel, double inverse_depth,
                         const MeasuredDepth& measured) {
  if (!(inverse_depth > 0.0) || !std::isfinite(inverse_depth)) {
    throw std::invalid_argument("window: inverse depth is " + std::to_string(inverse_depth) + ", must be positive");
  }
  PointState point;
  point.host = impl_->state_.indexOf(host);
  point.pixel = pixel;
  point.inverse_depth = inverse_depth;
  point.measured = measured;
  point.information = measuredDepthTerm(measured, inverse_depth, impl_->state_.meanPrecision()).H;
  for (int t = 0; t < impl_->state_.size(); ++t) impl_->addResidual(point, t);
  return impl_->insert(std::move(point));
}

std::vector<bool> Window::activatePoints(const std::vector<NewPoint>& points) {
  const std::vector<PairGeometry>& pairs = impl_->pairs();
  std::vector<std::optional<PointState>> found(points.size());
  parallelFor(points.size(),
              [&](std::size_t i) { found[i] = impl_->activation_.activate(impl_->state_, pairs, points[i]); });
  std::vector<bool> added;
  for (std::optional<PointState>& point : found) {
    added.push_back(point.has_value());
    if (point) impl_->insert(std::move(*point));
  }
  return added;
}

void Window::addResidualsTo(KeyframeId target) {
  const int index = impl_->state_.indexOf(target);
  for (PointState& point : impl_->state_.points) impl_->addResidual(point, index);
}

bool Window::alignNewest() {
  impl_->pairs_.clear();
  return mba_vo::alignNewest(impl_->state_, impl_->residual_options_);
}

std::optional<KeyframeMotion> Window::align(const WindowKeyframe& frame) const {
  return alignFrame(impl_->state_, impl_->stateOf(frame), impl_->residual_options_);
}

void Window::beginOptimization(int max_iterations) {
  if (!impl_->scale_prior_chosen_ && impl_->state_.size() > 1 && !impl_->state_.hasMeasuredDepths()) {
    impl_->scale_prior_.choose(impl_->state_);
    impl_->scale_prior_chosen_ = impl_->scale_prior_.active();
  }
  impl_->pairs_.clear();
  impl_->gauge_.emplace(impl_->state_);
  impl_->optimizer_.begin(impl_->state_, impl_->scale_prior_, max_iterations);
}

bool Window::iterate() {
  impl_->pairs_.clear();
  return impl_->optimizer_.iterate(impl_->state_, impl_->scale_prior_);
}

WindowSummary Window::endOptimization() {
  const WindowSummary summary = impl_->optimizer_.finish(impl_->state_, impl_->scale_prior_);
  if (!impl_->scale_prior_.active()) impl_->gauge_->restore(impl_->state_);
  return summary;
}

WindowSummary Window::optimize(int max_iterations) {
  beginOptimization(max_iterations);
  for (bool more = true; more;) more = iterate();
  return endOptimization();
}

void Window::setCorrection(const CalibrationCorrection& correction) {
  const bool first = !impl_->correction_.correctsLens() && correction.correctsLens();
  if (first && impl_->state_.size() > 1 && impl_->keyframes_so_far_ <= kMostToForget) {
    beginPriorAnew(impl_->config_, impl_->state_);
    impl_->scale_prior_ = ScalePrior(kScalePrior);
    impl_->scale_prior_chosen_ = false;
  } else {
    impl_->state_.prior.correctCalibration(correction.values - impl_->correction_.values);
  }
  impl_->state_.correction_settled = false;
  impl_->correction_ = correction;
  for (KeyframeState& k : impl_->state_.keyframes) k.lacking = k.correction.lacks(correction);
  impl_->pairs_.clear();
}

void Window::settleCorrection() { impl_->state_.correction_settled = true; }

CalibrationSystem Window::refineRowMotions() {
  impl_->pairs_.clear();
  return mba_vo::refineRowMotions(impl_->state_, impl_->linearizer_);
}

std::vector<KeyframeId> Window::keyframesToMarginalize() const { return impl_->keyframesToMarginalize(); }
void Window::marginalizePoints() { impl_->marginalizePoints(); }
void Window::marginalize(KeyframeId keyframe) { impl_->marginalize(keyframe); }

std::vector<KeyframeId> Window::keyframes() const {
  std::vector<KeyframeId> ids;
  for (const KeyframeState& k : impl_->state_.keyframes) ids.push_back(k.id);
  return ids;
}

SE3 Window::T_map_keyframe(KeyframeId id) const { return impl_->keyframe(id).T_map_keyframe(); }
PinholeCamera Window::camera(KeyframeId id) const { return impl_->keyframe(id).camera(); }
BodyMotion Window::motion(KeyframeId id) const { return impl_->keyframe(id).motion(); }
Vector6 Window::imageMotion(KeyframeId id) const { return impl_->keyframe(id).image_xi; }
AffineBrightness Window::brightness(KeyframeId id) const { return impl_->keyframe(id).brightness(); }

std::vector<WindowPoint> Window::points() const { return describePoints(impl_->state_); }
std::vector<double> Window::inverseDepths() const { return mba_vo::inverseDepths(impl_->state_); }

void Window::setSlopes(const std::vector<std::optional<Eigen::Vector2d>>& slopes) {
  mba_vo::setSlopes(impl_->state_, slopes);
}

int Window::pointCount() const { return static_cast<int>(impl_->state_.points.size()); }
int Window::evaluatedResiduals() const { return impl_->optimizer_.evaluatedResiduals(); }

int Window::residualCount() const {
  const auto add = [](int sum, const PointState& point) { return sum + static_cast<int>(point.residuals.size()); };
  return std::accumulate(impl_->state_.points.begin(), impl_->state_.points.end(), 0, add);
}

}  // namespace mba_vo
