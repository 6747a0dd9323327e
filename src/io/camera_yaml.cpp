#include "mba_vo/io/camera_yaml.h"

#include <iomanip>
#include <limits>
#include <stdexcept>
#include <vector>

#include "camera_forms.h"
#include "mba_vo/io/text_lines.h"

namespace mba_vo {
namespace {

CameraFile readRos(const YamlFields& root, const std::string& file) {
  CameraFile result;
  result.form = "ROS camera_info";
  result.of_ros = true;
  CameraCalibration& c = result.calibration;
  c.width = root.whole("image_width");
  c.height = root.whole("image_height");
  const std::vector<double> K = root.map("camera_matrix").numbers("data", {9});
  c.fx = K[0];
  c.cx = K[2];
  c.fy = K[4];
  c.cy = K[5];
  // Files of old versions of ROS name no model; camera_info_manager takes it for this one, too.
  c.distortion_model = root.has("distortion_model") ? root.text("distortion_model") : "plumb_bob";
  c.distortion = root.map("distortion_coefficients").numbers("data", {});
  requireValid(c, file);
  return result;
}

/// The names of Kalibr and of ASL folders; ours where they agree.
std::string distortionModel(const YamlFields& camera, const std::string& key) {
  std::string name = camera.has(key) ? camera.text(key) : "none";
  if (name == "radtan" || name == "radial-tangential" || name == "plumb_bob") return "plumb_bob";
  if (name == "equidistant" || name == "fov") return name;
  if (name == "none") return "";
  camera.refuse(key, "radtan, radial-tangential, equidistant, fov or none");
}

SE3 readPose(const YamlFields& fields, const std::string& key, const std::vector<double>& values) {
  try {
    return poseOfMatrix(values);
  } catch (const std::invalid_argument& error) {
    fields.refuse(key, error.what());
  }
}

std::optional<SE3> readBodyPose(const YamlFields& fields) {
  if (!fields.has("T_BS")) return std::nullopt;
  const YamlFields matrix = fields.map("T_BS");
  return readPose(matrix, "data", matrix.numbers("data", {16}));
}

/// One camera as Kalibr and ASL folders have it, who differ in few names.
CameraFile readRig(const YamlFields& camera, const std::string& file) {
  const bool kalibr = camera.has("distortion_coeffs") || camera.has("T_cam_imu");
  CameraFile result;
  result.form = kalibr ? "Kalibr camchain" : "ASL sensor.yaml";
  if (camera.has("camera_model") && camera.text("camera_model") != "pinhole") {
    camera.refuse("camera_model", "pinhole (with any distortion_model: radtan, equidistant, fov or none)");
  }
  const std::vector<double> K = camera.numbers("intrinsics", {4});
  const std::vector<double> size = camera.numbers("resolution", {2});
  CameraCalibration& c = result.calibration;
  c = {0, 0, K[0], K[1], K[2], K[3], distortionModel(camera, "distortion_model"), {}};
  for (const double side : size) {
    constexpr double kLargest = 1e5;  // [px]
    if (!(side >= 1.0 && side <= kLargest && side == static_cast<int>(side))) {
      camera.refuse("resolution", "width and height, whole numbers of pixels");
    }
  }
  c.width = static_cast<int>(size[0]);
  c.height = static_cast<int>(size[1]);
  const char* const coefficients = kalibr ? "distortion_coeffs" : "distortion_coefficients";
  if (c.distortion_model == "fov") c.distortion = camera.numbers(coefficients, {1});
  if (c.distortion_model == "plumb_bob") c.distortion = camera.numbers(coefficients, {4, 5});
  if (c.distortion_model == "equidistant") c.distortion = camera.numbers(coefficients, {4});
  result.T_body_camera = readBodyPose(camera);
  if (camera.has("T_cam_imu")) {
    result.T_body_camera = readPose(camera, "T_cam_imu", camera.matrix4("T_cam_imu")).inverse();
  }
  requireValid(c, file);
  return result;
}

/// Of the cameras of a Kalibr file.
std::string chooseCamera(const std::vector<std::string>& cameras, const std::string& wanted, const std::string& file) {
  std::string name = wanted.empty() && cameras.size() == 1 ? cameras.front() : (wanted.empty() ? "cam0" : wanted);
  for (const std::string& camera : cameras) {
    if (camera == name) return name;
  }
  throw std::runtime_error(file + ": has no camera '" + name + "', but " + joinWords(cameras, ", "));
}

void writeMatrix(const char* name, int rows, const std::vector<double>& data, std::ostream& out) {
  const std::size_t columns = data.size() / static_cast<std::size_t>(rows);
  out << name << ":\n  rows: " << rows << "\n  cols: " << columns << "\n  data: [";
  for (std::size_t i = 0; i < data.size(); ++i) out << (i > 0 ? ", " : "") << data[i];
  out << "]\n";
}

}  // namespace

CameraFile readCameraYaml(const YamlFields& root, const std::string& file, const std::string& camera) {
  std::vector<std::string> cameras;
  for (const std::string& key : root.keys()) {
    if (key.compare(0, 3, "cam") == 0 && key.find_first_not_of("0123456789", 3) == std::string::npos) {
      cameras.push_back(key);
    }
  }
  if (!cameras.empty()) {
    CameraFile result = readRig(root.map(chooseCamera(cameras, camera, file)), file);
    result.has_names = true;
    return result;
  }
  if (root.has("intrinsics")) return readRig(root, file);
  if (root.has("image_width") || root.has("camera_matrix")) return readRos(root, file);
  throw std::runtime_error(
      file +
      ": no calibration that is known: 'image_width' and 'camera_matrix' (ROS), 'cam0' (Kalibr) or "
      "'intrinsics' (ASL) is missing; its keys are " +
      joinWords(root.keys(), ", "));
}

std::optional<SE3> readSensorPose(const std::string& file) {
  return readBodyPose(YamlFields::parse(readText(file, kMostCalibrationBytes), file));
}

void writeCameraYaml(const CameraCalibration& c, const std::string& camera_name, std::ostream& out) {
  const std::vector<double> distortion = c.distortion.empty() ? std::vector<double>(5, 0.0) : c.distortion;
  out << std::setprecision(std::numeric_limits<double>::max_digits10) << "image_width: " << c.width
      << "\nimage_height: " << c.height << "\ncamera_name: " << camera_name << "\n";
  writeMatrix("camera_matrix", 3, {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}, out);
  out << "distortion_model: " << (c.distortion_model.empty() ? "plumb_bob" : c.distortion_model) << "\n";
  writeMatrix("distortion_coefficients", 1, distortion, out);
  writeMatrix("rectification_matrix", 3, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, out);
  writeMatrix("projection_matrix", 3, {c.fx, 0.0, c.cx, 0.0, 0.0, c.fy, c.cy, 0.0, 0.0, 0.0, 1.0, 0.0}, out);
}

}  // namespace mba_vo
