#include "mba_vo/deblur/deblurrer.h"

#include <stdexcept>

#include "mba_vo/deblur/folder_deblurrer.h"
#include "mba_vo/deblur/onnx_deblurrer.h"
#include "mba_vo/deblur/trajectory_deblurrer.h"

namespace mba_vo {

DeblurResult PassThroughDeblurrer::deblur(const DeblurInput& input) const {
  DeblurResult result;
  result.image = input.image;
  result.reason = "not asked for";
  return result;
}

std::unique_ptr<Deblurrer> makeDeblurrer(const DeblurConfig& config) {
  if (config.method == "none") return std::make_unique<PassThroughDeblurrer>();
  if (config.method == "trajectory") return std::make_unique<TrajectoryDeblurrer>(config.trajectory);
  if (config.method == "onnx") return std::make_unique<OnnxDeblurrer>(config.onnx);
  if (config.method == "folder") return std::make_unique<FolderDeblurrer>(config.folder);
  throw std::invalid_argument("mapper.deblur.method is '" + config.method +
                              "', must be one of: none, trajectory, onnx, folder");
}

}  // namespace mba_vo
