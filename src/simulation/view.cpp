#include "mba_vo/simulation/view.h"

#include <algorithm>

namespace mba_vo {
namespace {

constexpr double kNearestPlane = 1e-4;  // [m], a surface seen edge-on has no image

LinearForm linear(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

bool outside(const ProjectedSurface& surface, const RayRectangle& bounds) {
  return std::any_of(std::begin(surface.edge), std::end(surface.edge),
                     [&](const LinearForm& edge) { return edge.over(bounds).highest < 0.0F; });
}

ProjectedSurface project(const Surface& s, const Eigen::Matrix3d& R_camera_world, const Eigen::Vector3d& position,
                         double plane_distance) {
  const Eigen::Vector3d axis_u = R_camera_world * s.axis_u;
  const Eigen::Vector3d axis_v = R_camera_world * s.axis_v;
  const Eigen::Vector3d origin = R_camera_world * (s.origin - position);
  // n.(z d - origin) = 0 and n.origin = -plane_distance, so 1/z = -n.d / plane_distance.
  const Eigen::Vector3d m = -axis_u.cross(axis_v) / plane_distance;
  const Eigen::Vector3d u = axis_u - axis_u.dot(origin) * m;  // u / z = axis_u.(d - origin / z)
  const Eigen::Vector3d v = axis_v - axis_v.dot(origin) * m;
  ProjectedSurface out{};
  out.inverse_depth = linear(m);
  out.edge[0] = linear(u);
  out.edge[1] = linear(s.length_u * m - u);
  out.edge[2] = linear(v);
  out.edge[3] = linear(s.length_v * m - v);
  out.ray_u = linear(axis_u);
  out.ray_v = linear(axis_v);
  out.plane_distance = static_cast<float>(plane_distance);
  out.surface = &s;
  return out;
}

}  // namespace

View projectSurfaces(const Scene& scene, const SurfaceList& surfaces, const SE3& T_world_camera,
                     const RayRectangle& bounds) {
  const Eigen::Matrix3d R_camera_world = T_world_camera.rotationMatrix().transpose();
  const Eigen::Vector3d& position = T_world_camera.translation();
  View view;
  view.reserve(surfaces.size() / 2);
  for (const Surface* surface : surfaces) {
    const double plane_distance = surface->normal().dot(position - surface->origin);
    if (plane_distance < kNearestPlane) continue;
    const ProjectedSurface projected = project(*surface, R_camera_world, position, plane_distance);
    if (outside(projected, bounds)) continue;
    view.push_back(projected);
    view.back().texture = &scene.textures[static_cast<std::size_t>(surface->texture)];
  }
  return view;
}

SurfaceList surfacesInSight(const SurfaceList& surfaces, const std::vector<SE3>& T_world_camera,
                            const RayRectangle& bounds) {
  constexpr double kBetween = 0.05;  // [m]
  constexpr float kWider = 0.2F;     // what 5 cm at 0.4 m and 0.05 rad change in a ray (x, y, 1) within 50 degrees
  const RayRectangle wide{bounds.x_min - kWider, bounds.x_max + kWider, bounds.y_min - kWider, bounds.y_max + kWider};
  std::vector<Eigen::Matrix3d> R_camera_world;
  for (const SE3& pose : T_world_camera) R_camera_world.push_back(pose.rotationMatrix().transpose());
  const auto hidden = [&](const Surface& surface, std::size_t i) {
    const Eigen::Vector3d& position = T_world_camera[i].translation();
    const double plane_distance = surface.normal().dot(position - surface.origin);
    if (std::abs(plane_distance) < kBetween) return false;
    return plane_distance < 0.0 || outside(project(surface, R_camera_world[i], position, plane_distance), wide);
  };
  SurfaceList in_sight;
  for (const Surface* surface : surfaces) {
    bool seen = false;
    for (std::size_t i = 0; i < T_world_camera.size() && !seen; ++i) seen = !hidden(*surface, i);
    if (seen) in_sight.push_back(surface);
  }
  return in_sight;
}

void Candidates::add(const ProjectedSurface& surface, const RayRectangle& bounds) {
  bool covers = true;
  for (const LinearForm& edge : surface.edge) {
    const LinearForm::Range range = edge.over(bounds);
    if (range.highest < 0.0F) return;
    covers = covers && range.lowest >= 0.0F;
  }
  surfaces.push_back(&surface);
  if (!covers) return;
  const float x = bounds.x_min;
  const float y = bounds.y_min;
  if (cover_ == nullptr || surface.inverse_depth.at(x, y) > cover_->inverse_depth.at(x, y)) cover_ = &surface;
}

void Candidates::finish(const RayRectangle& bounds) {
  if (cover_ != nullptr) {
    const auto hidden = [&](const ProjectedSurface* s) {
      return s != cover_ && (cover_->inverse_depth - s->inverse_depth).over(bounds).lowest > 0.0F;
    };
    surfaces.erase(std::remove_if(surfaces.begin(), surfaces.end(), hidden), surfaces.end());
  }
  single_cover = cover_ != nullptr && surfaces.size() == 1;
}

void Candidates::select(const View& view, const RayRectangle& bounds) {
  surfaces.clear();
  cover_ = nullptr;
  for (const ProjectedSurface& surface : view) add(surface, bounds);
  finish(bounds);
}

void Candidates::select(const Candidates& larger, const RayRectangle& bounds) {
  surfaces.clear();
  cover_ = nullptr;
  for (const ProjectedSurface* surface : larger.surfaces) add(*surface, bounds);
  finish(bounds);
}

float depthAlongRay(const View& view, float x, float y) {
  float nearest = 0.0F;
  for (const ProjectedSurface& s : view) {
    const float inverse_depth = s.inverse_depth.at(x, y);
    if (inverse_depth <= nearest) continue;
    const bool inside = s.edge[0].at(x, y) >= 0.0F && s.edge[1].at(x, y) >= 0.0F && s.edge[2].at(x, y) >= 0.0F &&
                        s.edge[3].at(x, y) >= 0.0F;
    if (inside) nearest = inverse_depth;
  }
  return nearest > 0.0F ? 1.0F / nearest : 0.0F;
}

}  // namespace mba_vo
