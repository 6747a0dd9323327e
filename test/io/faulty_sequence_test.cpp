#include "mba_vo/io/faulty_sequence.h"

#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mba_vo::faulty_sequence_test {
namespace {

constexpr std::size_t kImages = 300;
constexpr std::int64_t kIntervalNs = 40000000;

/// Image i is grey i/2 everywhere.
class Recording : public SequenceReader {
 public:
  CameraCalibration calibration() const override { return {}; }
  std::size_t size() const override { return kImages; }
  std::optional<CameraImage> next() override {
    if (next_ == kImages) return std::nullopt;
    const std::int64_t stamp = 5000000000 + static_cast<std::int64_t>(next_) * kIntervalNs;
    const cv::Mat image(24, 32, CV_8UC1, cv::Scalar(static_cast<double>(next_ / 2)));
    return CameraImage{next_++, stamp, stamp, 0.02, image, "", {}};
  }

 private:
  std::size_t next_ = 0;
};

struct Spoilt {
  std::vector<CameraImage> images;
  std::vector<FaultRecord> records;
};
Spoilt spoil(unsigned seed, const std::vector<std::string>& kinds) {
  Recording recording;
  FaultySequence faulty(recording, {seed, kinds});
  Spoilt spoilt{{}, faulty.records()};
  while (auto image = faulty.next()) spoilt.images.push_back(*image);
  EXPECT_EQ(spoilt.images.size(), spoilt.records.size());
  return spoilt;
}

TEST(FaultySequence, TheSeedDecides) {
  const Spoilt a = spoil(3, {});
  const Spoilt b = spoil(3, {});
  const Spoilt c = spoil(4, {});
  std::ostringstream text_a, text_b, text_c;
  writeFaults(a.records, text_a);
  writeFaults(b.records, text_b);
  writeFaults(c.records, text_c);
  EXPECT_EQ(text_a.str(), text_b.str());
  EXPECT_NE(text_a.str(), text_c.str());
  std::set<std::string> seen;
  for (unsigned seed = 1; seed < 20; ++seed) {
    for (const FaultRecord& record : spoil(seed, {}).records) seen.insert(record.fault);
  }
  EXPECT_EQ(seen.size(), faultKinds().size()) << "all but gaps leave a record, and so do images without a fault";
}

TEST(FaultySequence, BeginsUnspoiltAndNumbersItsImages) {
  const Spoilt spoilt = spoil(1, {});
  for (std::size_t i = 0; i < spoilt.images.size(); ++i) {
    EXPECT_EQ(spoilt.images[i].sequence, i);
    if (spoilt.records[i].stamp_ns < 7000000000 && i < 50) {
      EXPECT_EQ(spoilt.records[i].fault, "");
    }
  }
}

TEST(FaultySequence, AKidnappedCameraGoesBackTheWayItCame) {
  const Spoilt spoilt = spoil(2, {"kidnap"});
  int kidnapped = 0;
  for (std::size_t i = 1; i + 1 < spoilt.records.size(); ++i) {
    // One image of the recording to the next, forwards or backwards, covered or not.
    const std::int64_t step = spoilt.records[i].source_stamp_ns - spoilt.records[i - 1].source_stamp_ns;
    EXPECT_EQ(std::abs(step), kIntervalNs);
    EXPECT_EQ(spoilt.records[i].stamp_ns - spoilt.records[i - 1].stamp_ns, kIntervalNs);
    const bool begins = spoilt.records[i].fault == "kidnap" && spoilt.records[i - 1].fault.empty();
    kidnapped += begins ? 1 : 0;
    const double mean = cv::mean(spoilt.images[i].image)[0];
    const double source =
        std::floor(static_cast<double>((spoilt.records[i].source_stamp_ns - 5000000000) / kIntervalNs) / 2.0);
    EXPECT_NEAR(mean, spoilt.records[i].fault == "kidnap" ? 12.0 : source, 0.5);
  }
  EXPECT_GT(kidnapped, 1);
}

TEST(FaultySequence, ACameraThatLookedElsewhereGoesOnFromWhereItWas) {
  const Spoilt spoilt = spoil(2, {"elsewhere"});
  int jumps = 0;
  for (std::size_t i = 1; i < spoilt.records.size(); ++i) {
    const std::int64_t step = spoilt.records[i].source_stamp_ns - spoilt.records[i - 1].source_stamp_ns;
    EXPECT_EQ(spoilt.records[i].stamp_ns - spoilt.records[i - 1].stamp_ns, kIntervalNs);
    if (spoilt.records[i].fault == spoilt.records[i - 1].fault) {
      EXPECT_LE(std::abs(step), kIntervalNs * static_cast<std::int64_t>(kImages - 1));
      continue;
    }
    EXPECT_NEAR(static_cast<double>(std::abs(step) / kIntervalNs), 0.5 * kImages, 1.0);
    ++jumps;
  }
  EXPECT_GT(jumps, 1);
}

TEST(FaultySequence, ClocksJumpAndImagesFreeze) {
  int jumps = 0;
  const Spoilt forwards = spoil(5, {"forwards"});
  for (std::size_t i = 1; i < forwards.records.size(); ++i) {
    jumps += forwards.records[i].stamp_ns - forwards.records[i - 1].stamp_ns > 400000000 ? 1 : 0;
  }
  EXPECT_GT(jumps, 1);
  int back = 0;
  const Spoilt restarted = spoil(5, {"restart"});
  for (std::size_t i = 1; i < restarted.records.size(); ++i) {
    if (restarted.records[i].stamp_ns > restarted.records[i - 1].stamp_ns) continue;
    ++back;
    EXPECT_LT(restarted.records[i].stamp_ns, 5200000000);
  }
  EXPECT_GT(back, 1);
  std::set<std::int64_t> stamps;
  for (const FaultRecord& record : restarted.records)
    EXPECT_TRUE(stamps.insert(record.stamp_ns).second) << "no stamp twice";
  const Spoilt frozen = spoil(5, {"frozen"});
  int repeated = 0;
  for (std::size_t i = 1; i < frozen.images.size(); ++i) {
    if (frozen.records[i].fault != "frozen") continue;
    ++repeated;
    EXPECT_EQ(cv::norm(frozen.images[i].image, frozen.images[i - 1].image, cv::NORM_INF), 0.0);
  }
  EXPECT_GT(repeated, 5);
}

TEST(FaultySequence, AnUnknownKindIsNamed) {
  Recording recording;
  EXPECT_THAT(
      [&] {
        FaultySequence(recording, {1, {"earthquake"}});
      },
      testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("earthquake")));
}

}  // namespace
}  // namespace mba_vo::faulty_sequence_test
