#include "mba_vo/io/map_file.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <cereal/archives/portable_binary.hpp>
#include <opencv2/imgcodecs.hpp>

#include "map_record.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

constexpr std::array<char, 8> kMagic = {'M', 'B', 'A', 'V', 'O', 'M', 'A', 'P'};
constexpr std::uint32_t kMapVersion = 1;
constexpr int kMostLevels = 16;               // of a pyramid
constexpr int kMostPixels = 65535;            // of a side
constexpr const char* kImageFormat = ".png";  // webp: an eighth less, in ten times the time

/// After the magic.
struct Head {
  std::uint32_t version = kMapVersion;
  std::uint64_t bytes = 0;  // of what follows
  std::uint32_t checksum = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(version, bytes, checksum);
  }
};

std::uint32_t checksumOf(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

KeyframeRecord recordOf(const ArchivedKeyframe& keyframe) {
  KeyframeRecord record;
  record.reference = keyframe.reference;
  record.frame_sequence = keyframe.frame_sequence;
  record.stamp_ns = keyframe.stamp_ns;
  record.camera = keyframe.camera;
  record.levels = keyframe.levels;
  record.image_exposure = keyframe.image_exposure;
  cv::imencode(kImageFormat, keyframe.image, record.image);
  return record;
}

void require(bool right, const char* what) {
  if (!right) throw std::runtime_error(std::string("damaged: ") + what);
}

/// That nothing after it has to doubt it: the checksum only says that it is as somebody wrote it.
void check(const KeyframeRecord& record, const cv::Mat1b& image) {
  const PinholeCamera& camera = record.camera;
  require(record.levels > 0 && record.levels <= kMostLevels, "levels of a pyramid");
  require(camera.width > 0 && camera.width <= kMostPixels && camera.height > 0 && camera.height <= kMostPixels,
          "the size of an image");
  require(image.cols == camera.width && image.rows == camera.height, "an image of another size than its camera's");
  require(camera.fx > 0.0 && camera.fy > 0.0 && std::isfinite(camera.fx + camera.fy + camera.cx + camera.cy),
          "a focal length or centre");
  require(record.reference.mid_exposure_ns <= kBeforeAnyRun, "a time of mid-exposure");
  const SE3& T = record.reference.T_map_reference;
  require(T.translation().allFinite() && T.rotation().coeffs().allFinite(), "a pose");
  for (const ReferencePoint& point : record.reference.points) {
    require(camera.contains(point.pixel.cast<double>()) && point.inverse_depth > 0.0F &&
                std::isfinite(point.inverse_depth) && std::isfinite(point.variance),
            "a point");
  }
}

ArchivedKeyframe keyframeOf(KeyframeRecord& record) {
  const cv::Mat1b image = cv::imdecode(record.image, cv::IMREAD_GRAYSCALE);
  check(record, image);
  return {std::move(record.reference), record.frame_sequence, record.stamp_ns, record.camera, record.levels, image,
          record.image_exposure};
}

SavedMap mapOf(MapRecord& record) {
  SavedMap map;
  map.metric = record.metric;
  map.usual_error = record.usual_error;
  require(!record.keyframes.empty(), "no keyframe");
  require(std::isfinite(map.usual_error), "the usual error");
  for (KeyframeRecord& keyframe : record.keyframes) {
    require(map.keyframes.empty() || keyframe.reference.id.keyframe_id >= map.nextKeyframe(), "keyframes out of order");
    map.keyframes.push_back(keyframeOf(keyframe));
    map.keyframes.back().reference.metric = map.metric;
    require(canBeOfOneCamera(map.keyframes.front().camera, map.keyframes.back().camera), "images of different sizes");
  }
  return map;
}

/// What follows the head, if it is all there and as it was written.
std::string payloadOf(std::istream& in) {
  const std::string all((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (all.compare(0, kMagic.size(), kMagic.data(), kMagic.size()) != 0) {
    throw std::runtime_error("is no map: it does not begin with " + std::string(kMagic.begin(), kMagic.end()));
  }
  std::istringstream stream(all.substr(kMagic.size()));
  Head head;
  try {
    cereal::PortableBinaryInputArchive{stream}(head);
  } catch (const cereal::Exception&) {
    throw std::runtime_error("is cut off: it ends within its head");
  }
  if (head.version > kMapVersion || head.version == 0) {
    throw std::runtime_error("is of version " + std::to_string(head.version) + ", this program knows 1 to " +
                             std::to_string(kMapVersion));
  }
  std::string payload = all.substr(kMagic.size() + static_cast<std::size_t>(stream.tellg()));
  if (payload.size() < head.bytes) {
    throw std::runtime_error("is cut off: " + std::to_string(payload.size()) + " of " + std::to_string(head.bytes) +
                             " bytes");
  }
  if (payload.size() > head.bytes || checksumOf(payload) != head.checksum) {
    throw std::runtime_error("is damaged: its checksum is another one");
  }
  return payload;
}

}  // namespace

void writeMap(const std::string& file, SavedMap map) {
  if (map.keyframes.empty()) throw std::runtime_error(file + ": not written: the map has no keyframe");
  moveBeforeAnyRun(map);
  MapRecord record{map.metric, map.usual_error, {}};
  for (const ArchivedKeyframe& keyframe : map.keyframes) record.keyframes.push_back(recordOf(keyframe));
  std::ostringstream payload;
  cereal::PortableBinaryOutputArchive{payload}(record);
  const std::string bytes = payload.str();
  Head head;
  head.bytes = bytes.size();
  head.checksum = checksumOf(bytes);
  replaceFile(file, [&](std::ostream& out) {
    out.write(kMagic.data(), kMagic.size());
    cereal::PortableBinaryOutputArchive{out}(head);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  });
}

SavedMap readMap(const std::string& file) {
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": cannot be read: " + std::generic_category().message(errno));
  try {
    std::istringstream payload(payloadOf(in));
    MapRecord record;
    cereal::PortableBinaryInputArchive{payload}(record);
    return mapOf(record);
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

}  // namespace mba_vo
