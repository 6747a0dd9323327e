#include "video_file.h"

#include <cmath>
#include <sstream>

#include <opencv2/videoio.hpp>

#include "mba_vo/capture/camera_source.h"

namespace mba_vo {
namespace {

constexpr double kLowestRate = 0.1, kHighestRate = 1000.0;  // that a file may claim [Hz]
constexpr double kLongestGap = 10.0;                        // that a file's times may have [s]

class VideoFile : public Recording {
 public:
  VideoFile(const std::string& file, double rate) : file_(file), own_times_(rate == 0.0) {
    open();
    const double own_rate = video_.get(cv::CAP_PROP_FPS);
    rate_ = own_times_ ? own_rate : rate;
    if (!(rate_ >= kLowestRate && rate_ <= kHighestRate)) {
      std::ostringstream text;
      text << file_ << ": the video says that it has " << own_rate << " Hz; tell its rate";
      throw CameraError(text.str());
    }
  }

  std::optional<RecordedImage> next() override {
    RecordedImage result;
    // The bytes belong to the decoder, which writes the next image there.
    cv::Mat image;
    if (!video_.read(image) || image.empty()) return std::nullopt;
    result.image = image.clone();
    const double since_first = 1e-3 * video_.get(cv::CAP_PROP_POS_MSEC);  // [s]
    const double step = since_first - last_own_time_;
    last_own_time_ = since_first;
    // Phones record at a rate that varies. Containers without times say nonsense, or always the same.
    const bool usable = own_times_ && count_ > 0 && step > 0.0 && step < kLongestGap;
    if (count_ > 0) time_ += usable ? step : 1.0 / rate_;
    ++count_;
    result.time_ns = std::llround(1e9 * time_);
    return result;
  }

  void rewind() override {
    open();
    count_ = 0;
    time_ = last_own_time_ = 0.0;
  }

  std::string description() const override {
    std::ostringstream text;
    text << file_ << ": video " << video_.get(cv::CAP_PROP_FRAME_WIDTH) << "x" << video_.get(cv::CAP_PROP_FRAME_HEIGHT)
         << " at " << rate_ << " Hz";
    return text.str();
  }

 private:
  void open() {
    // Other back ends print on the console what they cannot read.
    if (!video_.open(file_, cv::CAP_FFMPEG)) throw CameraError(file_ + ": not a video that FFmpeg can read");
  }

  std::string file_;
  bool own_times_;
  double rate_ = 0.0;  // [Hz]
  cv::VideoCapture video_;
  std::int64_t count_ = 0;
  double time_ = 0.0;           // of the last image, from the first [s]
  double last_own_time_ = 0.0;  // as the file told it [s]
};

}  // namespace

std::unique_ptr<Recording> openVideoFile(const std::string& file, double rate) {
  return std::make_unique<VideoFile>(file, rate);
}

}  // namespace mba_vo
