#pragma once

#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "mba_vo/deblur/blur_operator.h"

namespace mba_vo::test {

inline cv::Mat1f randomImage(cv::Size size, int seed) {
  cv::RNG rng(static_cast<std::uint64_t>(seed));
  cv::Mat1f image(size);
  rng.fill(image, cv::RNG::UNIFORM, 0.0, 255.0);
  return image;
}

/// <A x, y> = <x, A^T y>.
inline void expectExactTranspose(const BlurOperator& blur) {
  const cv::Mat1f x = randomImage(blur.grid().size, 1);
  const cv::Mat1f y = randomImage(blur.observedSize(), 2);
  cv::Mat1f Ax;
  blur.apply(x, Ax);
  cv::Mat1f Aty(x.size(), 0.0F);
  blur.addTransposed(y, Aty);
  const double left = Ax.dot(y);
  EXPECT_NEAR(left, x.dot(Aty), 1e-6 * left);
}

}  // namespace mba_vo::test
