#include "mba_vo/simulation/texture_painter.h"

#include <algorithm>
#include <cmath>

#include "mba_vo/simulation/texture_strokes.h"

namespace mba_vo {
namespace {

/// Scales the deviations from the mean to the given standard deviation and moves the mean.
cv::Mat1f normalised(const cv::Mat1f& image, double mean, double deviation) {
  cv::Scalar old_mean, old_deviation;
  cv::meanStdDev(image, old_mean, old_deviation);
  const double factor = deviation / std::max(old_deviation[0], 1e-6);
  cv::Mat1f out;
  image.convertTo(out, CV_32F, factor, mean - factor * old_mean[0]);
  return out;
}

cv::Mat1f withNoise(const cv::Mat1f& image, double strength, const cv::Mat1f& noise) {
  cv::Mat1f sum;
  cv::scaleAdd(noise, strength, image, sum);
  return sum;
}

cv::Mat1f paintPlaster(int side, cv::RNG& random) {
  return normalised(fractalNoise(side, {12, 12}, 4, 0.8, random), 0.62, 0.022);
}

cv::Mat1f paintWood(int side, cv::RNG& random) {
  const cv::Mat1f bend = fractalNoise(side, {2, 3}, 3, 0.5, random);
  const cv::Mat1f fibre = fractalNoise(side, {4, 48}, 3, 0.7, random);
  const int rings = random.uniform(6, 11);
  cv::Mat1f wood(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double phase = 2.0 * CV_PI * (rings * static_cast<double>(y) / side + 1.8 * bend(y, x));
      const double ring = std::sin(phase) + 0.4 * std::sin(2.0 * phase + 1.0);
      wood(y, x) = static_cast<float>(0.42 + 0.09 * ring + 0.13 * fibre(y, x));
    }
  }
  Canvas canvas(wood);
  for (int plank = 0; plank < 4; ++plank) {  // the gaps between planks and their shifted ends
    canvas.line({0.0, 0.25 * plank}, {1.0, 0.25 * plank}, 0.006, 0.12);
    const double end = random.uniform(0.0, 1.0);
    canvas.line({end, 0.25 * plank}, {end, 0.25 * (plank + 1)}, 0.005, 0.14);
  }
  return canvas.image();
}

cv::Mat1f paintFabric(int side, cv::RNG& random) {
  const cv::Mat1f folds = fractalNoise(side, {5, 5}, 5, 0.65, random);
  const int threads = random.uniform(24, 40);
  // Bands of uneven widths and tones: even ones would look alike from one to the next.
  const cv::Mat1f bands_x = fractalNoise(side, {13, 1}, 2, 0.6, random);
  const cv::Mat1f bands_y = fractalNoise(side, {11, 1}, 2, 0.6, random);
  cv::Mat1f fabric(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double u = static_cast<double>(x) / side;
      const double v = static_cast<double>(y) / side;
      const double weave = std::sin(2.0 * CV_PI * threads * u) * std::sin(2.0 * CV_PI * threads * v);
      const double band =
          std::tanh(2.5 * static_cast<double>(bands_x(0, x))) + std::tanh(2.5 * static_cast<double>(bands_y(0, y)));
      fabric(y, x) = static_cast<float>(0.45 + 0.06 * weave + 0.11 * band + 0.12 * folds(y, x));
    }
  }
  return fabric;
}

/// Rows of blocks with mortar between; `shift` moves every other row by half a block.
cv::Mat1f paintMasonry(int side, int columns, int rows, double shift, double mortar_tone, cv::RNG& random) {
  Canvas canvas(side, mortar_tone);
  const double gap = 0.012;
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < columns; ++col) {
      const double x = (col + (row % 2 == 0 ? 0.0 : shift)) / columns;
      const double y = static_cast<double>(row) / rows;
      const double tone = random.uniform(0.25, 0.7);
      for (const double wrap : {0.0, -1.0}) {
        canvas.rectangle({x + gap + wrap, y + gap}, {x + 1.0 / columns + wrap, y + 1.0 / rows}, tone);
      }
    }
  }
  return withNoise(canvas.image(), 0.09, fractalNoise(side, {10, 10}, 5, 0.8, random));
}

cv::Mat1f paintStone(int side, cv::RNG& random) {
  Canvas canvas(side, random.uniform(0.3, 0.6));
  for (int chip = 0; chip < 420; ++chip) {
    const cv::Point2d center(random.uniform(0.0, 1.0), random.uniform(0.0, 1.0));
    canvas.wrappedPolygon(center, random.uniform(0.008, 0.05), random.uniform(3, 7), random.uniform(0.1, 0.95), random);
  }
  return withNoise(canvas.image(), 0.06, fractalNoise(side, {6, 6}, 5, 0.8, random));
}

