#include "mba_vo/evaluation/online_log.h"

#include <array>
#include <sstream>
#include <stdexcept>

namespace mba_vo {
namespace {

constexpr std::array<OnlineStatus, 8> kStatuses{
    OnlineStatus::kTracking, OnlineStatus::kDegraded, OnlineStatus::kOrientation, OnlineStatus::kInitializing,
    OnlineStatus::kLost,     OnlineStatus::kRepeated, OnlineStatus::kRejected,    OnlineStatus::kShed};

[[noreturn]] void failLog(const std::string& where, const std::string& what) {
  throw std::runtime_error(where + ": " + what);
}

std::optional<double> parseOptional(const std::string& name, const std::string& text, const std::string& where) {
  if (text.empty()) {
    return std::nullopt;
  }
  const std::optional<double> value = finiteNumber(text);
  if (!value) {
    failLog(where, name + " '" + text + "' is not a finite number");
  }
  return value;
}

OnlineStatus parseStatus(const std::string& text, const std::string& where) {
  std::string allowed;
  for (const OnlineStatus status : kStatuses) {
    if (text == toString(status)) {
      return status;
    }
    allowed += std::string(allowed.empty() ? "" : ", ") + toString(status);
  }
  failLog(where, "online_status '" + text + "' is none of " + allowed);
}

/// The upper triangle, row by row.
std::optional<Matrix6> parseCovariance(const std::string& text, const std::string& where) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::optional<double> number = finiteNumber(word);
    if (!number) {
      failLog(where, "covariance has '" + word + "', which is not a finite number");
    }
    numbers.push_back(*number);
  }
  if (numbers.empty()) {
    return std::nullopt;
  }
  constexpr std::size_t kUpperTriangle = 21;
  if (numbers.size() != kUpperTriangle) {
    failLog(where, "covariance has " + std::to_string(numbers.size()) + " numbers, must have 21 or none");
  }
  Matrix6 covariance;
  std::size_t next = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      covariance(row, column) = covariance(column, row) = numbers[next++];
    }
  }
  return covariance;
}

void checkTimes(const OnlineFrame& frame, const std::string& where) {
  constexpr double kStampRounding = 1e-6;  // of the stamps as written [s]
  if (frame.published && !frame.arrival) {
    failLog(where, "published, but without arrival");
  }
  if (frame.published && frame.latency() < -kStampRounding) {
    failLog(where, "published " + std::to_string(-frame.latency()) + " s before its arrival");
  }
  if (!frame.published && frame.covariance) {
    failLog(where, "a covariance, but never published");
  }
}

}  // namespace

const char* toString(OnlineStatus status) {
  switch (status) {
    case OnlineStatus::kTracking:
      return "TRACKING";
    case OnlineStatus::kDegraded:
      return "DEGRADED";
    case OnlineStatus::kOrientation:
      return "ORIENTATION";
    case OnlineStatus::kInitializing:
      return "INITIALIZING";
    case OnlineStatus::kLost:
      return "LOST";
    case OnlineStatus::kRepeated:
      return "REPEATED";
    case OnlineStatus::kRejected:
      return "REJECTED";
    case OnlineStatus::kShed:
      return "SHED";
  }
  return "?";
}

bool OnlineFrame::hasPose() const {
  return published && (status == OnlineStatus::kTracking || status == OnlineStatus::kDegraded);
}

bool OnlineFrame::hasOrientation() const { return hasPose() || (published && status == OnlineStatus::kOrientation); }

std::vector<OnlineFrame> onlineLog(const CsvTable& table) {
  const std::size_t time = table.column("time");
  const std::size_t arrival = table.column("arrival");
  const std::size_t published = table.column("published");
  const std::size_t status = table.column("online_status");
  const std::size_t covariance = table.column("covariance");
  std::vector<OnlineFrame> frames;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::vector<std::string>& fields = table.rows[row];
    const std::string where = table.where(row);
    const std::optional<double> mid_exposure = parseOptional("time", fields[time], where);
    if (!mid_exposure) {
      failLog(where, "no time");
    }
    frames.push_back({*mid_exposure, parseOptional("arrival", fields[arrival], where),
                      parseOptional("published", fields[published], where), parseStatus(fields[status], where),
                      parseCovariance(fields[covariance], where)});
    checkTimes(frames.back(), where);
  }
  if (frames.empty()) {
    failLog(table.file, "lists no image");
  }
  return frames;
}

}  // namespace mba_vo
