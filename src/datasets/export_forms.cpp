#include "export_forms.h"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "mba_vo/datasets/foreign_calibration.h"
#include "mba_vo/io/camera_yaml.h"
#include "mba_vo/io/image_files.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr double kMilliseconds = 1e3;  // per second
constexpr double kGreyLevels = 255.0;

std::string indexName(std::size_t index) {
  std::ostringstream name;
  name << std::setw(6) << std::setfill('0') << index;
  return name.str();
}

std::string nanoseconds(const ExportedFrame& frame) { return std::to_string(frame.stamp_ns); }
std::string colourFile(const ExportedFrame& frame) { return "rgb/" + formatSeconds(frame.stamp_ns) + ".png"; }
std::string depthFile(const ExportedFrame& frame) { return "depth/" + formatSeconds(frame.stamp_ns) + ".png"; }

/// `separators`: between the seven numbers; the quaternion with w first or last.
void writePose(const SE3& T, const char* separator, bool w_first, std::ostream& out) {
  const Eigen::Vector3d& t = T.translation();
  const Eigen::Quaterniond& q = T.rotation();
  out << std::fixed << std::setprecision(9);
  for (const double value : {t.x(), t.y(), t.z()}) out << separator << value;
  if (w_first) out << separator << q.w();
  for (const double value : {q.x(), q.y(), q.z()}) out << separator << value;
  if (!w_first) out << separator << q.w();
}

std::int64_t stampOf(const PoseRecord& pose) { return std::llround(1e9 * pose.time); }

void writeTruth(const fs::path& folder, const std::vector<PoseRecord>& truth) {
  if (truth.empty()) return;
  writeFile((folder / "groundtruth.txt").string(), [&](std::ostream& out) {
    out << "# ground truth trajectory of the camera, optical frame\n# by mba_vo_export\n"
        << "# timestamp tx ty tz qx qy qz qw\n";
    for (const PoseRecord& pose : truth) {
      out << formatSeconds(stampOf(pose));
      writePose(pose.T_world_camera, " ", false, out);
      out << "\n";
    }
  });
}

/// `id` of a frame, then its stamp and exposure; 0 = unknown.
template <typename Id>
void writeTimes(const fs::path& file, const std::vector<ExportedFrame>& frames, const char* head, const Id& id) {
  writeFile(file.string(), [&](std::ostream& out) {
    out << head << std::setprecision(9);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      out << id(i) << " " << formatSeconds(frames[i].stamp_ns) << " "
          << kMilliseconds * frames[i].exposure.value_or(0.0) << "\n";
    }
  });
}

void writeResponse(const fs::path& folder, const ExportContent& content) {
  std::vector<double> response = content.photometric.inverse_response;
  if (response.empty() && content.gamma != 1.0) {
    for (int grey = 0; grey <= static_cast<int>(kGreyLevels); ++grey) {
      response.push_back(kGreyLevels * std::pow(grey / kGreyLevels, content.gamma));
    }
  }
  if (response.empty()) return;
  writeFile((folder / "pcalib.txt").string(), [&](std::ostream& out) {
    out << std::setprecision(12);
    for (std::size_t i = 0; i < response.size(); ++i) out << (i > 0 ? " " : "") << response[i];
    out << "\n";
  });
}

void writeVignette(const fs::path& folder, const ExportContent& content) {
  if (content.photometric.vignette.empty()) return;
  cv::Mat sixteen_bit;
  content.photometric.vignette.convertTo(sixteen_bit, CV_16U, kSixteenBitWhite);
  writePng(folder / "vignette.png", sixteen_bit);
}

void writeDso(const fs::path& folder, const ExportContent& content) {
  writeTimes(folder / "times.txt", content.frames, "", indexName);
  writeFile((folder / "camera.txt").string(), [&](std::ostream& out) { writeDsoCamera(content.calibration, out); });
  writeResponse(folder, content);
  writeVignette(folder, content);
  writeTruth(folder, content.truth);
}

void writeSettings(const fs::path& folder, const ExportContent& content) {
  writeFile((folder / "orb_slam.yaml").string(),
            [&](std::ostream& out) { writeOrbSlamSettings(content.calibration, content.rate(), out); });
}

void writeAslTruth(const fs::path& folder, const std::vector<PoseRecord>& truth) {
  if (truth.empty()) return;
  fs::create_directories(folder);
  writeFile((folder / "data.csv").string(), [&](std::ostream& out) {
    out << "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n";
    for (const PoseRecord& pose : truth) {
      out << stampOf(pose);
      writePose(pose.T_world_camera, ",", true, out);
      out << "\n";
    }
  });
}

