#include "mba_vo/simulation/frame_cache.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "mba_vo/simulation/content_hash.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

std::string fileName(const std::string& folder, std::uint64_t id, const char* kind) {
  char name[48];
  std::snprintf(name, sizeof(name), "%06llu_%s", static_cast<unsigned long long>(id), kind);
  return folder + "/" + name;
}

/// A reader never sees half a file, even when two processes fill the same cache.
void writeAtomically(const std::string& file, const std::vector<unsigned char>& bytes) {
  const std::string temporary = file + "." + std::to_string(::getpid());
  std::ofstream out(temporary, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error("cannot write '" + temporary + "'");
  fs::rename(temporary, file);
}

void writePng(const std::string& file, const cv::Mat1b& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  writeAtomically(file, bytes);
}

bool readJpeg(const std::string& file, const cv::Size& size, SimulatedFrame& frame) {
  std::ifstream in(file, std::ios::binary);
  frame.jpeg.assign(std::istreambuf_iterator<char>(in), {});
  if (frame.jpeg.empty()) return false;
  frame.blurred = cv::imdecode(frame.jpeg, cv::IMREAD_UNCHANGED);
  return frame.blurred.size() == size;
}

bool readPng(const std::string& file, const cv::Size& size, cv::Mat1b& image) {
  if (!fs::exists(file)) return false;
  image = cv::imread(file, cv::IMREAD_UNCHANGED);
  return image.size() == size;
}

bool readDepth(const std::string& file, const cv::Size& size, cv::Mat1f& depth) {
  depth.create(size);
  const auto bytes = static_cast<std::streamsize>(depth.total() * sizeof(float));
  std::ifstream in(file, std::ios::binary);
  return in.read(reinterpret_cast<char*>(depth.data), bytes) && in.peek() == std::ifstream::traits_type::eof();
}

}  // namespace

FrameCache::FrameCache(const std::string& folder, const SimulationConfig& config)
    : width_(config.width), height_(config.height), sharp_(config.sharp), depth_(config.depth), jpeg_(config.jpeg > 0) {
  const std::string fingerprint = config.fingerprint();
  char name[20];
  std::snprintf(name, sizeof(name), "%016llx",
                static_cast<unsigned long long>(contentHash(fingerprint.data(), fingerprint.size())));
  folder_ = folder + "/" + name;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw std::runtime_error("cannot make the cache folder '" + folder_ + "': " + error.message());
  const std::string parameters = folder_ + "/parameters.txt";
  if (!fs::exists(parameters)) writeAtomically(parameters, {fingerprint.begin(), fingerprint.end()});
}

std::string FrameCache::defaultFolder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache != '\0') return std::string(cache) + "/mba_vo";
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return std::string(home) + "/.cache/mba_vo";
  return "";
}

bool FrameCache::load(SimulatedFrame& frame) const {
  const cv::Size size(width_, height_);
  const bool found = jpeg_ ? readJpeg(fileName(folder_, frame.id, "blurred.jpg"), size, frame)
                           : readPng(fileName(folder_, frame.id, "blurred.png"), size, frame.blurred);
  if (!found) return false;
  if (sharp_ && !readPng(fileName(folder_, frame.id, "sharp.png"), size, frame.sharp)) return false;
  if (depth_ && !readDepth(fileName(folder_, frame.id, "depth.f32"), size, frame.depth)) frame.depth.release();
  return true;
}

void FrameCache::store(const SimulatedFrame& frame) const {
  if (jpeg_) {
    writeAtomically(fileName(folder_, frame.id, "blurred.jpg"), frame.jpeg);
  } else {
    writePng(fileName(folder_, frame.id, "blurred.png"), frame.blurred);
  }
  if (!frame.sharp.empty()) writePng(fileName(folder_, frame.id, "sharp.png"), frame.sharp);
  if (!frame.depth.empty()) {
    const auto* begin = frame.depth.ptr<unsigned char>();
    writeAtomically(fileName(folder_, frame.id, "depth.f32"), {begin, begin + frame.depth.total() * sizeof(float)});
  }
}

SimulatedFrame renderCached(const Simulator& simulator, int index, const FrameCache& cache) {
  SimulatedFrame frame = simulator.groundTruth(index);
  const bool known = cache.load(frame);
  const bool lacks_depth = simulator.config().depth && frame.depth.empty();
  if (known && !lacks_depth) return frame;
  if (known) {
    frame.depth = simulator.renderDepth(index);  // takes a fraction of the time of a blurred image
  } else {
    frame = simulator.render(index);
  }
  cache.store(frame);
  return frame;
}

}  // namespace mba_vo
