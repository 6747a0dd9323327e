#include "mba_vo/datasets/sequence_export.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "export_forms.h"
#include "mba_vo/image/rectifier.h"
#include "mba_vo/image/white_level.h"
#include "mba_vo/io/image_files.h"
#include "mba_vo/io/photometric_files.h"
#include "mba_vo/io/text_lines.h"
#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSheet = "frames.csv";  // shows that a folder is an export
constexpr double kWhite = 255.0;
constexpr double kNearlyWhite = 254.0;

std::vector<ExportForm> chosenForms(const ExportOptions& options, const CameraCalibration& calibration) {
  std::vector<ExportForm> chosen;
  for (const std::string& name : options.forms) {
    const auto& all = allExportForms();
    const auto form = std::find_if(all.begin(), all.end(), [&](const ExportForm& f) { return f.name == name; });
    if (form == all.end()) {
      throw std::invalid_argument("form '" + name + "': must be one of " + joinWords(exportForms(), ", "));
    }
    form->requireLens(calibration);
    chosen.push_back(*form);
  }
  if (chosen.empty()) throw std::invalid_argument("no form; allowed are " + joinWords(exportForms(), ", "));
  return chosen;
}

/// Images of an earlier export would be taken for some of this one.
void prepare(const fs::path& folder, const std::vector<ExportForm>& forms, bool overwrite) {
  for (const ExportForm& form : forms) {
    const fs::path own = folder / form.name;
    if (!fs::exists(own)) continue;
    if (!overwrite) throw std::runtime_error(own.string() + ": is there already; choose another folder");
    if (!fs::exists(folder / kSheet)) {
      throw std::runtime_error(own.string() + ": not an earlier export, for there is no " + kSheet + " beside it");
    }
    for (const char* made : form.folders()) fs::remove_all(own / made);
  }
  fs::create_directories(folder);
  // From now on it is one, even if it is not finished.
  writeFile((folder / kSheet).string(), [](std::ostream& out) { writeFrameSheet({}, out); });
}

CameraCalibration pinhole(const PinholeCamera& c) {
  return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, "plumb_bob", {}};
}

/// Every channel by itself; black where the camera sees nothing.
cv::Mat rectified(const Rectifier& rectifier, const cv::Mat& image) {
  std::vector<cv::Mat> channels;
  cv::split(image, channels);
  for (cv::Mat& channel : channels) {
    cv::Mat1f values;
    channel.convertTo(values, CV_32F);
    values = rectifier.rectify(values);
    cv::patchNaNs(values, 0.0);
    values.convertTo(channel, CV_8U);
  }
  cv::Mat result;
  cv::merge(channels, result);
  return result;
}

void measure(const cv::Mat& image, ExportedFrame& frame) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  frame.light = cv::mean(grey)[0];
  const int extreme = cv::countNonZero(grey >= kNearlyWhite) + cv::countNonZero(grey == 0);
  frame.saturated = static_cast<double>(extreme) / static_cast<double>(grey.total());
  cv::Mat1f dx, dy, length;
  constexpr double kCentralDifference = 0.5;
  cv::Sobel(grey, dx, CV_32F, 1, 0, 1, kCentralDifference);
  cv::Sobel(grey, dy, CV_32F, 0, 1, 1, kCentralDifference);
  cv::magnitude(dx, dy, length);
  frame.texture = cv::mean(length)[0];
}

/// Where the file system has no links it is copied.
void linkOrCopy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_hard_link(from, to, error);
  if (error) fs::copy_file(from, to, fs::copy_options::overwrite_existing);
}

}  // namespace

std::vector<std::string> exportForms() {
  std::vector<std::string> names;
  for (const ExportForm& form : allExportForms()) names.emplace_back(form.name);
  return names;
}

class SequenceExport::Impl {
 public:
  Impl(std::string folder, const CameraCalibration& calibration, const FrameBuilderConfig& image,
       const ExportOptions& options)
      : folder_(std::move(folder)), recorded_(calibration), white_level_(image.white_level) {
    content_.calibration = calibration;
    content_.gamma = image.gamma;
    content_.photometric = loadPhotometricCalibration(image);
    checkVignette(image.vignette_file);
    if (options.rectify) rectify();
    forms_ = chosenForms(options, content_.calibration);
    prepare(folder_, forms_, options.overwrite);
  }

  void add(const CameraImage& image) {
    const std::string reason = whyNot(image);
    if (!reason.empty()) {
      left_out_.push_back("image " + std::to_string(image.sequence) + ": " + reason);
      return;
    }
    ExportedFrame frame;
    frame.sequence = image.sequence;
    frame.stamp_ns = image.mid_exposure_ns;
    frame.exposure = image.exposure;
    frame.depth = !image.depth.empty();
    const cv::Mat pixels = eightBit(image);
    measure(pixels, frame);
    writeImages(rectifier_ ? rectified(*rectifier_, pixels) : pixels, image.depth, frame);
    content_.frames.push_back(frame);
  }

