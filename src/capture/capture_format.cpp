#include "mba_vo/capture/capture_format.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <tuple>

namespace mba_vo {
namespace {

// Enough for the odometry, and what nearly every camera can do.
constexpr int kUsualWidth = 640, kUsualHeight = 480;  // [px]
constexpr double kUsualRate = 30.0;                   // [Hz]
constexpr double kSameRate = 0.01;                    // 30 and 29.97 Hz are the same, relative

/// The name in the parameters; nullptr for formats that are not read.
const char* nameOf(std::uint32_t fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_GREY:
      return "grey";
    case V4L2_PIX_FMT_YUYV:
      return "yuyv";
    case V4L2_PIX_FMT_MJPEG:
    case V4L2_PIX_FMT_JPEG:
      return "mjpeg";
    default:
      return nullptr;
  }
}

/// Without loss before with loss, small before large.
int rankOf(std::uint32_t fourcc) {
  if (fourcc == V4L2_PIX_FMT_GREY) return 0;
  return fourcc == V4L2_PIX_FMT_YUYV ? 1 : 2;
}

std::string fourccText(std::uint32_t fourcc) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) text += static_cast<char>((fourcc >> shift) & 0x7fU);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::string sizeText(const SizeRange& size) {
  std::ostringstream text;
  text << size.min_width << "x" << size.min_height;
  if (size.max_width > size.min_width || size.max_height > size.min_height) {
    text << " to " << size.max_width << "x" << size.max_height << " in steps of " << size.step_width << "x"
         << size.step_height;
  }
  return text.str();
}

std::string ratesText(const std::vector<RateRange>& rates) {
  std::ostringstream text;
  for (const RateRange& rate : rates) {
    text << (text.tellp() > 0 ? ", " : "") << rate.min;
    if (rate.max > rate.min) text << " to " << rate.max;
  }
  return rates.empty() ? "rates not told" : text.str() + " Hz";
}

int fit(int wanted, int min, int max, int step) {
  const int steps = (std::clamp(wanted, min, max) - min) / std::max(step, 1);
  return min + steps * std::max(step, 1);
}

bool has(const SizeRange& size, int width, int height) {
  return fit(width, size.min_width, size.max_width, size.step_width) == width &&
         fit(height, size.min_height, size.max_height, size.step_height) == height;
}

double logRatio(double a, double b) { return std::abs(std::log(a / b)); }

/// Of the offered rates the one next to `wanted`; 0 where none is told.
double nearestRate(const std::vector<RateRange>& rates, double wanted) {
  double best = 0.0;
  for (const RateRange& range : rates) {
    const double rate = std::clamp(wanted, range.min, range.max);
    if (best == 0.0 || logRatio(rate, wanted) < logRatio(best, wanted)) best = rate;
  }
  return best;
}

[[noreturn]] void refuse(const std::string& wanted, const std::vector<OfferedFormat>& offered) {
  throw std::invalid_argument(wanted + "; it offers\n" + describe(offered));
}

std::vector<OfferedFormat> withPixelFormat(const std::vector<OfferedFormat>& offered, const std::string& name) {
  if (name != "auto" && name != "grey" && name != "yuyv" && name != "mjpeg") {
    throw std::invalid_argument("pixel_format is '" + name + "'; allowed: auto, mjpeg, yuyv, grey");
  }
  std::vector<OfferedFormat> fitting;
  for (const OfferedFormat& format : offered) {
    const char* const its_name = nameOf(format.fourcc);
    if (its_name != nullptr && (name == "auto" || name == its_name)) fitting.push_back(format);
  }
  if (fitting.empty()) {
    refuse(name == "auto" ? "it has none of the pixel formats mjpeg, yuyv, grey" : "it has no pixel_format " + name,
           offered);
  }
  return fitting;
}

std::vector<OfferedFormat> withSize(const std::vector<OfferedFormat>& offered, const FormatRequest& request) {
  if ((request.width == 0) != (request.height == 0)) {
    throw std::invalid_argument("width is " + std::to_string(request.width) + " and height " +
                                std::to_string(request.height) + "; tell both, or none (0)");
  }
  std::vector<OfferedFormat> fitting;
  for (const OfferedFormat& format : offered) {
    if (request.width == 0 || has(format.size, request.width, request.height)) fitting.push_back(format);
  }
  if (fitting.empty()) {
    refuse("it has no images of " + std::to_string(request.width) + "x" + std::to_string(request.height), offered);
  }
  return fitting;
}

std::vector<OfferedFormat> withRate(const std::vector<OfferedFormat>& offered, double rate) {
  std::vector<OfferedFormat> fitting;
  for (const OfferedFormat& format : offered) {
    const double nearest = nearestRate(format.rates, rate);
    if (rate == 0.0 || nearest == 0.0 || logRatio(nearest, rate) < kSameRate) fitting.push_back(format);
  }
  if (fitting.empty()) {
    std::ostringstream wanted;
    wanted << "it has no rate of " << rate << " Hz there";
    refuse(wanted.str(), offered);
  }
  return fitting;
}

}  // namespace

CaptureFormat chooseFormat(const std::vector<OfferedFormat>& offered, const FormatRequest& request) {
  const std::vector<OfferedFormat> fitting =
      withRate(withSize(withPixelFormat(offered, request.pixel_format), request), request.rate);
  const int width = request.width > 0 ? request.width : kUsualWidth;
  const int height = request.height > 0 ? request.height : kUsualHeight;
  const double rate = request.rate > 0.0 ? request.rate : kUsualRate;
  CaptureFormat best;
  constexpr double kFar = std::numeric_limits<double>::max();
  auto best_cost = std::make_tuple(kFar, kFar, 0);
  for (const OfferedFormat& format : fitting) {
    const SizeRange& size = format.size;
    CaptureFormat chosen;
    chosen.fourcc = format.fourcc;
    chosen.width = fit(width, size.min_width, size.max_width, size.step_width);
    chosen.height = fit(height, size.min_height, size.max_height, size.step_height);
    chosen.rate = nearestRate(format.rates, rate);
    const auto cost = std::make_tuple(logRatio(chosen.width, width) + logRatio(chosen.height, height),
                                      chosen.rate > 0.0 ? logRatio(chosen.rate, rate) : 0.0, rankOf(chosen.fourcc));
    if (cost < best_cost) {
      best_cost = cost;
      best = chosen;
    }
  }
  return best;
}

std::string describe(const std::vector<OfferedFormat>& offered) {
  std::ostringstream text;
  for (const OfferedFormat& format : offered) {
    const char* const name = nameOf(format.fourcc);
    text << "  " << (name != nullptr ? name : "(" + fourccText(format.fourcc) + ")") << " " << sizeText(format.size)
         << ": " << ratesText(format.rates) << "\n";
  }
  return offered.empty() ? "  no format at all\n" : text.str();
}

std::string describe(const CaptureFormat& format) {
  const char* const name = nameOf(format.fourcc);
  std::ostringstream text;
  text << (name != nullptr ? name : fourccText(format.fourcc)) << " " << format.width << "x" << format.height;
  if (format.rate > 0.0) text << " at " << format.rate << " Hz";
  return text.str();
}

}  // namespace mba_vo
