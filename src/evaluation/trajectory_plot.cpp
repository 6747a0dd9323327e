#include "mba_vo/evaluation/trajectory_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <sstream>

#include "mba_vo/evaluation/canvas.h"

namespace mba_vo {
namespace {

constexpr int kWidth = 1200;          // [px]
constexpr int kHeight = 660;          // [px]
constexpr double kTextHeight = 15.0;  // [px]
constexpr double kTick = 5.0;         // [px]
const Color kBlack{0, 0, 0};
const Color kGrid{225, 225, 225};
const Color kTruthColor{120, 120, 120};
const std::array<Color, 2> kEstimateColors{Color{200, 30, 30}, Color{30, 90, 200}};
constexpr double kEstimateWidth = 1.5;  // [px]
constexpr const char* kAxisNames[] = {"x", "y", "z"};

/// Which axes of the ground-truth frame a view shows; sign -1 turns an axis round.
struct View {
  std::string title;
  int horizontal = 0;
  int vertical = 1;
  double vertical_sign = 1.0;

  Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return {p(horizontal), vertical_sign * p(vertical)}; }
};

/// Rectangle of the sheet [px] with the coordinates [m] it shows.
struct Panel {
  Eigen::Vector2d top_left;  // [px]
  double size = 0.0;         // [px]
  Eigen::Vector2d center;    // [m]
  double extent = 1.0;       // [m]

  Eigen::Vector2d toSheet(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d unit = (p - center) / extent + Eigen::Vector2d::Constant(0.5);
    return top_left + size * Eigen::Vector2d(unit.x(), 1.0 - unit.y());
  }
};

using Curve = std::vector<Eigen::Vector3d>;

std::string tickLabel(double value) {
  std::ostringstream text;
  text << std::setprecision(6) << (value == 0.0 ? 0.0 : value);
  return text.str();
}

std::pair<View, View> chooseViews(const std::vector<PoseRecord>& groundtruth, const Curve& truth) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const PoseRecord& record : groundtruth) {
    up -= record.T_world_camera.rotationMatrix().col(1);  // y of the optical frame points down
  }
  int up_axis = 0;
  up.cwiseAbs().maxCoeff(&up_axis);
  Eigen::Vector3d low = truth.front();
  Eigen::Vector3d high = truth.front();
  for (const Eigen::Vector3d& p : truth) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const int first = (up_axis + 1) % 3;
  const int second = (up_axis + 2) % 3;
  const int longer = (high - low)(first) >= (high - low)(second) ? first : second;
  const double up_sign = up(up_axis) < 0.0 ? -1.0 : 1.0;
  return {View{"from above", first, second, up_sign}, View{"from the side", longer, up_axis, up_sign}};
}

Panel makePanel(const View& view, const std::vector<const Curve*>& curves, const Eigen::Vector2d& top_left,
                double size) {
  Eigen::Vector2d low = view(curves.front()->front());
  Eigen::Vector2d high = low;
  for (const Curve* curve : curves) {
    for (const Eigen::Vector3d& p : *curve) {
      low = low.cwiseMin(view(p));
      high = high.cwiseMax(view(p));
    }
  }
  constexpr double kMargin = 1.1;
  constexpr double kLeastExtent = 1e-6;  // [m]
  return {top_left, size, 0.5 * (low + high), std::max(kMargin * (high - low).maxCoeff(), kLeastExtent)};
}

void drawAxes(Canvas& canvas, const Panel& panel, const View& view) {
  const Eigen::Vector2d low = panel.center - Eigen::Vector2d::Constant(0.5 * panel.extent);
  const Eigen::Vector2d high = panel.center + Eigen::Vector2d::Constant(0.5 * panel.extent);
  constexpr int kTicks = 6;
  for (const double x : roundTicks(low.x(), high.x(), kTicks)) {
    const Eigen::Vector2d foot = panel.toSheet({x, low.y()});
    canvas.polyline({foot, panel.toSheet({x, high.y()})}, kGrid, 1.0);
    canvas.polyline({foot, foot + Eigen::Vector2d(0.0, kTick)}, kBlack, 1.0);
    canvas.text(foot + Eigen::Vector2d(0.0, kTick + kTextHeight), tickLabel(x), TextAnchor::kMiddle, kTextHeight);
  }
  for (const double y : roundTicks(low.y(), high.y(), kTicks)) {
    const Eigen::Vector2d foot = panel.toSheet({low.x(), y});
    canvas.polyline({foot, panel.toSheet({high.x(), y})}, kGrid, 1.0);
    canvas.polyline({foot, foot - Eigen::Vector2d(kTick, 0.0)}, kBlack, 1.0);
    canvas.text(foot + Eigen::Vector2d(-kTick - 3.0, 0.35 * kTextHeight), tickLabel(view.vertical_sign * y),
                TextAnchor::kEnd, kTextHeight);
  }
  canvas.polyline({panel.toSheet(low), panel.toSheet({high.x(), low.y()}), panel.toSheet(high),
                   panel.toSheet({low.x(), high.y()}), panel.toSheet(low)},
                  kBlack, 1.0);
  const Eigen::Vector2d top = panel.toSheet({panel.center.x(), high.y()});
  canvas.text(top - Eigen::Vector2d(0.0, 0.6 * kTextHeight), view.title, TextAnchor::kMiddle, kTextHeight);
  canvas.text(panel.toSheet({panel.center.x(), low.y()}) + Eigen::Vector2d(0.0, 2.0 * kTextHeight + 2.0 * kTick),
              std::string(kAxisNames[view.horizontal]) + " [m]", TextAnchor::kMiddle, kTextHeight);
  canvas.text(panel.toSheet({low.x(), high.y()}) - Eigen::Vector2d(0.0, 0.6 * kTextHeight),
              std::string(kAxisNames[view.vertical]) + " [m]", TextAnchor::kMiddle, kTextHeight);
}

