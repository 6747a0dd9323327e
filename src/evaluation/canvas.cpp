#include "mba_vo/evaluation/canvas.h"

#include <cerrno>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace mba_vo {
namespace {

bool endsWith(const std::string& text, const std::string& ending) {
  return text.size() > ending.size() && text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

/// With the reason that the system gives.
void write(const std::string& file, const std::string& content) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  stream << content;
  if (!stream.flush()) {
    const int reason = errno;
    throw std::runtime_error(file + ": cannot be written" +
                             (reason == 0 ? "" : ": " + std::generic_category().message(reason)));
  }
}

class PngCanvas : public Canvas {
 public:
  PngCanvas(std::string file, int width, int height)
      : file_(std::move(file)), image_(height, width, CV_8UC3, cv::Scalar::all(255)) {}

  void polyline(const std::vector<Eigen::Vector2d>& points, const Color& color, double width) override {
    constexpr int kFractionBits = 4;
    std::vector<cv::Point> vertices;
    vertices.reserve(points.size());
    for (const Eigen::Vector2d& p : points) {
      vertices.emplace_back(cvRound(p.x() * (1 << kFractionBits)), cvRound(p.y() * (1 << kFractionBits)));
    }
    cv::polylines(image_, vertices, false, cv::Scalar(color.blue, color.green, color.red), std::max(1, cvRound(width)),
                  cv::LINE_AA, kFractionBits);
  }

  void text(const Eigen::Vector2d& position, const std::string& text, TextAnchor anchor, double height) override {
    constexpr double kFontHeight = 30.0;  // of FONT_HERSHEY_SIMPLEX at scale 1, capitals and descenders [px]
    const double scale = height / kFontHeight;
    int baseline = 0;
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &baseline);
    const double shift = anchor == TextAnchor::kStart ? 0.0 : anchor == TextAnchor::kMiddle ? 0.5 : 1.0;
    const cv::Point origin(cvRound(position.x() - shift * size.width), cvRound(position.y()));
    cv::putText(image_, text, origin, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar::all(0), 1, cv::LINE_AA);
  }

  void save() const override {
    std::vector<unsigned char> png;
    cv::imencode(".png", image_, png);
    write(file_, {png.begin(), png.end()});
  }

 private:
  std::string file_;
  cv::Mat image_;
};

std::string escapeXml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return escaped;
}

class SvgCanvas : public Canvas {
 public:
  SvgCanvas(std::string file, int width, int height) : file_(std::move(file)) {
    body_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height
          << "\" viewBox=\"0 0 " << width << " " << height << "\">\n"
          << "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  }

  void polyline(const std::vector<Eigen::Vector2d>& points, const Color& color, double width) override {
    body_ << "<polyline fill=\"none\" stroke=\"rgb(" << color.red << "," << color.green << "," << color.blue
          << ")\" stroke-width=\"" << width << "\" stroke-linejoin=\"round\" points=\"";
    for (const Eigen::Vector2d& p : points) {
      body_ << p.x() << "," << p.y() << " ";
    }
    body_ << "\"/>\n";
  }

  void text(const Eigen::Vector2d& position, const std::string& text, TextAnchor anchor, double height) override {
    const char* name = anchor == TextAnchor::kStart ? "start" : anchor == TextAnchor::kMiddle ? "middle" : "end";
    body_ << "<text x=\"" << position.x() << "\" y=\"" << position.y() << "\" text-anchor=\"" << name
          << "\" font-family=\"sans-serif\" font-size=\"" << height << "\">" << escapeXml(text) << "</text>\n";
  }

  void save() const override { write(file_, body_.str() + "</svg>\n"); }

 private:
  std::string file_;
  std::ostringstream body_;
};

}  // namespace

std::unique_ptr<Canvas> makeCanvas(const std::string& file, int width, int height) {
  if (endsWith(file, ".png")) {
    return std::make_unique<PngCanvas>(file, width, height);
  }
  if (endsWith(file, ".svg")) {
    return std::make_unique<SvgCanvas>(file, width, height);
  }
  throw std::invalid_argument("plot file '" + file + "': must end in .png or .svg");
}

}  // namespace mba_vo
