#pragma once

#include <optional>
#include <string>

#include "mba_vo/simulation/simulator.h"

namespace mba_vo {

/// Keeps rendered images on disk, in one folder per set of parameters and renderer version. Frames are stored one by
/// one, so an interrupted sequence continues where it stopped.
class FrameCache {
 public:
  /// Throws std::runtime_error naming the folder if it cannot be made.
  FrameCache(const std::string& folder, const SimulationConfig& config);

  /// `$XDG_CACHE_HOME/mba_vo` or `~/.cache/mba_vo`; empty when neither variable is set.
  static std::string defaultFolder();

  /// Adds the images of frame `frame.id`, and its depths if they are there; false if an image that the configuration
  /// asks for is missing or unreadable.
  bool load(SimulatedFrame& frame) const;
  /// Throws std::runtime_error naming the file that cannot be written.
  void store(const SimulatedFrame& frame) const;

  const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
  int width_, height_;
  bool sharp_, depth_, jpeg_;
};

/// Frame `index`, from the cache if it is there.
SimulatedFrame renderCached(const Simulator& simulator, int index, const FrameCache& cache);

}  // namespace mba_vo