void drawCurve(Canvas& canvas, const Panel& panel, const View& view, const Curve& curve, const Color& color,
               double width) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(curve.size());
  for (const Eigen::Vector3d& p : curve) {
    points.push_back(panel.toSheet(view(p)));
  }
  canvas.polyline(points, color, width);
}

/// Joins only poses with no dropped frame between them, so that gaps stay visible.
std::vector<Curve> estimateCurves(const EvaluationReport& report) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < report.pairs.size(); ++i) {
    steps.push_back(report.pairs[i].time - report.pairs[i - 1].time);
  }
  constexpr double kGap = 1.5;  // times the usual step
  const double longest_step = kGap * summarize(steps).median;
  std::vector<Curve> curves(1);
  for (std::size_t i = 0; i < report.pairs.size(); ++i) {
    if (i > 0 && steps[i - 1] > longest_step) {
      curves.emplace_back();
    }
    curves.back().push_back(report.pairs[i].estimate.translation());
  }
  return curves;
}

std::string labelOf(const PlottedEstimate& estimate) {
  const EvaluationReport& report = *estimate.report;
  std::ostringstream label;
  label << estimate.name << ", aligned (" << (report.mode == AlignmentMode::kSim3 ? "sim3" : "se3") << ", ATE "
        << std::setprecision(3) << report.absolute.rmse << " m rms, " << report.drops.dropped << " of "
        << report.drops.frames << " frames dropped)";
  return label.str();
}

void drawLegend(Canvas& canvas, const std::vector<PlottedEstimate>& estimates) {
  constexpr double kBaseline = 22.0;  // [px]
  const auto entry = [&](double x, double y, const Color& color, double width, const std::string& label) {
    const double line_y = y - 0.35 * kTextHeight;
    canvas.polyline({{x, line_y}, {x + 40.0, line_y}}, color, width);
    canvas.text({x + 48.0, y}, label, TextAnchor::kStart, kTextHeight);
  };
  entry(70.0, kBaseline, kTruthColor, 3.0, "ground truth");
  double baseline = kBaseline;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    entry(260.0, baseline, kEstimateColors[i % kEstimateColors.size()], kEstimateWidth, labelOf(estimates[i]));
    baseline += 1.3 * kTextHeight;
  }
}

}  // namespace

std::vector<double> roundTicks(double low, double high, int count) {
  const double rough = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double fraction = rough / power;
  const double step = power * (fraction <= 1.5 ? 1.0 : fraction <= 3.5 ? 2.0 : fraction <= 7.5 ? 5.0 : 10.0);
  std::vector<double> ticks;
  for (double k = std::ceil(low / step); k * step <= high; k += 1.0) {
    ticks.push_back(k * step);
  }
  return ticks;
}

void plotTrajectories(const std::string& file, const std::vector<PoseRecord>& groundtruth,
                      const std::vector<PlottedEstimate>& estimates) {
  const std::unique_ptr<Canvas> canvas = makeCanvas(file, kWidth, kHeight);
  Curve truth;
  for (const PoseRecord& record : groundtruth) {
    truth.push_back(record.T_world_camera.translation());
  }
  std::vector<std::vector<Curve>> pieces;  // of each estimate
  for (const PlottedEstimate& estimate : estimates) {
    pieces.push_back(estimateCurves(*estimate.report));
  }
  std::vector<const Curve*> all{&truth};
  for (const std::vector<Curve>& curves : pieces) {
    std::transform(curves.begin(), curves.end(), std::back_inserter(all), [](const Curve& curve) { return &curve; });
  }
  drawLegend(*canvas, estimates);
  const auto [above, side] = chooseViews(groundtruth, truth);
  constexpr double kPanelSize = 510.0;  // [px]
  double left = 70.0;                   // [px]
  for (const View& view : {above, side}) {
    const Panel panel = makePanel(view, all, {left, 75.0}, kPanelSize);
    drawAxes(*canvas, panel, view);
    drawCurve(*canvas, panel, view, truth, kTruthColor, 3.0);
    for (std::size_t i = pieces.size(); i-- > 0;) {  // the first on top
      for (const Curve& curve : pieces[i]) {
        drawCurve(*canvas, panel, view, curve, kEstimateColors[i % kEstimateColors.size()], kEstimateWidth);
      }
    }
    left += kPanelSize + 90.0;
  }
  canvas->save();
}

void plotTrajectory(const std::string& file, const std::vector<PoseRecord>& groundtruth,
                    const EvaluationReport& report) {
  plotTrajectories(file, groundtruth, {{"estimate", &report}});
}

}  // namespace mba_vo
