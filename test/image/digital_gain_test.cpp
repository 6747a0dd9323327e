#include "mba_vo/image/digital_gain.h"

#include <gtest/gtest.h>

namespace mba_vo::digital_gain_test {
namespace {

double chosenFor(double mean, double noise) {
  DigitalGain gain;
  EXPECT_FALSE(gain.suits(mean));
  gain.choose(mean, noise);
  EXPECT_TRUE(gain.suits(mean));
  return gain.value();
}

TEST(DigitalGain, OrdinaryImagesStayAsTheyAre) {
  EXPECT_EQ(chosenFor(60.0, 0.3), 1.0);
  EXPECT_EQ(chosenFor(254.0, 0.3), 1.0);
}

TEST(DigitalGain, DarkImagesAreBrightened) {
  EXPECT_EQ(chosenFor(20.0, 0.3), 4.0);
  EXPECT_EQ(chosenFor(0.1, 0.01), 16.0);
}

TEST(DigitalGain, NoiseIsNotRaisedAboveWhatIsTakenForOutliers) {
  EXPECT_EQ(chosenFor(20.0, 2.0), 4.0);
  EXPECT_EQ(chosenFor(20.0, 3.0), 2.0);
  EXPECT_EQ(chosenFor(20.0, 6.0), 1.0);
}

TEST(DigitalGain, ChangesOnlyWithTheLight) {
  DigitalGain gain;
  gain.choose(20.0, 0.3);
  for (const double mean : {10.0, 40.0, 7.0, 20.0}) EXPECT_TRUE(gain.suits(mean)) << mean;
  EXPECT_FALSE(gain.suits(100.0));
  EXPECT_FALSE(gain.suits(5.0));
  gain.choose(100.0, 0.3);
  EXPECT_TRUE(gain.suits(254.0)) << "there is no lower gain";
  EXPECT_TRUE(gain.suits(30.0));
  EXPECT_FALSE(gain.suits(10.0));
}

TEST(DigitalGain, MakesUpForWhatIsNotLight) {
  DigitalGain gain;
  gain.choose(80.0, 0.3);
  gain.makeUpFor(4095.0 / 1023.0);
  EXPECT_EQ(gain.value(), 4.0);
  EXPECT_TRUE(gain.suits(20.0));
  EXPECT_FALSE(gain.suits(60.0));
}

TEST(DigitalGain, IsNotChosenAgainForEachNoisyImage) {
  DigitalGain gain;
  gain.choose(10.0, 6.0);
  EXPECT_TRUE(gain.suits(9.0));
  EXPECT_FALSE(gain.suits(4.0));
}

}  // namespace
}  // namespace mba_vo::digital_gain_test
