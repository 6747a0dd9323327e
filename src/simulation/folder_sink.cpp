#include "mba_vo/simulation/folder_sink.h"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <opencv2/imgcodecs.hpp>

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

/// With the reason that the system gave, if it gave one since errno was set to 0.
std::runtime_error cannotWrite(const std::string& file) {
  const int reason = errno;
  return std::runtime_error("cannot write '" + file + "'" +
                            (reason == 0 ? "" : ": " + std::generic_category().message(reason)));
}

std::ofstream openForWriting(const std::string& file) {
  errno = 0;
  std::ofstream out(file);
  if (!out) throw cannotWrite(file);
  out << std::fixed;
  return out;
}

std::string seconds(std::int64_t ns) {
  char text[40];
  std::snprintf(text, sizeof(text), "%lld.%09lld", static_cast<long long>(ns / 1000000000),
                static_cast<long long>(ns % 1000000000));
  return text;
}

std::string fileName(const SimulatedFrame& frame, const char* extension) {
  char name[40];
  std::snprintf(name, sizeof(name), "/%06llu.%s", static_cast<unsigned long long>(frame.id), extension);
  return name;
}

std::string poseText(const SE3& pose) {
  std::ostringstream text;
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  text << std::fixed << std::setprecision(9) << t.x() << ' ' << t.y() << ' ' << t.z() << ' ' << q.x() << ' ' << q.y()
       << ' ' << q.z() << ' ' << q.w();
  return text.str();
}

std::string list(const std::vector<double>& values) {
  std::ostringstream text;
  text << std::setprecision(12) << '[';
  for (std::size_t i = 0; i < values.size(); ++i) text << (i > 0 ? ", " : "") << values[i];
  text << ']';
  return text.str();
}

void writeCamera(const std::string& file, const CameraCalibration& c) {
  std::vector<double> d = c.distortion;
  if (d.empty()) d.assign(c.distortion_model == "rational_polynomial" ? 8 : 5, 0.0);
  std::ofstream out = openForWriting(file);
  out << "image_width: " << c.width << "\nimage_height: " << c.height << "\ncamera_name: simulated\n"
      << "camera_matrix: {rows: 3, cols: 3, data: " << list({c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}) << "}\n"
      << "distortion_model: " << c.distortion_model << "\n"
      << "distortion_coefficients: {rows: 1, cols: " << d.size() << ", data: " << list(d) << "}\n"
      << "rectification_matrix: {rows: 3, cols: 3, data: " << list({1, 0, 0, 0, 1, 0, 0, 0, 1}) << "}\n"
      << "projection_matrix: {rows: 3, cols: 4, data: " << list({c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0})
      << "}\n";
}

}  // namespace

FolderSink::FolderSink(const std::string& folder, const CameraCalibration& calibration, bool overwrite)
    : folder_(folder) {
  std::error_code error;
  if (fs::exists(folder + "/times.txt", error)) {
    if (!overwrite) throw std::runtime_error("'" + folder + "' already holds a sequence; choose another folder");
    for (const char* images : {"/images", "/images_sharp", "/depth"}) fs::remove_all(folder + images, error);
  }
  fs::create_directories(folder + "/images", error);
  if (error) throw std::runtime_error("cannot make the folder '" + folder + "/images': " + error.message());
  writeCamera(folder + "/camera.yaml", calibration);
  times_ = openForWriting(folder + "/times.txt");
  times_ << "# id t_mid[s] exposure[ms]\n";
  groundtruth_ = openForWriting(folder + "/groundtruth.txt");
  groundtruth_ << "# mid-exposure camera-to-world pose (optical frame): t tx ty tz qx qy qz qw\n";
  exposures_ = openForWriting(folder + "/groundtruth_exposure.txt");
  exposures_ << "# t_mid exposure[s] then start pose and end pose, each tx ty tz qx qy qz qw\n";
  blur_ = openForWriting(folder + "/blur_px.txt");
}

void FolderSink::write(const SimulatedFrame& frame) {
  if (frame.jpeg.empty()) {
    writeImage("images", frame, frame.blurred);
  } else {
    writeJpeg(frame);
  }
  if (!frame.sharp.empty()) writeImage("images_sharp", frame, frame.sharp);
  if (!frame.depth.empty()) {
    cv::Mat depth;
    cv::Mat1f near = frame.depth.clone();
    near.setTo(0.0F, frame.depth > 65535.0 / kDepthUnitsPerMetre);
    near.convertTo(depth, CV_16U, kDepthUnitsPerMetre);
    writeImage("depth", frame, depth);
  }
  const std::string t = seconds(frame.mid_exposure_ns);
  times_ << frame.id << ' ' << t << ' ' << std::setprecision(4) << 1e3 * frame.toldExposure().value_or(0.0) << '\n';
  groundtruth_ << t << ' ' << poseText(frame.T_world_mid) << '\n';
  exposures_ << t << ' ' << std::setprecision(6) << frame.exposure << ' ' << poseText(frame.T_world_start) << ' '
             << poseText(frame.T_world_end) << '\n';
  blur_ << std::setprecision(2) << frame.blur_px << '\n';
  flush();
}

void FolderSink::writeImage(const std::string& subfolder, const SimulatedFrame& frame, const cv::Mat& image) const {
  std::error_code error;
  fs::create_directories(folder_ + "/" + subfolder, error);
  const std::string file = folder_ + "/" + subfolder + fileName(frame, "png");
  errno = error.value();
  if (error || !cv::imwrite(file, image, {cv::IMWRITE_PNG_COMPRESSION, 1})) throw cannotWrite(file);
}

void FolderSink::writeJpeg(const SimulatedFrame& frame) const {
  const std::string file = folder_ + "/images" + fileName(frame, "jpg");
  std::ofstream out = openForWriting(file);
  out.write(reinterpret_cast<const char*>(frame.jpeg.data()), static_cast<std::streamsize>(frame.jpeg.size()));
  out.close();
  if (!out) throw cannotWrite(file);
}

void FolderSink::flush() {
  errno = 0;
  for (std::ofstream* file : {&times_, &groundtruth_, &exposures_, &blur_}) {
    if (!file->flush()) throw cannotWrite(folder_ + "/*.txt");
  }
}

}  // namespace mba_vo
