#include "mba_vo/simulation/renderer.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/image/parallel_for.h"
#include "mba_vo/simulation/shading.h"

namespace mba_vo {
namespace {

constexpr int kEdgeSamples = 128;        // rays per pixel at edges over the whole exposure ...
constexpr int kEdgeSamplesPerView = 24;  // ... and at least this many in every sub-frame
constexpr std::size_t kChunk = 8;        // blocks culled together
constexpr int kMostSubFrames = 4000;

/// Visits the blocks of a strip with the surfaces that each may see.
class StripWalker {
 public:
  /// Calls work(block, block index, candidates).
  template <typename Work>
  void walk(const RayStrip& strip, const View& view, Work work) {
    in_strip_.select(view, strip.bounds);
    for (std::size_t begin = 0; begin < strip.blocks.size(); begin += kChunk) {
      const std::size_t end = std::min(begin + kChunk, strip.blocks.size());
      RayRectangle bounds = strip.blocks[begin].bounds;
      for (std::size_t i = begin; i < end; ++i) bounds.include(strip.blocks[i].bounds);
      in_chunk_.select(in_strip_, bounds);
      for (std::size_t i = begin; i < end; ++i) {
        in_block_.select(in_chunk_, strip.blocks[i].bounds);
        work(strip.blocks[i], i, in_block_);
      }
    }
  }

 private:
  Candidates in_strip_, in_chunk_, in_block_;  // kept for their memory
};

void copyBlock(const RayBlock& block, int columns, const float* values, float factor, cv::Mat1f& image) {
  for (int i = 0; i < RayBlock::kPixels; ++i) {
    const int col = block.column + i % columns;
    const int row = block.row + i / columns;
    if (col < image.cols && row < image.rows) image(row, col) = factor * values[i];
  }
}

double subFrameTime(double t_mid, double exposure, int index, int count) {
  return t_mid + exposure * ((index + 0.5) / count - 0.5);
}

/// Longest of `kSegments` pieces of the image path of a point seen at t_mid, times their number [px].
class ImagePath {
 public:
  ImagePath(const PoseFunction& pose, double t_mid, double exposure) {
    const SE3 T_world_mid = pose(t_mid);
    for (int i = 0; i <= kSegments; ++i) {
      T_camera_mid_.push_back(pose(t_mid + exposure * (static_cast<double>(i) / kSegments - 0.5)).inverse() *
                              T_world_mid);
    }
  }

  double length(float x, float y, float z, float pixel_size) const {
    const Eigen::Vector3d point = static_cast<double>(z) * Eigen::Vector3d(x, y, 1.0);
    double longest = 0.0;
    Eigen::Vector2d previous = Eigen::Vector2d::Zero();
    for (int i = 0; i <= kSegments; ++i) {
      const Eigen::Vector3d seen = T_camera_mid_[static_cast<std::size_t>(i)] * point;
      if (seen.z() < 0.01) break;
      const Eigen::Vector2d current = seen.head<2>() / seen.z();
      if (i > 0) longest = std::max(longest, (current - previous).norm());
      previous = current;
    }
    return kSegments * longest / static_cast<double>(pixel_size);
  }

