#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mba_vo {

/// One line of a text file that says something: without its comment (`#` to the end), split into words.
struct TextLine {
  std::vector<std::string> words;
  std::string where;  // `file:line`, for messages
};

/// All of a text file. Throws std::runtime_error naming the file if it cannot be read, is empty, is larger than
/// `most_bytes`, or no text.
std::string readText(const std::string& file, std::size_t most_bytes = 1U << 30U);

/// The lines of `text` that say something; `separators` part the words.
std::vector<TextLine> splitLines(const std::string& text, const std::string& file,
                                 const std::string& separators = " \t\r");

std::string joinWords(const std::vector<std::string>& words, const std::string& separator);

/// Whether it can only be meant as a number.
bool beginsNumber(const std::string& word);

/// The number that is the whole of `word`, or std::runtime_error that tells where, what it should have been and what it
/// is.
double parseNumber(const std::string& word, const std::string& what, const std::string& where);
/// The same for a finite number.
double parseFinite(const std::string& word, const std::string& what, const std::string& where);
/// The same for a whole number that is not negative.
std::uint64_t parseWhole(const std::string& word, const std::string& what, const std::string& where);
/// A time in seconds, in [ns], without rounding it to a double on the way.
std::int64_t parseSeconds(const std::string& word, const std::string& where);
/// A time in whole nanoseconds.
std::int64_t parseNanoseconds(const std::string& word, const std::string& where);

}  // namespace mba_vo
