#pragma once

// How the parts of a map are written and read: one function for both, found by cereal.

#include <optional>
#include <vector>

#include <cereal/cereal.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/vector.hpp>

#include "mba_vo/relocalization/saved_map.h"

namespace Eigen {

template <class Archive, typename Scalar, int Rows>
void serialize(Archive& archive, Matrix<Scalar, Rows, 1>& vector) {
  for (int i = 0; i < Rows; ++i) archive(vector(i));
}

}  // namespace Eigen

namespace mba_vo {

template <class Archive>
void save(Archive& archive, const SE3& T) {
  const Eigen::Quaterniond& q = T.rotation();
  archive(q.w(), q.x(), q.y(), q.z(), T.translation().x(), T.translation().y(), T.translation().z());
}

template <class Archive>
void load(Archive& archive, SE3& T) {
  Eigen::Quaterniond q;
  Eigen::Vector3d t;
  archive(q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
  T = SE3(q, t);
}

template <class Archive>
void serialize(Archive& archive, PinholeCamera& c) {
  archive(c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.row_time);
}

template <class Archive>
void serialize(Archive& archive, ReferencePoint& point) {
  archive(point.pixel, point.inverse_depth, point.variance);
}

template <class Archive>
void serialize(Archive& archive, Reference& r) {
  archive(r.id.keyframe_id, r.mid_exposure_ns, r.T_map_reference, r.image_xi, r.motion.velocity, r.motion.acceleration,
          r.brightness.a, r.brightness.b, r.image_correction.values, r.correction.values, r.points, r.exposure);
}

/// A keyframe with its image as it is stored: compressed.
struct KeyframeRecord {
  Reference reference;
  std::uint64_t frame_sequence = 0;
  std::int64_t stamp_ns = 0;
  PinholeCamera camera;
  int levels = 0;
  std::vector<unsigned char> image;
  std::optional<double> image_exposure;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(reference, frame_sequence, stamp_ns, camera, levels, image, image_exposure);
  }
};

struct MapRecord {
  bool metric = false;
  double usual_error = 0.0;
  std::vector<KeyframeRecord> keyframes;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(metric, usual_error, keyframes);
  }
};

}  // namespace mba_vo
