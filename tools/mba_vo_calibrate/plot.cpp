#include "plot.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <vector>

#include "mba_vo/evaluation/canvas.h"
#include "mba_vo/evaluation/trajectory_plot.h"

namespace {

constexpr int kColumns = 4;
constexpr double kPanelWidth = 340.0;  // [px], as the others
constexpr double kPanelHeight = 260.0;
constexpr double kLeft = 70.0;
constexpr double kRight = 15.0;
constexpr double kTop = 30.0;
constexpr double kBottom = 35.0;
constexpr double kText = 13.0;
constexpr int kTicks = 4;
constexpr int kCurvePoints = 50;
const mba_vo::Color kGrid{225, 225, 225};
const mba_vo::Color kBand{235, 160, 160};
const mba_vo::Color kFound{200, 30, 30};
const mba_vo::Color kTold{120, 120, 120};

/// A value with its standard deviation over x.
struct Sample {
  double x = 0.0;
  double value = 0.0;
  double sigma = 0.0;
};

struct Curve {
  std::string title;
  std::string axis;
  double told = 0.0;
  std::vector<Sample> samples;
};

class Panel {
 public:
  Panel(mba_vo::Canvas& canvas, int index, const Curve& curve)
      : canvas_(canvas),
        origin_(kPanelWidth * (index % kColumns) + kLeft, kPanelHeight * (index / kColumns) + kTop),
        left_(curve.samples.front().x),
        right_(std::max(curve.samples.back().x, left_ + 1e-9)),
        low_(curve.told),
        high_(curve.told) {
    // What little is known at first would leave no room for the rest.
    for (std::size_t i = curve.samples.size() / 4; i < curve.samples.size(); ++i) {
      low_ = std::min(low_, curve.samples[i].value - curve.samples[i].sigma);
      high_ = std::max(high_, curve.samples[i].value + curve.samples[i].sigma);
    }
    const double margin = std::max(0.08 * (high_ - low_), 1e-9);
    low_ -= margin;
    high_ += margin;
  }

  void draw(const Curve& curve) {
    for (const double tick : mba_vo::roundTicks(low_, high_, kTicks)) {
      canvas_.polyline({at(left_, tick), at(right_, tick)}, kGrid, 1.0);
      label(at(left_, tick) + Eigen::Vector2d(-5.0, 0.35 * kText), tick, mba_vo::TextAnchor::kEnd);
    }
    for (const double tick : mba_vo::roundTicks(left_, right_, kTicks)) {
      label(at(tick, low_) + Eigen::Vector2d(0.0, 1.3 * kText), tick, mba_vo::TextAnchor::kMiddle);
    }
    canvas_.text(origin_ + Eigen::Vector2d(0.0, -0.6 * kText), curve.title, mba_vo::TextAnchor::kStart, kText);
    canvas_.text(at(0.5 * (left_ + right_), low_) + Eigen::Vector2d(0.0, 2.4 * kText), curve.axis,
                 mba_vo::TextAnchor::kMiddle, 0.85 * kText);
    canvas_.polyline({at(left_, curve.told), at(right_, curve.told)}, kTold, 1.5);
    line(curve, -1.0, kBand, 1.5);
    line(curve, 1.0, kBand, 1.5);
    line(curve, 0.0, kFound, 2.0);
  }

 private:
  Eigen::Vector2d at(double x, double y) const {
    const double u = std::clamp((x - left_) / (right_ - left_), 0.0, 1.0);
    const double v = std::clamp((high_ - y) / (high_ - low_), 0.0, 1.0);
    return origin_ + Eigen::Vector2d(u * (kPanelWidth - kLeft - kRight), v * (kPanelHeight - kTop - kBottom - kText));
  }

  void label(const Eigen::Vector2d& position, double value, mba_vo::TextAnchor anchor) {
    std::ostringstream text;
    text << std::setprecision(6) << (std::abs(value) < 1e-12 ? 0.0 : value);
    canvas_.text(position, text.str(), anchor, 0.85 * kText);
  }

  void line(const Curve& curve, double sigmas, const mba_vo::Color& color, double width) {
    std::vector<Eigen::Vector2d> points;
    for (const Sample& s : curve.samples) points.push_back(at(s.x, s.value + sigmas * s.sigma));
    canvas_.polyline(points, color, width);
  }

  mba_vo::Canvas& canvas_;
  Eigen::Vector2d origin_;  // upper left [px]
  double left_, right_, low_, high_;
};

Curve vignetteCurve(const mba_vo::CalibrationEstimate& estimate) {
  Curve curve{"light [%] over the radius", "radius, 1 = corner", 100.0, {}};
  for (int i = 0; i <= kCurvePoints; ++i) {
    const double radius = static_cast<double>(i) / kCurvePoints;
    const auto [light, sigma] = mba_vo::lightAt(radius * radius, estimate);
    curve.samples.push_back({radius, 100.0 * light, 100.0 * sigma});
  }
  return curve;
}

std::vector<Curve> curvesOf(const mba_vo::ToldCamera& told, const mba_vo::CalibrationStudy& study) {
  std::vector<Curve> curves;
  for (std::size_t i = 0; i < study.growth.size(); ++i) {
    const std::vector<mba_vo::CalibratedNumber> numbers = calibratedNumbers(told, study.growth[i]);
    curves.resize(numbers.size());
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const mba_vo::CalibratedNumber& n = numbers[k];
      curves[k].title = n.name + (n.unit.empty() ? "" : " [" + n.unit + "]");
      curves[k].axis = "keyframes";
      curves[k].told = n.told;
      curves[k].samples.push_back({static_cast<double>(i + 1), n.found, n.sigma});
    }
  }
  if (told.image.vignette_file.empty()) curves.push_back(vignetteCurve(study.estimate));
  return curves;
}

}  // namespace

void plotCalibration(const std::string& file, const mba_vo::ToldCamera& told, const mba_vo::CalibrationStudy& study) {
  const std::vector<Curve> curves = curvesOf(told, study);
  const int rows = (static_cast<int>(curves.size()) + kColumns - 1) / kColumns;
  const auto canvas =
      mba_vo::makeCanvas(file, static_cast<int>(kColumns * kPanelWidth), static_cast<int>(rows * kPanelHeight));
  for (std::size_t i = 0; i < curves.size(); ++i) Panel(*canvas, static_cast<int>(i), curves[i]).draw(curves[i]);
  canvas->save();
}
