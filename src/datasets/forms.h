#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mba_vo/datasets/dataset.h"
#include "mba_vo/io/camera_file.h"
#include "mba_vo/io/listed_sequence.h"

namespace mba_vo {

/// Folders that list their images in rgb.txt.
bool isRgbdFolder(const std::filesystem::path& folder);
Dataset openRgbdFolder(const std::filesystem::path& folder, const DatasetOptions& options);

/// EuRoC and TUM-VI.
struct AslFolders {
  std::filesystem::path root;    // that holds mav0
  std::filesystem::path camera;  // that holds data.csv
};
/// Nullopt if it is no ASL folder. `folder`: root, mav0 or that of a camera.
std::optional<AslFolders> findAslFolders(const std::filesystem::path& folder, const std::string& camera);
/// Where the calibration of the camera is. Throws std::runtime_error naming where it was looked for.
std::filesystem::path aslCameraFile(const AslFolders& folders);
Dataset openAslFolder(const AslFolders& folders, const DatasetOptions& options);

/// The numbers of the images frame-000000.color.png, ... in order, with their files; empty if it is no such folder.
struct NumberedFile {
  std::uint64_t number;
  std::filesystem::path file;
};
inline constexpr double kSevenScenesRate = 30.0;  // [Hz], by its makers; images have no stamps
std::vector<NumberedFile> sevenScenesFiles(const std::filesystem::path& folder, const std::string& kind);
std::int64_t sevenScenesTime(std::uint64_t number);  // [ns]
Dataset openSevenScenesFolder(const std::filesystem::path& folder, const DatasetOptions& options);

/// Throws std::runtime_error unless the options are such as this form has.
void refuseImages(const DatasetOptions& options, const std::string& form);
void refuseDepth(const DatasetOptions& options, const std::string& form, const std::string& reason);
void refuseCamera(const DatasetOptions& options, const std::string& form);

/// Size of the first image that can be read. Throws std::runtime_error naming the first if there is none.
cv::Size sizeOfFirst(const std::vector<ListedImage>& images);

}  // namespace mba_vo
