#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>

#include "mba_vo/image/frame_builder.h"
#include "mba_vo/io/progress_bar.h"
#include "mba_vo/io/sequence.h"

/// What recording a program reads, and how: options that programs have in common.
struct RecordingArguments {
  std::string sequence;
  std::string images = "images";
  mba_vo::DepthFolder depth;
  std::string calibration;  // file, empty = that of the recording
  std::string camera;       // empty = the first
  std::string exposure = "auto";
  std::string image_topic;
  std::string camera_info_topic;
  std::string exposure_topic;
  std::string depth_topic;
  double depth_tolerance = 0.02;  // [s]
  std::string stamp_reference = "middle";
  std::optional<double> row_time;  // [s]
  std::size_t skip = 0;
  std::size_t frames = 0;
  bool rectified = false;
};

void describeRecording(CLI::App& app, RecordingArguments& a);

/// For all images [s]; nullopt = as recorded.
std::optional<double> exposureOverride(const RecordingArguments& a);

/// On the terminal, if there is one, for the images of `reader` that are to be taken.
std::unique_ptr<mba_vo::ProgressBar> progressBar(const RecordingArguments& a, const mba_vo::SequenceReader& reader);

/// What the form of the recording tells of the camera goes into `config`, where that does not tell it, and its notes to
/// the user into `log`. Throws as openSequence.
void adoptWhatIsKnown(const RecordingArguments& a, mba_vo::FrameBuilderConfig& config, std::ostream& log);

/// From its beginning. Throws std::runtime_error naming what is missing or wrong.
std::unique_ptr<mba_vo::SequenceReader> openSequence(const RecordingArguments& a);
