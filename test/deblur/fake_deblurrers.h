#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "mba_vo/deblur/deblurrer.h"

namespace mba_vo::test {

/// Sharp images by another way, in no time. Remembers what it was given.
class FakeDeblurrer : public Deblurrer {
 public:
  using Make = std::function<DeblurResult(const DeblurInput&)>;
  explicit FakeDeblurrer(Make make) : make_(std::move(make)) {}

  DeblurResult deblur(const DeblurInput& input) const override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      inputs_.push_back(input);
    }
    DeblurResult result = make_(input);
    const std::lock_guard<std::mutex> lock(mutex_);
    made_of_[result.image.get()] = input.sequence;
    return result;
  }

  std::vector<DeblurInput> inputs() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return inputs_;
  }
  /// The frame that the deblurrer was given when it made this image.
  std::uint64_t sequenceOf(const std::shared_ptr<const ImagePyramid>& image) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return made_of_.at(image.get());
  }

 private:
  Make make_;
  mutable std::mutex mutex_;
  mutable std::vector<DeblurInput> inputs_;
  mutable std::map<const ImagePyramid*, std::uint64_t> made_of_;
};

/// Another object with the same content.
inline DeblurResult copyOf(const DeblurInput& input) {
  DeblurResult result;
  if (input.image) result.image = std::make_shared<const ImagePyramid>(*input.image);
  result.sharpened = true;
  result.residual = 1.0F;
  return result;
}

/// Works until it is let go: the CPU is too slow for it.
class SlowDeblurrer final : public FakeDeblurrer {
 public:
  explicit SlowDeblurrer(Make make = copyOf)
      : FakeDeblurrer([this, make = std::move(make)](const DeblurInput& input) {
          std::unique_lock<std::mutex> lock(gate_);
          changed_.wait(lock, [this] { return free_ > 0; });
          --free_;
          return make(input);
        }) {}

  /// It can end with so many more images.
  void letGo(int images = 1) {
    const std::lock_guard<std::mutex> lock(gate_);
    free_ += images;
    changed_.notify_all();
  }

 private:
  std::mutex gate_;
  std::condition_variable changed_;
  int free_ = 0;
};

}  // namespace mba_vo::test
