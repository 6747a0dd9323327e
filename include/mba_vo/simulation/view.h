#pragma once

#include <cmath>
#include <vector>

#include "mba_vo/geometry/se3.h"
#include "mba_vo/simulation/ray_table.h"
#include "mba_vo/simulation/scene.h"

namespace mba_vo {

/// f(x, y) = a x + b y + c of a ray (x, y, 1).
struct LinearForm {
  float a, b, c;

  float at(float x, float y) const { return a * x + b * y + c; }
  LinearForm shifted(float x, float y) const { return {a, b, at(x, y)}; }
  LinearForm operator-(const LinearForm& o) const { return {a - o.a, b - o.b, c - o.c}; }

  struct Range {
    float lowest, highest;
  };
  /// Values over a rectangle of rays; a linear form takes its extremes in the corners.
  Range over(const RayRectangle& r) const {
    const float center = at(0.5F * (r.x_min + r.x_max), 0.5F * (r.y_min + r.y_max));
    const float radius = 0.5F * (std::abs(a) * (r.x_max - r.x_min) + std::abs(b) * (r.y_max - r.y_min));
    return {center - radius, center + radius};
  }
};

/// A surface as one camera pose sees it. For a ray d = (x, y, 1) that hits its plane at depth z, `inverse_depth` is
/// 1/z and the hit lies `edge[0]` z along axis_u and `edge[2]` z along axis_v, so everything is linear in the ray.
struct ProjectedSurface {
  LinearForm inverse_depth;
  LinearForm edge[4];  // all >= 0 inside: u, length_u - u, v, length_v - v, each times 1/z
  LinearForm ray_u;    // ray along axis_u and axis_v: the direction in which the view foreshortens
  LinearForm ray_v;
  float plane_distance;  // of the camera from the plane [m]
  const Surface* surface;
  const Lazy<Texture>* texture;
};

using View = std::vector<ProjectedSurface>;

/// Surfaces of a scene, in its order.
using SurfaceList = std::vector<const Surface*>;

/// The surfaces of a list whose front may be seen through `bounds`.
View projectSurfaces(const Scene& scene, const SurfaceList& surfaces, const SE3& T_world_camera,
                     const RayRectangle& bounds);

/// What may be seen through `bounds` from the given poses of a path, and from those between that are within 5 cm and
/// 0.05 rad of one of them.
SurfaceList surfacesInSight(const SurfaceList& surfaces, const std::vector<SE3>& T_world_camera,
                            const RayRectangle& bounds);

/// Surfaces that can be seen through a rectangle of rays, the hidden ones left out where that is cheap to know.
struct Candidates {
  std::vector<const ProjectedSurface*> surfaces;
  bool single_cover = false;  // one surface that fills the rectangle

  void select(const View& view, const RayRectangle& bounds);
  void select(const Candidates& larger, const RayRectangle& bounds);

 private:
  void add(const ProjectedSurface& surface, const RayRectangle& bounds);
  void finish(const RayRectangle& bounds);

  const ProjectedSurface* cover_ = nullptr;
};

/// Depth along one ray [m], 0 = nothing there.
float depthAlongRay(const View& view, float x, float y);

}  // namespace mba_vo
