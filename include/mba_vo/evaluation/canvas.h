#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace mba_vo {

struct Color {
  int red = 0;  // 0..255, as the others
  int green = 0;
  int blue = 0;
};

enum class TextAnchor { kStart, kMiddle, kEnd };

/// A sheet to draw on. Coordinates [px], x right, y down.
class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void polyline(const std::vector<Eigen::Vector2d>& points, const Color& color, double width) = 0;
  /// `position` is on the baseline of the text.
  virtual void text(const Eigen::Vector2d& position, const std::string& text, TextAnchor anchor, double height) = 0;
  /// Throws std::runtime_error naming the file if it cannot be written.
  virtual void save() const = 0;
};

/// A canvas that is saved as `file`, a .png (pixels) or .svg (vectors); std::invalid_argument for any other ending.
std::unique_ptr<Canvas> makeCanvas(const std::string& file, int width, int height);

}  // namespace mba_vo
