#include "mba_vo/simulation/shading.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "mba_vo/image/multiversion.h"

namespace mba_vo {
namespace {

constexpr int kPixels = RayBlock::kPixels;
constexpr float kFarthest = 1e-3F;       // [1/m], keeps pixels centred beyond a surface's edge finite
constexpr float kMostAnisotropy = 4.0F;  // texture look-ups along the foreshortened direction
constexpr float kLodBias = -0.3F;        // bilinear look-ups soften by themselves

/// log2 to 0.01, quick and vectorisable.
inline float roughLog2(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof(bits));
  const float exponent = static_cast<float>(static_cast<std::int32_t>(bits >> 23)) - 127.0F;
  bits = (bits & 0x007FFFFFU) | 0x3F800000U;
  float mantissa;
  std::memcpy(&mantissa, &bits, sizeof(mantissa));
  return exponent + (-0.33582878F * mantissa + 2.0F) * mantissa - 1.65871022F;
}

/// Where the pixels of a block fall on a surface.
struct TextureCoordinates {
  float u[kPixels], v[kPixels];  // [m]
  float lod[kPixels];
  float du[kPixels], dv[kPixels];  // from end to end of the foreshortened pixel [m]
  int probes = 1;

  TextureCoordinates(const RayBlock& block, const ProjectedSurface& p) {
    const float length_u = static_cast<float>(p.surface->length_u);
    const float length_v = static_cast<float>(p.surface->length_v);
    const float texels = static_cast<float>(std::sqrt(p.surface->scale_u * p.surface->scale_v));
    const float pixel = block.pixel_size;
    const float inverse_distance = 1.0F / p.plane_distance;
    float most = 1.0F;
    for (int i = 0; i < kPixels; ++i) {
      const float x = block.x[i];
      const float y = block.y[i];
      const float z = 1.0F / std::max(p.inverse_depth.at(x, y), kFarthest);
      u[i] = std::min(std::max(p.edge[0].at(x, y) * z, 0.0F), length_u);
      v[i] = std::min(std::max(p.edge[2].at(x, y) * z, 0.0F), length_v);
      // A pixel covers z * pixel across and, by the tilt of the plane against the ray, `stretch` times that along.
      const float stretch = std::min(std::max(z * inverse_distance, 1.0F), 4.0F * kMostAnisotropy);
      const float across = z * pixel;
      lod[i] = kLodBias + roughLog2(texels * across * std::max(1.0F, stretch * (1.0F / kMostAnisotropy)));
      const float a = p.ray_u.at(x, y);
      const float b = p.ray_v.at(x, y);
      const float along = across * stretch / std::sqrt(a * a + b * b + 1e-12F);
      du[i] = a * along;
      dv[i] = b * along;
      most = std::max(most, stretch);
    }
    probes = static_cast<int>(std::ceil(std::min(most, kMostAnisotropy) - 0.25F));
  }
};

/// Where ray `sample` of `samples` pierces a pixel [px from its centre]: evenly spaced across, golden ratio down, so
/// edges of every direction are met by evenly spread rays. Each sub-frame shifts the pattern to fill the gaps.
struct Offset {
  float x, y;
  Offset(int sample, int samples, int sub_frame) {
    const double shift_x = 0.7548776662466927 * sub_frame + 0.5;
    const double shift_y = 0.5698402909980532 * sub_frame + 0.5;
    const double down = 0.6180339887498949 * sample + shift_y;
    x = static_cast<float>((sample + shift_x - std::floor(shift_x)) / samples - 0.5);
    y = static_cast<float>(down - std::floor(down) - 0.5);
  }
};

}  // namespace

MBA_VO_MULTIVERSION void shade(const RayBlock& block, const ProjectedSurface& projected, const float* weights,
                               float* light) {
  const TextureCoordinates at(block, projected);
  const Surface& surface = *projected.surface;
  const Texture& texture = projected.texture->get();
  const auto scale_u = static_cast<float>(surface.scale_u), scale_v = static_cast<float>(surface.scale_v);
  const auto offset_u = static_cast<float>(surface.offset_u), offset_v = static_cast<float>(surface.offset_v);
  const auto& c = surface.light;
  const float share = 1.0F / static_cast<float>(at.probes);
  for (int i = 0; i < kPixels; ++i) {
    if (weights != nullptr && weights[i] == 0.0F) continue;
    const float u = at.u[i];
    const float v = at.v[i];
    float reflectance = 0.0F;
    for (int probe = 0; probe < at.probes; ++probe) {
      const float along = (static_cast<float>(probe) + 0.5F) * share - 0.5F;
      reflectance += texture.sample((u + along * at.du[i]) * scale_u + offset_u,
                                    (v + along * at.dv[i]) * scale_v + offset_v, at.lod[i]);
    }
    const float lamp = c[0] + u * (c[1] + c[3] * u + c[4] * v) + v * (c[2] + c[5] * v);
    light[i] += (weights != nullptr ? weights[i] : 1.0F) * share * reflectance * lamp;
  }
}

MBA_VO_MULTIVERSION void VisibilityBuffer::cast(const RayBlock& block, const Candidates& candidates, float dx,
                                                float dy) {
  const float shift_x = dx * block.x_col + dy * block.x_row;
  const float shift_y = dx * block.y_col + dy * block.y_row;
  std::fill(inverse_depth_, inverse_depth_ + kPixels, 0.0F);
  std::fill(surface_, surface_ + kPixels, -1);
  for (int index = 0; index < static_cast<int>(candidates.surfaces.size()); ++index) {
    const ProjectedSurface& s = *candidates.surfaces[static_cast<std::size_t>(index)];
    const LinearForm edge0 = s.edge[0].shifted(shift_x, shift_y), edge1 = s.edge[1].shifted(shift_x, shift_y);
    const LinearForm edge2 = s.edge[2].shifted(shift_x, shift_y), edge3 = s.edge[3].shifted(shift_x, shift_y);
    const LinearForm nearness = s.inverse_depth.shifted(shift_x, shift_y);
    for (int i = 0; i < kPixels; ++i) {
      const float x = block.x[i];
      const float y = block.y[i];
      const float inside = std::min(std::min(edge0.at(x, y), edge1.at(x, y)), std::min(edge2.at(x, y), edge3.at(x, y)));
      const float inverse_depth = nearness.at(x, y);
      const bool hit = (inside >= 0.0F) & (inverse_depth > inverse_depth_[i]);
      inverse_depth_[i] = hit ? inverse_depth : inverse_depth_[i];
      surface_[i] = hit ? index : surface_[i];
    }
  }
}

void VisibilityBuffer::integrate(const RayBlock& block, const Candidates& candidates, int sub_frame, int samples,
                                 float* light) {
  const std::size_t count = candidates.surfaces.size();
  coverage_.assign(count * kPixels, 0.0F);
  const float share = 1.0F / static_cast<float>(samples);
  for (int sample = 0; sample < samples; ++sample) {
    const Offset offset(sample, samples, sub_frame);
    cast(block, candidates, offset.x, offset.y);
    for (int i = 0; i < kPixels; ++i) {
      if (surface_[i] >= 0) coverage_[static_cast<std::size_t>(surface_[i] * kPixels + i)] += share;
    }
  }
  for (std::size_t index = 0; index < count; ++index) {
    const float* coverage = coverage_.data() + index * kPixels;
    const bool seen = std::any_of(coverage, coverage + kPixels, [](float weight) { return weight > 0.0F; });
    if (seen) shade(block, *candidates.surfaces[index], coverage, light);
  }
}

}  // namespace mba_vo
