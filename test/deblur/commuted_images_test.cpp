#include "mba_vo/deblur/commuted_images.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "deblur/two_frames.h"

namespace mba_vo::commuted_images_test {
namespace {

using test::crossedFrames;
using test::roomSimulator;

constexpr float kNoLimit = std::numeric_limits<float>::infinity();
constexpr float kNoise = 1.0F;  // of rendered images [grey levels]

/// The rendered frames as observations on one grid, with `spoil` added to the neighbour's pixels there [grey levels].
struct Observations {
  explicit Observations(const cv::Rect& place = {}, float spoil = 0.0F)
      : level(crossedFrames().input.image->level(0)),
        depth(test::trueInverseDepth(crossedFrames().keyframe)),
        problem(level, crossedFrames().input.motion, depth, 10.0F, kNoise),
        neighbour(test::geometryOf(crossedFrames()), depth, problem.grid(), laidOver(place, spoil), kNoise, kNoLimit) {}

  cv::Mat1f laidOver(const cv::Rect& place, float spoil) const {
    const DeblurNeighbour& frame = crossedFrames().input.neighbours[0];
    cv::Mat1f image = overlay({&frame, 0, test::geometryOf(crossedFrames()), {}}, depth,
                              denseInverseDepth(frame, roomSimulator().camera(), crossedFrames().input.depths));
    if (!place.empty()) image(place) += spoil;
    return image;
  }

  CommutedImages commuted() const { return commute(problem.keyframe(), neighbour); }

  const ImageLevel& level;
  cv::Mat1f depth;
  LevelProblem problem;
  Observation neighbour;
};

double rms(const cv::Mat1f& a, const cv::Mat1f& b, const cv::Mat1f& known) {
  const cv::Mat1f difference(a - b);
  return std::sqrt(difference.mul(difference).dot(known) / cv::sum(known)[0]);
}

TEST(CommutedImages, AreAlikeToTheNoiseHoweverUnlikeTheImagesAre) {
  const Observations frames;
  const CommutedImages images = frames.commuted();
  EXPECT_GT(cv::sum(images.known)[0], 0.6 * static_cast<double>(frames.level.intensity.total()));
  const double noise = std::sqrt(static_cast<double>(images.keyframe_gain + images.neighbour_gain));
  EXPECT_LT(noise, 0.5);
  EXPECT_LT(rms(images.keyframe, images.neighbour, images.known), 3.0 * noise);  // depth edges do not commute
  EXPECT_GT(rms(frames.problem.keyframe().data().image, frames.neighbour.data().image, images.known), 8.0 * noise);
}

double medianOf(const cv::Mat1f& image) {
  std::vector<float> values(image.begin(), image.end());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// A difference that is as wide as the blurs goes through them undamped.
TEST(ModelVariance, IsLargeWhereTheNeighbourShowsSomethingElse) {
  const cv::Rect place(140, 90, 60, 60);
  const CommutedImages images = Observations(place, 20.0F).commuted();
  const cv::Mat1f variance = modelVariance(images, kNoise, kNoise);
  EXPECT_NEAR(medianOf(variance(cv::Rect(165, 115, 10, 10)).clone()), 400.0, 80.0);
  EXPECT_LT(medianOf(modelVariance(Observations().commuted(), kNoise, kNoise)), 0.5);
}

}  // namespace
}  // namespace mba_vo::commuted_images_test