void writeEuroc(const fs::path& folder, const ExportContent& content) {
  const fs::path camera = folder / "mav0" / "cam0";
  writeFile((camera / "data.csv").string(), [&](std::ostream& out) {
    out << "#timestamp [ns],filename\n";
    for (const ExportedFrame& frame : content.frames) {
      out << nanoseconds(frame) << "," << nanoseconds(frame) << ".png\n";
    }
  });
  writeFile((camera / "sensor.yaml").string(),
            [&](std::ostream& out) { writeAslCamera(content.calibration, content.rate(), out); });
  writeFile((folder / "times.txt").string(), [&](std::ostream& out) {
    for (const ExportedFrame& frame : content.frames) out << nanoseconds(frame) << "\n";
  });
  bool exposures = false;
  for (const ExportedFrame& frame : content.frames) exposures = exposures || frame.exposure;
  if (exposures) {  // as TUM-VI tells them
    fs::create_directories(folder / "dso" / "cam0");
    writeTimes(folder / "dso" / "cam0" / "times.txt", content.frames, "# timestamp[ns] timestamp[s] exposure[ms]\n",
               [&](std::size_t i) { return nanoseconds(content.frames[i]); });
  }
  writeSettings(folder, content);
  writeAslTruth(folder / "mav0" / "state_groundtruth_estimate0", content.truth);
}

/// Three lines of comment: readers skip so many, whatever is in them.
void writeImageList(const fs::path& file, const char* what, const std::vector<ExportedFrame>& frames, bool depth) {
  writeFile(file.string(), [&](std::ostream& out) {
    out << "# " << what << "\n# by mba_vo_export\n# timestamp filename\n";
    for (const ExportedFrame& frame : frames) {
      if (depth && !frame.depth) continue;
      out << formatSeconds(frame.stamp_ns) << " " << (depth ? depthFile(frame) : colourFile(frame)) << "\n";
    }
  });
}

void writeTum(const fs::path& folder, const ExportContent& content) {
  writeImageList(folder / "rgb.txt", "color images", content.frames, false);
  bool depths = false;
  for (const ExportedFrame& frame : content.frames) depths = depths || frame.depth;
  if (depths) {
    writeImageList(folder / "depth.txt", "depth maps", content.frames, true);
    writeFile((folder / "associations.txt").string(), [&](std::ostream& out) {
      for (const ExportedFrame& frame : content.frames) {
        const std::string stamp = formatSeconds(frame.stamp_ns);
        if (frame.depth) out << stamp << " " << colourFile(frame) << " " << stamp << " " << depthFile(frame) << "\n";
      }
    });
  }
  writeFile((folder / "camera.yaml").string(),
            [&](std::ostream& out) { writeCameraYaml(content.calibration, "camera", out); });
  writeSettings(folder, content);
  writeTruth(folder, content.truth);
}

void checkDso(const CameraCalibration& calibration) {
  std::ostringstream nowhere;
  writeDsoCamera(calibration, nowhere);
}
void checkEuroc(const CameraCalibration& calibration) {
  std::ostringstream nowhere;
  writeAslCamera(calibration, 1.0, nowhere);
}
void checkTum(const CameraCalibration& calibration) {
  std::ostringstream nowhere;
  writeOrbSlamSettings(calibration, 1.0, nowhere);
}

}  // namespace

double ExportContent::rate() const {
  const double seconds = 1e-9 * static_cast<double>(frames.back().stamp_ns - frames.front().stamp_ns);
  return seconds > 0.0 ? static_cast<double>(frames.size() - 1) / seconds : 1.0;
}

const std::vector<ExportForm>& allExportForms() {
  static const std::vector<ExportForm> kForms{
      {"dso", checkDso,
       [](const ExportedFrame& /*frame*/, std::size_t index) { return "images/" + indexName(index) + ".png"; }, nullptr,
       [] { return std::vector<const char*>{"images"}; }, writeDso},
      {"euroc", checkEuroc,
       [](const ExportedFrame& frame, std::size_t) { return "mav0/cam0/data/" + nanoseconds(frame) + ".png"; }, nullptr,
       [] {
         return std::vector<const char*>{"mav0", "dso"};
       },
       writeEuroc},
      {"tum", checkTum, [](const ExportedFrame& frame, std::size_t) { return colourFile(frame); }, depthFile,
       [] {
         return std::vector<const char*>{"rgb", "depth"};
       },
       writeTum}};
  return kForms;
}

void writeFrameSheet(const std::vector<ExportedFrame>& frames, std::ostream& out) {
  out << "sequence,time,exposure,light,saturated,texture\n" << std::setprecision(6);
  for (const ExportedFrame& frame : frames) {
    out << frame.sequence << "," << formatSeconds(frame.stamp_ns) << ",";
    if (frame.exposure) out << *frame.exposure;
    out << "," << frame.light << "," << frame.saturated << "," << frame.texture << "\n";
  }
}

}  // namespace mba_vo
