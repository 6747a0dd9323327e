#include "mba_vo/deblur/deblurrer.h"

#include <stdexcept>

namespace mba_vo {

std::unique_ptr<Deblurrer> makeDeblurrer(const DeblurConfig& config) {
  if (config.method == "none") return std::make_unique<PassThroughDeblurrer>();
  throw std::invalid_argument("mapper.deblur.method is '" + config.method + "', must be one of: none");
}

}  // namespace mba_vo
