#pragma once

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

}  // namespace mba_vo::test
