#include "mba_vo/io/faulty_sequence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {
namespace {

constexpr double kUnspoilt = 2.5;                      // [s] at the beginning
constexpr double kLeastPause = 1.2, kMostPause = 2.5;  // [s] between faults
constexpr std::size_t kTurningMargin = 3;              // images; the walk through the recording turns before its ends

/// A walk through the recording, image by image, to which things happen.
class Spoiler {
 public:
  Spoiler(std::vector<CameraImage> recording, const FaultConfig& config)
      : recording_(std::move(recording)), random_(config.seed), kinds_(config.kinds) {
    if (kinds_.empty()) kinds_ = faultKinds();
    for (const std::string& kind : kinds_) {
      const auto& known = faultKinds();
      if (std::find(known.begin(), known.end(), kind) == known.end()) {
        throw std::invalid_argument("fault '" + kind + "': no such kind");
      }
    }
  }

  void run(std::vector<CameraImage>& images, std::vector<FaultRecord>& records) {
    if (recording_.size() < 2 * kTurningMargin + 2) return;
    const double seconds = duration(recording_.size() - 1);
    time_ns_ = recording_.front().mid_exposure_ns;
    double until_next = kUnspoilt;
    while (elapsed_ < seconds) {
      if (until_next <= 0.0 && left_ <= 0.0) {
        begin(kinds_[index(kinds_.size())]);
        until_next = left_ + uniform(kLeastPause, kMostPause);
      }
      const double dt = step();
      until_next -= dt;
      if (left_ > 0.0) left_ -= dt;
      if (left_ <= 0.0) fault_.clear();
      emit(images, records);
    }
  }

 private:
  double uniform(double low, double high) {  // std::uniform_real_distribution differs between libraries
    return low + (high - low) * static_cast<double>(random_()) / static_cast<double>(std::mt19937::max());
  }
  std::size_t index(std::size_t count) { return static_cast<std::size_t>(random_()) % count; }
  double duration(std::size_t last) const {
    return 1e-9 * static_cast<double>(recording_[last].mid_exposure_ns - recording_.front().mid_exposure_ns);
  }

  void begin(const std::string& kind) {
    fault_ = kind;
    left_ = uniform(0.1, 1.0);
    if (kind == "gap") left_ = uniform(0.05, 0.5);
    if (kind == "kidnap") {
      left_ = uniform(0.2, 2.0);
      forwards_ = !forwards_;
    }
    if (kind == "elsewhere") {
      left_ = uniform(1.0, 5.0);
      forwards_ = !forwards_;
    }
    if (kind == "forwards") jump_ns_ += static_cast<std::int64_t>(1e9 * uniform(0.5, 30.0));
    if (kind == "backwards") jump_ns_ -= static_cast<std::int64_t>(1e9 * uniform(0.05, 0.8));
    // A little off, so that no stamp comes twice.
    if (kind == "restart") jump_ns_ = 100000 * ++restarts_ - static_cast<std::int64_t>(1e9 * elapsed_);
    gain_ = std::exp(uniform(-std::log(8.0), std::log(8.0)));
  }

  /// To the next image; the time that passes [s].
  double step() {
    if (at_ + kTurningMargin >= recording_.size()) forwards_ = false;
    if (at_ < kTurningMargin) forwards_ = true;
    const std::size_t to = forwards_ ? at_ + 1 : at_ - 1;
    const std::int64_t passed = std::abs(recording_[to].mid_exposure_ns - recording_[at_].mid_exposure_ns);
    at_ = to;
    time_ns_ += passed;
    elapsed_ += 1e-9 * static_cast<double>(passed);
    return 1e-9 * static_cast<double>(passed);
  }

  /// In the recording: elsewhere is half of it away.
  const CameraImage& shown() const {
    const std::size_t half = recording_.size() / 2;
    return recording_[fault_ != "elsewhere" ? at_ : at_ < half ? at_ + half : at_ - half];
  }

  cv::Mat noise(double mean) {
    const cv::Mat& like = shown().image;
    cv::Mat image(like.size(), like.type());
    cv::RNG rng(random_());
    rng.fill(image, cv::RNG::NORMAL, mean, 1.0);
    return image;
  }

  cv::Mat spoiltImage() {
    const cv::Mat& image = shown().image;
    if (fault_ == "black") return cv::Mat::zeros(image.size(), image.type());
    if (fault_ == "saturated") return cv::Mat(image.size(), image.type(), cv::Scalar::all(255.0));
    if (fault_ == "covered" || fault_ == "kidnap") return noise(12.0);
    if (fault_ == "frozen" && !last_.empty()) return last_;
    if (fault_ == "unreadable") return {};
    if (fault_ == "brightness") {
      cv::Mat changed;
      image.convertTo(changed, image.type(), gain_);
      return changed;
    }
    return image;
  }

  void emit(std::vector<CameraImage>& images, std::vector<FaultRecord>& records) {
    if (fault_ == "gap") return;
    CameraImage image = shown();
    image.image = spoiltImage();
    if (!fault_.empty()) image.depth.release();  // that of another instant, or of nothing
    image.problem = image.image.empty() ? "spoilt" : "";
    if (!image.image.empty()) last_ = image.image;
    image.sequence = images.size();
    image.mid_exposure_ns = image.stamp_ns = time_ns_ + jump_ns_;
    if (fault_ == "exposure") {
      constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
      image.exposure = std::vector<double>{-1.0, kNotANumber, 100.0, 0.0}[index(4)];
    }
    records.push_back({image.sequence, image.stamp_ns, shown().mid_exposure_ns, fault_});
    images.push_back(std::move(image));
  }

  std::vector<CameraImage> recording_;
  std::mt19937 random_;
  std::vector<std::string> kinds_;
  std::size_t at_ = 0;  // in the recording
  bool forwards_ = true;
  std::int64_t time_ns_ = 0;
  std::int64_t jump_ns_ = 0;  // of the clock
  double elapsed_ = 0.0;      // [s]
  int restarts_ = 0;
  std::string fault_;  // now
  double left_ = 0.0;  // of it [s]
  double gain_ = 1.0;
  cv::Mat last_;
};

}  // namespace

const std::vector<std::string>& faultKinds() {
  static const std::vector<std::string> kKinds{"black",    "saturated", "covered",   "frozen",  "unreadable",
                                               "gap",      "forwards",  "backwards", "restart", "brightness",
                                               "exposure", "kidnap",    "elsewhere"};
  return kKinds;
}

FaultySequence::FaultySequence(SequenceReader& recording, const FaultConfig& config)
    : calibration_(recording.calibration()) {
  std::vector<CameraImage> all;
  while (std::optional<CameraImage> image = recording.next()) all.push_back(std::move(*image));
  Spoiler(std::move(all), config).run(images_, records_);
}

std::optional<CameraImage> FaultySequence::next() {
  if (next_ == images_.size()) return std::nullopt;
  return std::move(images_[next_++]);
}

void writeFaults(const std::vector<FaultRecord>& records, std::ostream& out) {
  out << "sequence,time,source_time,fault\n";
  for (const FaultRecord& record : records) {
    out << record.sequence << "," << formatSeconds(record.stamp_ns) << "," << formatSeconds(record.source_stamp_ns)
        << "," << record.fault << "\n";
  }
}

}  // namespace mba_vo
