#include "mba_vo/io/text_lines.h"

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace mba_vo {
namespace {

/// long double keeps nanoseconds of present-day times exactly, double does not.
long double parseLong(const std::string& word, const std::string& what, const std::string& where) {
  char* end = nullptr;
  const long double value = std::strtold(word.c_str(), &end);
  if (word.empty() || *end != '\0') throw std::runtime_error(where + ": " + what + " '" + word + "' is not a number");
  return value;
}

std::vector<std::string> splitWords(const std::string& line, const std::string& separators) {
  std::vector<std::string> words;
  std::size_t begin = line.find_first_not_of(separators);
  while (begin != std::string::npos) {
    const std::size_t end = line.find_first_of(separators, begin);
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
  return words;
}

}  // namespace

std::string readText(const std::string& file, std::size_t most_bytes) {
  std::error_code error;
  const std::uintmax_t size =
      std::filesystem::is_regular_file(file, error) ? std::filesystem::file_size(file, error) : 0;
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream || !std::filesystem::is_regular_file(file, error)) {
    throw std::runtime_error(file + ": cannot be read");
  }
  if (size == 0) throw std::runtime_error(file + ": is empty");
  if (size > most_bytes) {
    throw std::runtime_error(file + ": has " + std::to_string(size) + " bytes, at most " + std::to_string(most_bytes) +
                             " are expected of such a file");
  }
  std::ostringstream text;
  text << stream.rdbuf();
  if (text.str().find('\0') != std::string::npos) throw std::runtime_error(file + ": is no text file");
  return text.str();
}

std::vector<TextLine> splitLines(const std::string& text, const std::string& file, const std::string& separators) {
  std::vector<TextLine> lines;
  std::istringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    std::vector<std::string> words = splitWords(line.substr(0, line.find('#')), separators);
    if (!words.empty()) lines.push_back({std::move(words), file + ":" + std::to_string(number)});
  }
  return lines;
}

std::string joinWords(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

bool beginsNumber(const std::string& word) { return word.find_first_of("0123456789+-.") == 0; }

double parseNumber(const std::string& word, const std::string& what, const std::string& where) {
  return static_cast<double>(parseLong(word, what, where));
}

double parseFinite(const std::string& word, const std::string& what, const std::string& where) {
  const double value = parseNumber(word, what, where);
  if (!std::isfinite(value)) throw std::runtime_error(where + ": " + what + " '" + word + "' is not finite");
  return value;
}

std::uint64_t parseWhole(const std::string& word, const std::string& what, const std::string& where) {
  constexpr std::size_t kMostDigits = 19;
  bool digits = !word.empty() && word.size() <= kMostDigits;
  for (const char c : word) digits = digits && std::isdigit(static_cast<unsigned char>(c)) != 0;
  if (!digits) throw std::runtime_error(where + ": " + what + " '" + word + "' is not a whole number");
  return std::stoull(word);
}

std::int64_t parseSeconds(const std::string& word, const std::string& where) {
  constexpr long double kNanosecondsPerSecond = 1e9L;
  const long double nanoseconds = kNanosecondsPerSecond * parseLong(word, "time", where);
  if (!(std::abs(nanoseconds) < static_cast<long double>(std::numeric_limits<std::int64_t>::max()))) {
    throw std::runtime_error(where + ": time '" + word + "' is out of range");
  }
  return std::llround(nanoseconds);
}

std::int64_t parseNanoseconds(const std::string& word, const std::string& where) {
  const std::uint64_t value = parseWhole(word, "time [ns]", where);
  if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    throw std::runtime_error(where + ": time '" + word + "' is out of range");
  }
  return static_cast<std::int64_t>(value);
}

}  // namespace mba_vo