cv::Mat1f paintCarpet(int side, cv::RNG& random) {
  Canvas canvas(side, 0.35);
  const int cells = random.uniform(3, 6);
  const double pitch = 1.0 / cells;
  const double tones[3] = {random.uniform(0.15, 0.3), random.uniform(0.55, 0.75), random.uniform(0.75, 0.95)};
  for (int row = 0; row < cells; ++row) {
    for (int col = 0; col < cells; ++col) {
      const cv::Point2d center((col + 0.5) * pitch, (row + 0.5) * pitch);
      canvas.regularPolygon(center, 0.48 * pitch, 4, 0.0, tones[(row + col) % 2]);
      canvas.regularPolygon(center, 0.33 * pitch, 8, 0.2, tones[2]);
      canvas.regularPolygon(center, 0.20 * pitch, 3 + (row * cells + col) % 4, random.uniform(0.0, 3.0), tones[0]);
    }
  }
  return withNoise(canvas.image(), 0.12, fractalNoise(side, {40, 40}, 3, 0.9, random));
}

cv::Mat1f paintPage(int side, cv::RNG& random) {
  Canvas canvas(side, 0.88);
  canvas.writeText({0.06, 0.05}, {0.94, 0.12}, 0.05, 0.12, random);
  for (int paragraph = 0; paragraph < 2; ++paragraph) {
    canvas.writeText({0.06, 0.16 + 0.42 * paragraph}, {0.48, 0.54 + 0.42 * paragraph}, 0.022, 0.18, random);
  }
  canvas.writeText({0.54, 0.52}, {0.95, 0.95}, 0.022, 0.18, random);
  canvas.paintPicture({0.54, 0.16}, {0.95, 0.48}, random);
  return withNoise(canvas.image(), 0.02, fractalNoise(side, {8, 8}, 4, 0.8, random));
}

cv::Mat1f paintBooks(int side, cv::RNG& random) {
  Canvas canvas(side, 0.06);
  double x = 0.0;
  while (x < 0.97) {
    const double width = std::min(random.uniform(0.025, 0.085), 1.0 - x);
    const double top = random.uniform(0.0, 0.22);
    const double tone = random.uniform(0.12, 0.9);
    const double ink = tone > 0.5 ? random.uniform(0.05, 0.25) : random.uniform(0.7, 0.95);
    canvas.rectangle({x + 0.003, top}, {x + width - 0.003, 1.0}, tone);
    canvas.rectangle({x + 0.003, top + 0.06}, {x + width - 0.003, top + 0.075}, ink);
    canvas.rectangle({x + 0.003, 0.86}, {x + width - 0.003, 0.88}, ink);
    canvas.writeSpine({x + 0.5 * width, top + 0.12}, random.uniform(0.3, 0.5), 0.45 * width, ink, random);
    x += width;
  }
  return withNoise(canvas.image(), 0.025, fractalNoise(side, {12, 6}, 4, 0.8, random));
}

cv::Mat1f paintPanel(int side, cv::RNG& random) {
  Canvas canvas(side, random.uniform(0.2, 0.35));
  const int cells = random.uniform(5, 9);
  for (int row = 0; row < cells; ++row) {
    for (int col = 0; col < cells; ++col) {
      const cv::Point2d from((col + 0.12) / cells, (row + 0.12) / cells);
      const cv::Point2d to((col + 0.88) / cells, (row + 0.88) / cells);
      canvas.rectangle(from, to, random.uniform(0.4, 0.9));
      canvas.writeText(from + (to - from) * 0.2, from + (to - from) * 0.8, 0.3 / cells, 0.1, random);
    }
  }
  return withNoise(canvas.image(), 0.03, fractalNoise(side, {6, 6}, 5, 0.8, random));
}

cv::Mat1f paintPoster(int side, cv::RNG& random) {
  Canvas canvas(side, 0.9);
  canvas.rectangle({0.0, 0.0}, {1.0, 1.0}, random.uniform(0.05, 0.9));
  canvas.paintPicture({0.04, 0.04}, {0.96, random.uniform(0.8, 0.96)}, random);
  canvas.writeText({0.1, 0.86}, {0.9, 0.95}, 0.055, random.uniform(0.0, 1.0), random);
  return withNoise(canvas.image(), 0.04, fractalNoise(side, {16, 16}, 5, 0.8, random));
}

cv::Mat1f paint(Pattern pattern, int side, cv::RNG& random) {
  switch (pattern) {
    case Pattern::kPlaster:
      return paintPlaster(side, random);
    case Pattern::kWood:
      return paintWood(side, random);
    case Pattern::kFabric:
      return paintFabric(side, random);
    case Pattern::kBricks:
      return paintMasonry(side, 4, 12, 0.5, 0.62, random);
    case Pattern::kTiles:
      return paintMasonry(side, 5, 5, 0.0, 0.8, random);
    case Pattern::kStone:
      return paintStone(side, random);
    case Pattern::kCarpet:
      return paintCarpet(side, random);
    case Pattern::kPage:
      return paintPage(side, random);
    case Pattern::kBooks:
      return paintBooks(side, random);
    case Pattern::kPanel:
      return paintPanel(side, random);
    case Pattern::kPicture:
      return paintPoster(side, random);
  }
  return paintPlaster(side, random);
}

}  // namespace

cv::Mat1f paintPattern(Pattern pattern, int side, cv::RNG& random) {
  cv::Mat1f image = paint(pattern, side, random);
  for (float& value : image) value = std::clamp(value, 0.02F, 0.98F);
  return image;
}

}  // namespace mba_vo
