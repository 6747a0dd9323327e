#include "mba_vo/deblur/half_quadratic_solver.h"

#include <cmath>

#include "mba_vo/image/multiversion.h"

namespace mba_vo {
namespace {

MBA_VO_MULTIVERSION
void multiply(const float* __restrict weight, float* __restrict values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) values[i] *= weight[i];
}

/// y += factor x
MBA_VO_MULTIVERSION
void addScaled(float factor, const float* __restrict x, float* __restrict y, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) y[i] += factor * x[i];
}

/// y = x + factor y
MBA_VO_MULTIVERSION
void scaleAndAdd(float factor, const float* __restrict x, float* __restrict y, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) y[i] = x[i] + factor * y[i];
}

MBA_VO_MULTIVERSION
double dot(const float* __restrict x, const float* __restrict y, std::size_t count) {
  constexpr std::size_t kBlock = 16;
  double total = 0.0;
  std::size_t i = 0;
  while (i + kBlock <= count) {
    float sum[kBlock] = {};
    for (std::size_t n = 0; n < 64 && i + kBlock <= count; ++n, i += kBlock) {
      for (std::size_t k = 0; k < kBlock; ++k) sum[k] += x[i + k] * y[i + k];
    }
    for (const float s : sum) total += static_cast<double>(s);
  }
  for (; i < count; ++i) total += static_cast<double>(x[i] * y[i]);
  return total;
}

/// out += factor D^T D x, D being the forward differences with none across the border.
MBA_VO_MULTIVERSION
void addLaplacian(const float* __restrict image, int width, int height, float factor, float* __restrict out) {
  for (int y = 0; y < height; ++y) {
    const float* row = image + y * width;
    const float* above = y > 0 ? row - width : row;
    const float* below = y + 1 < height ? row + width : row;
    float* target = out + y * width;
    for (int x = 1; x + 1 < width; ++x) {
      target[x] += factor * (4.0F * row[x] - row[x - 1] - row[x + 1] - above[x] - below[x]);
    }
    const int last = width - 1;
    target[0] += factor * (3.0F * row[0] - row[1] - above[0] - below[0]);
    target[last] += factor * (3.0F * row[last] - row[last - 1] - above[last] - below[last]);
  }
}

/// The auxiliary variables.
struct Gradient {
  cv::Mat1f x, y;
};

MBA_VO_MULTIVERSION
void shrinkRow(const float* __restrict row, const float* __restrict below, int width, float threshold,
               float* __restrict dx, float* __restrict dy) {
  for (int x = 0; x + 1 < width; ++x) {
    const float gx = row[x + 1] - row[x];
    const float gy = below[x] - row[x];
    const float squared = gx * gx + gy * gy + 1e-12F;
    const float inverse = 1.0F / std::sqrt(squared);
    const float s = 1.0F - threshold * inverse;
    const float scale = s > 0.0F ? s : 0.0F;
    dx[x] = scale * gx;
    dy[x] = scale * gy;
  }
  dx[width - 1] = 0.0F;
  dy[width - 1] = 0.0F;
}

/// out += factor D^T d
MBA_VO_MULTIVERSION
void addDivergence(const Gradient& d, float factor, cv::Mat1f& out) {
  for (int y = 0; y < out.rows; ++y) {
    float* __restrict target = out[y];
    const float* __restrict dx = d.x[y];
    const float* __restrict dy = d.y[y];
    for (int x = 0; x < out.cols; ++x) target[x] -= factor * (dx[x] + dy[x]);
    for (int x = 1; x < out.cols; ++x) target[x] += factor * dx[x - 1];
    if (y == 0) continue;
    const float* __restrict above = d.y[y - 1];
    for (int x = 0; x < out.cols; ++x) target[x] += factor * above[x];
  }
}

class Solver {
 public:
  Solver(const std::vector<BlurredObservation>& observations, const HalfQuadraticConfig& config, cv::Mat1f& latent)
      : observations_(observations), config_(config), latent_(latent), count_(latent.total()) {
    data_ = cv::Mat1f(latent.size(), 0.0F);
    for (const BlurredObservation& o : observations_) {
      blurred_ = o.image.clone();
      weigh(o);
      o.blur->addTransposed(blurred_, data_);
    }
    d_.x.create(latent.size());
    d_.y.create(latent.size());
    direction_.create(latent.size());
    product_.create(latent.size());
  }

  void run() {
    coupling_ = config_.first_coupling;
    for (int step = 0; step < config_.steps; ++step, coupling_ *= config_.coupling_factor) {
      shrink();
      conjugateGradients();
    }
  }

 private:
  void weigh(const BlurredObservation& o) { multiply(o.weight[0], blurred_[0], blurred_.total()); }

  void shrink() {
    const float threshold = config_.prior_weight / coupling_;
    for (int y = 0; y < latent_.rows; ++y) {
      const float* below = latent_[y + 1 < latent_.rows ? y + 1 : y];
      shrinkRow(latent_[y], below, latent_.cols, threshold, d_.x[y], d_.y[y]);
    }
  }

  /// product = (sum A^T W A + coupling D^T D) x
  void applySystem(const cv::Mat1f& x) {
    product_.setTo(0.0F);
    for (const BlurredObservation& o : observations_) {
      o.blur->apply(x, blurred_);
      weigh(o);
      o.blur->addTransposed(blurred_, product_);
    }
    addLaplacian(x[0], x.cols, x.rows, coupling_, product_[0]);
  }

  void conjugateGradients() {
    applySystem(latent_);
    residual_ = data_ - product_;
    addDivergence(d_, coupling_, residual_);
    residual_.copyTo(direction_);
    double squared = dot(residual_[0], residual_[0], count_);
    for (int i = 0; i < config_.iterations && squared > 0.0; ++i) {
      applySystem(direction_);
      const double curvature = dot(direction_[0], product_[0], count_);
      if (!(curvature > 0.0)) break;
      const auto length = static_cast<float>(squared / curvature);
      addScaled(length, direction_[0], latent_[0], count_);
      addScaled(-length, product_[0], residual_[0], count_);
      const double next = dot(residual_[0], residual_[0], count_);
      scaleAndAdd(static_cast<float>(next / squared), residual_[0], direction_[0], count_);
      squared = next;
    }
  }

  const std::vector<BlurredObservation>& observations_;
  HalfQuadraticConfig config_;
  cv::Mat1f& latent_;
  std::size_t count_;
  float coupling_ = 0.0F;
  cv::Mat1f data_;  // sum A^T W B
  Gradient d_;
  cv::Mat1f blurred_, direction_, product_, residual_;
};

}  // namespace

void solveHalfQuadratic(const std::vector<BlurredObservation>& observations, const HalfQuadraticConfig& config,
                        cv::Mat1f& latent) {
  Solver(observations, config, latent).run();
}

}  // namespace mba_vo
