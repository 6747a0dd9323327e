#include <algorithm>
#include <map>

#include "mba_vo/image/photometric_correction.h"
#include "mba_vo/inspection/judgements.h"
#include "wording.h"

namespace mba_vo {
namespace {

// Shares of white.
constexpr double kBlack = 0.015;       // mean; 4 of 255
constexpr double kFlat = 0.012;        // standard deviation; 3 of 255
constexpr double kDark = 0.06;         // mean
constexpr double kOverExposed = 0.25;  // share of the pixels that are white
// Of the images:
constexpr double kSome = 0.02;  // cost poses
constexpr double kMany = 0.10;  // a window, now and then, is no fault
// See PixelFacts::detail. The sharpest twentieth of the images has 1.7 to 2.2 on desk, shake, spin and kitchen,
// whatever the motion blur, and 0.45 on one synthetic bag that is blurred by the lens.
constexpr double kSharp = 0.8;
constexpr double kMostDetail = 0.95;  // quantile: the camera stands still at times
constexpr double kLongBlur = 10.0;    // [px]
constexpr double kMost = 0.5;         // of the images

class Judge {
 public:
  explicit Judge(const CameraFacts& facts) : facts_(facts) {
    for (const ImageFacts& image : facts.images) {
      if (image.problem.empty()) readable_.push_back(&image);
    }
  }

  std::vector<Finding> findings() {
    judgeReading();
    judgeSizes();
    judgeRepeats();
    if (facts_.white_level > 0.0 && facts_.white_level < kSixteenBitWhite) {
      say(Check::kWhiteLevel, "no pixel of the 16-bit images exceeds " + number(facts_.white_level, 5));
    }
    judgeLight();
    judgeDetail();
    judgeBlur();
    return findings_;
  }

 private:
  void say(Check check, const std::string& what) { findings_.push_back({check, what}); }

  template <typename Predicate>
  std::size_t count(const Predicate& predicate) const {
    return static_cast<std::size_t>(
        std::count_if(readable_.begin(), readable_.end(), [&](const ImageFacts* image) { return predicate(*image); }));
  }

  /// If more than this share of the images are so.
  template <typename Predicate>
  void sayIfMore(double share, Check check, const char* what, const Predicate& predicate) {
    const std::size_t n = count(predicate);
    if (static_cast<double>(n) > share * static_cast<double>(readable_.size())) {
      say(check, countOf(n, readable_.size()) + " " + what);
    }
  }

  void judgeReading() {
    for (const bool encoding : {true, false}) {
      std::size_t n = 0;
      std::string first;
      for (const ImageFacts& image : facts_.images) {
        if (image.problem.empty() || image.bad_encoding != encoding) continue;
        if (n++ == 0) first = image.problem;
      }
      if (n == 0) continue;
      say(encoding ? Check::kImageEncoding : Check::kImageDamaged,
          countOf(n, facts_.images.size()) + " cannot be read, the first because: " + first);
    }
  }

  void judgeSizes() {
    std::map<std::pair<int, int>, std::size_t> sizes;
    for (const ImageFacts* image : readable_) ++sizes[{image->size.width, image->size.height}];
    if (sizes.size() < 2) return;
    std::string text;
    for (const auto& [size, n] : sizes) {
      text += (text.empty() ? "" : ", ") + std::to_string(n) + " images of " + std::to_string(size.first) + "x" +
              std::to_string(size.second);
    }
    say(Check::kImageSizeChanges, text);
  }

  void judgeRepeats() {
    sayIfMore(0.0, Check::kImagesRepeat, "show an earlier image again",
              [](const ImageFacts& image) { return image.repeats; });
  }

  void judgeLight() {
    const auto is_flat = [](const ImageFacts& image) { return image.pixels.contrast < kFlat; };
    const auto is_black = [](const ImageFacts& image) { return image.pixels.mean < kBlack; };
    const auto is_white = [](const ImageFacts& image) { return image.pixels.saturated > kOverExposed; };
    sayIfMore(kSome, Check::kBlackImages, "are black",
              [&](const ImageFacts& image) { return is_black(image) && is_flat(image); });
    sayIfMore(kMany, Check::kOverExposed, "are white over more than a quarter", is_white);
    sayIfMore(kSome, Check::kFlatImages, "show nothing: all of one brightness",
              [&](const ImageFacts& image) { return is_flat(image) && !is_black(image) && !is_white(image); });
    sayIfMore(kMost, Check::kDarkImages, "are dark, with a mean below 6 % of white", [&](const ImageFacts& image) {
      return image.pixels.mean < kDark && !(is_black(image) && is_flat(image));
    });
  }

  void judgeDetail() {
    std::vector<double> detail;
    for (const ImageFacts* image : readable_) {
      const bool shows_something = image->pixels.contrast > kFlat && image->pixels.saturated < kOverExposed;
      if (shows_something && !image->repeats) detail.push_back(image->pixels.detail);
    }
    if (detail.empty()) return;
    const double best = quantile(detail, kMostDetail);
    if (best < kSharp) {
      say(Check::kNeverSharp,
          "fine detail is " + number(best, 2) + " in the sharpest images, where 1.6 or more is usual");
    }
  }

  void judgeBlur() {
    const double blur = usualBlur(facts_);
    if (blur > kLongBlur) say(Check::kMuchBlur, "images are blurred over " + number(blur, 2) + " px in the median");
  }

  const CameraFacts& facts_;
  std::vector<const ImageFacts*> readable_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> judgeImages(const CameraFacts& facts) { return Judge(facts).findings(); }

}  // namespace mba_vo
