#pragma once

#include <memory>

#include "mba_vo/deblur/deblurrer.h"

namespace mba_vo {

/// Deblurs with a network in a file, run by OpenCV: an image goes in, an image of the same size comes out. Networks
/// that take one size only are run on tiles.
class OnnxDeblurrer final : public Deblurrer {
 public:
  /// Reads the network and tries it on a small image. Throws std::invalid_argument naming the file and what is wrong
  /// with it: not readable, an operator that OpenCV does not know, or another shape coming out.
  explicit OnnxDeblurrer(const OnnxDeblurConfig& config);
  ~OnnxDeblurrer() override;

  DeblurResult deblur(const DeblurInput& input) const override;

 private:
  class Network;
  std::unique_ptr<Network> network_;
};

}  // namespace mba_vo
