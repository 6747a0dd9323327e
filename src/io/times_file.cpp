#include "mba_vo/io/times_file.h"

#include <stdexcept>

#include "mba_vo/io/text_lines.h"

namespace mba_vo {
namespace {

ImageTime parseLine(const TextLine& line) {
  const std::vector<std::string>& words = line.words;
  if (words.size() < 2 || words.size() > 3) {
    throw std::runtime_error(line.where + ": " + std::to_string(words.size()) +
                             " columns; 'id time[s] exposure[ms]' is allowed");
  }
  ImageTime time;
  time.id = parseWhole(words[0], "image id", line.where);
  time.mid_exposure_ns = parseSeconds(words[1], line.where);
  if (words.size() == 3) {
    constexpr double kSeconds = 1e-3;  // per millisecond
    const double exposure = parseNumber(words[2], "exposure", line.where);
    if (exposure != 0.0) time.exposure = kSeconds * exposure;
  }
  return time;
}

}  // namespace

std::vector<ImageTime> readTimesFile(const std::string& file) {
  std::vector<ImageTime> times;
  for (const TextLine& line : splitLines(readText(file), file)) times.push_back(parseLine(line));
  if (times.empty()) throw std::runtime_error(file + ": lists no image");
  return times;
}

}  // namespace mba_vo
