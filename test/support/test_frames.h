#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "mba_vo/simulation/frame_cache.h"

namespace mba_vo::test {

/// Frames that were once rendered stay in the folder for temporary files: every test is a process of its own.
inline FrameCache testFrames(const SimulationConfig& config) {
  const std::string folder = "mba_vo_test_frames_" + std::to_string(::getuid());
  return {(std::filesystem::temp_directory_path() / folder).string(), config};
}

/// Held by one process at a time, without it if the file cannot be made.
class FileLock {
 public:
  explicit FileLock(const std::string& file) : descriptor_(::open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600)) {
    ::flock(descriptor_, LOCK_EX);
  }
  ~FileLock() { ::close(descriptor_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

/// Of tests that want the same frame at the same time one renders it and the others wait.
inline SimulatedFrame testFrame(const Simulator& simulator, int index, const FrameCache& cache) {
  const FileLock lock(cache.folder() + "/" + std::to_string(index) + ".lock");
  return renderCached(simulator, index, cache);
}

}  // namespace mba_vo::test
