#pragma once

#include "mba_vo/deblur/deblurrer.h"

namespace mba_vo {

/// Sharp images that something else made, one file per frame: another program's results, or the truth of a rendered
/// sequence, which shows what sharp keyframes would be worth if deblurring them were perfect.
class FolderDeblurrer final : public Deblurrer {
 public:
  /// Throws std::invalid_argument if there is no such folder.
  explicit FolderDeblurrer(const FolderDeblurConfig& config);

  /// A frame without a file is left as it is. Throws std::runtime_error for a file that is no image of its size.
  DeblurResult deblur(const DeblurInput& input) const override;

 private:
  FolderDeblurConfig config_;
};

}  // namespace mba_vo