  void finish(const std::vector<PoseRecord>& truth) {
    if (content_.frames.empty()) throw std::runtime_error(folder_.string() + ": no image to export");
    content_.truth = truth;
    for (const ExportForm& form : forms_) form.writeLists(folder_ / form.name, content_);
    writeFile((folder_ / kSheet).string(), [&](std::ostream& out) { writeFrameSheet(content_.frames, out); });
  }

  const std::vector<ExportedFrame>& frames() const { return content_.frames; }
  const std::vector<std::string>& leftOut() const { return left_out_; }

 private:
  void checkVignette(const std::string& file) const {
    const cv::Size size = content_.photometric.vignette.size();
    if (size.empty() || size == cv::Size(recorded_.width, recorded_.height)) return;
    throw std::invalid_argument(file + ": vignette of " + std::to_string(size.width) + "x" +
                                std::to_string(size.height) + " px, the images have " +
                                std::to_string(recorded_.width) + "x" + std::to_string(recorded_.height));
  }

  void rectify() {
    rectifier_.emplace(recorded_);
    content_.calibration = pinhole(rectifier_->camera());
    if (content_.photometric.vignette.empty()) return;
    content_.photometric.vignette = rectifier_->rectify(content_.photometric.vignette);
    cv::patchNaNs(content_.photometric.vignette, 1.0);  // readers divide by it; the images are black there
  }

  std::string whyNot(const CameraImage& image) const {
    if (image.image.empty()) return image.problem;
    if (content_.frames.empty() || image.mid_exposure_ns > content_.frames.back().stamp_ns) return "";
    return "its stamp " + formatSeconds(image.mid_exposure_ns) + " is not later than that of the image before";
  }

  cv::Mat eightBit(const CameraImage& image) {
    const std::string name = "image " + std::to_string(image.sequence);
    if (image.image.size() != cv::Size(recorded_.width, recorded_.height)) {
      throw std::runtime_error(name + " is " + std::to_string(image.image.cols) + "x" +
                               std::to_string(image.image.rows) + " px, the calibration says " +
                               std::to_string(recorded_.width) + "x" + std::to_string(recorded_.height));
    }
    const double white = white_level_.of(image.image);
    if (!content_.frames.empty() && white != white_) {
      throw std::runtime_error(name + " has values above " + std::to_string(std::lround(white_)) +
                               ", which those before were scaled by; image.white_level of the configuration must tell");
    }
    white_ = white;
    cv::Mat result;
    image.image.convertTo(result, CV_8U, kWhite / white);
    constexpr int kWithAlpha = 4;
    if (result.channels() == kWithAlpha) cv::cvtColor(result, result, cv::COLOR_BGRA2BGR);
    return result;
  }

  void writeImages(const cv::Mat& pixels, const cv::Mat1f& depth, const ExportedFrame& frame) const {
    fs::path first;
    for (const ExportForm& form : forms_) {
      const fs::path file = folder_ / form.name / form.image(frame, content_.frames.size());
      fs::create_directories(file.parent_path());
      if (first.empty()) {
        writePng(file, pixels);
        first = file;
      } else {
        linkOrCopy(first, file);
      }
      if (frame.depth && form.depth != nullptr) writeDepth(folder_ / form.name / form.depth(frame), depth);
    }
  }

  void writeDepth(const fs::path& file, const cv::Mat1f& depth) const {
    cv::Mat1f metres = rectifier_ ? rectifier_->rectifyDepth(depth) : depth.clone();
    cv::patchNaNs(metres, 0.0);
    metres.setTo(0.0F, metres > kSixteenBitWhite / kTumDepthUnits);
    cv::Mat units;
    metres.convertTo(units, CV_16U, kTumDepthUnits);
    fs::create_directories(file.parent_path());
    writePng(file, units);
  }

  fs::path folder_;
  CameraCalibration recorded_;
  WhiteLevel white_level_;
  double white_ = 0.0;
  std::optional<Rectifier> rectifier_;
  std::vector<ExportForm> forms_;
  ExportContent content_;
  std::vector<std::string> left_out_;
};

SequenceExport::SequenceExport(const std::string& folder, const CameraCalibration& calibration,
                               const FrameBuilderConfig& image, const ExportOptions& options)
    : impl_(std::make_unique<Impl>(folder, calibration, image, options)) {}
SequenceExport::~SequenceExport() = default;
SequenceExport::SequenceExport(SequenceExport&&) noexcept = default;

void SequenceExport::add(const CameraImage& image) { impl_->add(image); }
void SequenceExport::finish(const std::vector<PoseRecord>& truth) { impl_->finish(truth); }
const std::vector<ExportedFrame>& SequenceExport::frames() const { return impl_->frames(); }
const std::vector<std::string>& SequenceExport::leftOut() const { return impl_->leftOut(); }

}  // namespace mba_vo
