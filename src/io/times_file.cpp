#include "mba_vo/io/times_file.h"

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace mba_vo {
namespace {

std::uint64_t parseId(const std::string& word, const std::string& where) {
  constexpr std::size_t kMostDigits = 18;
  bool digits = !word.empty() && word.size() <= kMostDigits;
  for (const char c : word) {
    digits = digits && std::isdigit(static_cast<unsigned char>(c)) != 0;
  }
  if (!digits) {
    throw std::runtime_error(where + ": image id '" + word + "' is not a whole number");
  }
  return std::stoull(word);
}

/// long double keeps nanoseconds of present-day times exactly, double does not.
long double parseNumber(const std::string& word, const char* what, const std::string& where) {
  char* end = nullptr;
  const long double value = std::strtold(word.c_str(), &end);
  if (word.empty() || *end != '\0') {
    throw std::runtime_error(where + ": " + what + " '" + word + "' is not a number");
  }
  return value;
}

std::int64_t parseTime(const std::string& word, const std::string& where) {
  constexpr long double kNanosecondsPerSecond = 1e9L;
  const long double nanoseconds = kNanosecondsPerSecond * parseNumber(word, "time", where);
  if (!(std::abs(nanoseconds) < static_cast<long double>(std::numeric_limits<std::int64_t>::max()))) {
    throw std::runtime_error(where + ": time '" + word + "' is out of range");
  }
  return std::llround(nanoseconds);
}

ImageTime parseLine(const std::vector<std::string>& words, const std::string& where) {
  if (words.size() < 2 || words.size() > 3) {
    throw std::runtime_error(where + ": " + std::to_string(words.size()) +
                             " columns; 'id time[s] exposure[ms]' is allowed");
  }
  ImageTime time;
  time.id = parseId(words[0], where);
  time.mid_exposure_ns = parseTime(words[1], where);
  if (words.size() == 3) {
    constexpr double kSecondsPerMillisecond = 1e-3;
    const auto exposure = static_cast<double>(parseNumber(words[2], "exposure", where));
    if (exposure != 0.0) {
      time.exposure = kSecondsPerMillisecond * exposure;
    }
  }
  return time;
}

}  // namespace

std::vector<ImageTime> readTimesFile(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw std::runtime_error(file + ": cannot be read");
  }
  std::vector<ImageTime> times;
  int line_number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++line_number;
    std::istringstream content(line.substr(0, line.find('#')));
    std::vector<std::string> words;
    for (std::string word; content >> word;) {
      words.push_back(word);
    }
    if (!words.empty()) {
      times.push_back(parseLine(words, file + ":" + std::to_string(line_number)));
    }
  }
  if (times.empty()) {
    throw std::runtime_error(file + ": lists no image");
  }
  return times;
}

}  // namespace mba_vo
