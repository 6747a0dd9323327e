#include <algorithm>
#include <cmath>
#include <utility>

#include "mba_vo/inspection/judgements.h"
#include "wording.h"

namespace mba_vo {
namespace {

constexpr double kLeastChange = 0.02;       // of the logarithm of the exposure, from image to image
constexpr std::size_t kFewestChanges = 10;  // images with such a change
constexpr double kMostSigma = 0.05;         // of the power
constexpr double kLeastPower = 0.3;         // a gamma of 3.3; below, the gain makes up for the exposure
constexpr double kMostPower = 1.2;          // no camera has more
constexpr double kLinear = 0.1;             // from 1, or
constexpr double kSureResponse = 4.0;       // standard deviations
constexpr int kRounds = 5;

struct BrightnessChange {
  double exposure, brightness;  // changes of their logarithms
};

std::vector<BrightnessChange> samplesOf(const CameraFacts& facts) {
  std::vector<BrightnessChange> samples;
  const std::vector<MatchedExposure> exposures = matchExposures(facts);
  for (std::size_t i = 1; i < exposures.size(); ++i) {
    const auto& motion = facts.images[i].motion;
    if (!motion || !motion->brighter || !(exposures[i].seconds > 0.0) || !(exposures[i - 1].seconds > 0.0)) continue;
    const double change = std::log(exposures[i].seconds / exposures[i - 1].seconds);
    if (std::isfinite(change) && std::abs(change) > kLeastChange) samples.push_back({change, *motion->brighter});
  }
  return samples;
}

}  // namespace

std::optional<ResponsePower> measureResponse(const CameraFacts& facts) {
  const std::vector<BrightnessChange> samples = samplesOf(facts);
  if (samples.size() < kFewestChanges) return std::nullopt;
  ResponsePower result;
  double scale = 1e9;  // of the errors; what is far beyond does not count
  for (int round = 0; round < kRounds; ++round) {
    double product = 0.0, information = 0.0, squares = 0.0, weights = 0.0;
    std::vector<double> errors;
    for (const BrightnessChange& s : samples) {
      const double error = s.brightness - result.power * s.exposure;
      const double weight = 1.0 / (1.0 + (error / scale) * (error / scale));
      errors.push_back(std::abs(error));
      product += weight * s.exposure * s.brightness;
      information += weight * s.exposure * s.exposure;
      squares += weight * error * error;
      weights += weight;
    }
    result = {product / information, std::sqrt(squares / weights / information)};
    scale = std::max(1e-9, 2.0 * quantile(std::move(errors), 0.5));
  }
  const bool plausible = result.power > kLeastPower && result.power < kMostPower;
  return plausible && result.sigma < kMostSigma ? std::optional(result) : std::nullopt;
}

bool isGamma(const std::optional<ResponsePower>& response) {
  return response && 1.0 - response->power > std::max(kLinear, kSureResponse * response->sigma);
}

std::vector<Finding> judgeResponse(const CameraFacts& facts) {
  if (facts.response_known) return {};
  const std::optional<ResponsePower> response = measureResponse(facts);
  if (isGamma(response)) {
    return {{Check::kGamma, "where the exposure changes, grey values grow with its power " +
                                number(response->power, 2) + ": a gamma of " + number(1.0 / response->power, 2) +
                                ", if the gain was fixed"}};
  }
  if (response || !facts.jpeg) return {};
  return {{Check::kGamma,
           "not known: exposures that are told and change would show it. Cameras that send JPEG mostly have a gamma of "
           "about 2.2; JPEG made of linear images have none"}};
}

}  // namespace mba_vo