 private:
  static constexpr int kSegments = 8;
  std::vector<SE3> T_camera_mid_;
};

}  // namespace

Renderer::Renderer(std::shared_ptr<const Scene> scene, const CameraCalibration& calibration,
                   const RendererConfig& config)
    : scene_(std::move(scene)), config_(config), rays_(calibration, config.row_time > 0.0 ? 1 : 8) {
  for (const Surface& surface : scene_->surfaces) surfaces_.push_back(&surface);
}

double Renderer::rowDelay(int row) const { return config_.row_time * (row - 0.5 * (rays_.height() - 1)); }

SurfaceList Renderer::inSight(const PoseFunction& pose, double t_mid, double exposure) const {
  if (config_.row_time <= 0.0) return surfaces_;
  constexpr int kPoses = 17;  // so the camera hardly moves from one to the next
  const double length = exposure + 2.0 * rowDelay(rays_.height() - 1);
  std::vector<SE3> poses;
  for (int i = 0; i < kPoses; ++i) poses.push_back(pose(t_mid + length * (i / (kPoses - 1.0) - 0.5)));
  return surfacesInSight(surfaces_, poses, rays_.bounds());
}

cv::Mat1f Renderer::integrate(const PoseFunction& pose, double t_mid, double exposure) const {
  const int count = subFrames(pose, t_mid, exposure);
  const bool global_shutter = config_.row_time <= 0.0;
  const SurfaceList surfaces = inSight(pose, t_mid, exposure);
  std::vector<View> views(global_shutter ? static_cast<std::size_t>(count) : 0);
  parallelFor(views.size(), [&](std::size_t i) {
    const SE3 T_world_camera = pose(subFrameTime(t_mid, exposure, static_cast<int>(i), count));
    views[i] = projectSurfaces(*scene_, surfaces, T_world_camera, rays_.bounds());
  });

  const int samples = std::max(kEdgeSamplesPerView, kEdgeSamples / count);
  cv::Mat1f light(rays_.height(), rays_.width());
  parallelFor(rays_.strips().size(), [&](std::size_t index) {
    const RayStrip& strip = rays_.strips()[index];
    const double t_row = t_mid + rowDelay(strip.row);
    std::vector<float> sum(strip.blocks.size() * RayBlock::kPixels, 0.0F);
    VisibilityBuffer visibility;
    StripWalker walker;
    View row_view;
    for (int i = 0; i < count; ++i) {
      if (!global_shutter) {
        row_view = projectSurfaces(*scene_, surfaces, pose(subFrameTime(t_row, exposure, i, count)), strip.bounds);
      }
      const View& view = global_shutter ? views[static_cast<std::size_t>(i)] : row_view;
      walker.walk(strip, view, [&](const RayBlock& block, std::size_t number, const Candidates& candidates) {
        float* block_sum = sum.data() + number * RayBlock::kPixels;
        if (candidates.single_cover) {
          shade(block, *candidates.surfaces.front(), nullptr, block_sum);
        } else {
          visibility.integrate(block, candidates, i, samples, block_sum);
        }
      });
    }
    for (std::size_t b = 0; b < strip.blocks.size(); ++b) {
      copyBlock(strip.blocks[b], rays_.columnsPerBlock(), sum.data() + b * RayBlock::kPixels,
                1.0F / static_cast<float>(count), light);
    }
  });
  return light;
}

cv::Mat1f Renderer::depth(const PoseFunction& pose, double t_mid) const {
  cv::Mat1f depth(rays_.height(), rays_.width());
  const SurfaceList surfaces = inSight(pose, t_mid, 0.0);
  parallelFor(rays_.strips().size(), [&](std::size_t index) {
    const RayStrip& strip = rays_.strips()[index];
    const View view = projectSurfaces(*scene_, surfaces, pose(t_mid + rowDelay(strip.row)), strip.bounds);
    VisibilityBuffer visibility;
    StripWalker().walk(strip, view, [&](const RayBlock& block, std::size_t, const Candidates& candidates) {
      visibility.cast(block, candidates, 0.0F, 0.0F);
      float z[RayBlock::kPixels];
      for (int i = 0; i < RayBlock::kPixels; ++i) {
        const float inverse = visibility.inverseDepth()[i];
        z[i] = inverse > 0.0F ? 1.0F / inverse : 0.0F;
      }
      copyBlock(block, rays_.columnsPerBlock(), z, 1.0F, depth);
    });
  });
  return depth;
}

int Renderer::subFrames(const PoseFunction& pose, double t_mid, double exposure) const {
  if (exposure <= 0.0) return 1;
  constexpr int kGrid = 16;         // [px]
  constexpr double kSafety = 1.05;  // something nearer may hide between the grid points
  const View view = projectSurfaces(*scene_, surfaces_, pose(t_mid), rays_.bounds());
  const ImagePath path(pose, t_mid, exposure);
  std::vector<double> longest(rays_.strips().size(), 0.0);
  parallelFor(rays_.strips().size(), [&](std::size_t index) {
    const RayStrip& strip = rays_.strips()[index];
    if (strip.row % kGrid != 0) return;
    for (const RayBlock& block : strip.blocks) {
      for (int i = 0; i < rays_.columnsPerBlock(); ++i) {
        if ((block.column + i) % kGrid != 0) continue;
        const float z = depthAlongRay(view, block.x[i], block.y[i]);
        if (z > 0.0F)
          longest[index] = std::max(longest[index], path.length(block.x[i], block.y[i], z, block.pixel_size));
      }
    }
  });
  const double pixels = kSafety * *std::max_element(longest.begin(), longest.end());
  return std::clamp(static_cast<int>(std::ceil(pixels / config_.max_step)), 1, kMostSubFrames);
}

}  // namespace mba_vo
