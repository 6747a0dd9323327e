#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "mba_vo/io/progress_bar.h"
#include "mba_vo/io/sequence.h"

/// What recording a program reads, and how: options that programs have in common.
struct RecordingArguments {
  std::string sequence;
  std::string images = "images";
  mba_vo::DepthFolder depth;
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

/// From its beginning. Throws std::runtime_error naming what is missing or wrong.
std::unique_ptr<mba_vo::SequenceReader> openSequence(const RecordingArguments& a);
