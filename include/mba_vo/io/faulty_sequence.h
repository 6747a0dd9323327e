#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "mba_vo/io/sequence.h"

namespace mba_vo {

/// Which faults, in which order, is decided by `seed` alone.
struct FaultConfig {
  unsigned seed = 1;
  std::vector<std::string> kinds;  // of faultKinds(); empty = all
};

/// What was done to an image of a spoilt sequence.
struct FaultRecord {
  std::uint64_t sequence = 0;        // in the spoilt sequence
  std::int64_t stamp_ns = 0;         // the same
  std::int64_t source_stamp_ns = 0;  // of the image in the recording: where its ground truth is
  std::string fault;                 // empty: none
};

/// black, saturated, covered, frozen, unreadable, gap, forwards, backwards, restart, brightness, exposure, kidnap.
const std::vector<std::string>& faultKinds();

/// A recording spoilt on purpose: it begins unspoilt; then, every second or two, something happens to it.
/// kidnap: the lens is covered for 0.2 to 2 s, in which the camera goes back the way it came, and on from there.
/// All images are held in memory. Throws std::invalid_argument naming an unknown kind.
class FaultySequence : public SequenceReader {
 public:
  FaultySequence(SequenceReader& recording, const FaultConfig& config);

  CameraCalibration calibration() const override { return calibration_; }
  std::size_t size() const override { return images_.size(); }
  std::optional<CameraImage> next() override;

  const std::vector<FaultRecord>& records() const { return records_; }

 private:
  CameraCalibration calibration_;
  std::vector<CameraImage> images_;
  std::vector<FaultRecord> records_;
  std::size_t next_ = 0;
};

/// As CSV: sequence, time, source_time, fault.
void writeFaults(const std::vector<FaultRecord>& records, std::ostream& out);

}  // namespace mba_vo
