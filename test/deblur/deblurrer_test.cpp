#include "mba_vo/deblur/deblurrer.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace mba_vo::deblurrer_test {
namespace {

TEST(Deblurrer, NoneHandsTheVeryImageThrough) {
  const PinholeCamera camera{32, 24, 30.0, 30.0, 15.5, 11.5};
  DeblurInput input;
  input.image = std::make_shared<const ImagePyramid>(cv::Mat1f(24, 32, 7.0F), camera, 1);
  input.motion.exposure = 0.02;
  input.motion.velocity << 0.0, 0.0, 0.0, 0.0, 5.0, 0.0;
  input.depths.push_back({{3.0F, 4.0F}, 0.5F});
  const DeblurResult result = makeDeblurrer({})->deblur(input);
  EXPECT_EQ(result.image, input.image);
  EXPECT_FALSE(result.sharpened);
}

TEST(Deblurrer, AnUnknownMethodIsNamedTogetherWithWhatIsAllowed) {
  DeblurConfig config;
  config.method = "magic";
  try {
    makeDeblurrer(config);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("mapper.deblur.method"), std::string::npos) << message;
    EXPECT_NE(message.find("magic"), std::string::npos) << message;
    EXPECT_NE(message.find("trajectory"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace mba_vo::deblurrer_test
