#include <algorithm>
#include <map>

#include "nodes/graph/log.h"

namespace turnlight::nodes::graph {
namespace {

std::string ShowRecord(const LogReader& log, const LogRecord& record) {
  return log.header().topics[record.topic].topic + " #" + std::to_string(record.header.sequence);
}

std::optional<std::uint64_t> FirstDifferingByte(const std::string& a, const std::string& b) {
  const auto at = std::mismatch(
      a.begin(), a.begin() + static_cast<std::ptrdiff_t>(std::min(a.size(), b.size())), b.begin());
  if (a.size() == b.size() && at.first == a.end()) return std::nullopt;
  return static_cast<std::uint64_t>(at.first - a.begin());
}

// Differences in one message; times count only in an exact comparison.
std::optional<LogDifference> CompareRecords(const LogReader& log, const LogRecord& a,
                                            const LogRecord& b, CompareMode mode) {
  LogDifference difference{log.header().topics[a.topic].topic, a.header.sequence, 0, ""};
  const auto byte = FirstDifferingByte(a.bytes, b.bytes);
  if (byte) {
    difference.byte = *byte;
    difference.text = ShowRecord(log, a) + " differs at byte " + std::to_string(*byte) + " of " +
                      std::to_string(a.bytes.size());
    if (a.bytes.size() != b.bytes.size())
      difference.text += " and " + std::to_string(b.bytes.size());
    return difference;
  }
  if (mode == CompareMode::kContent) return std::nullopt;
  const auto compare = [&](const char* what, Time first, Time second) {
    if (first != second && difference.text.empty())
      difference.text = ShowRecord(log, a) + " is " + what + " " + std::to_string(first.count()) +
                        " ns and " + std::to_string(second.count()) + " ns";
  };
  compare("valid at", a.header.valid_at, b.header.valid_at);
  compare("processed at", a.header.processed_at, b.header.processed_at);
  if (difference.text.empty()) return std::nullopt;
  return difference;
}

std::optional<LogDifference> CompareHeaders(const LogHeader& a, const LogHeader& b) {
  const auto different = [](std::string text) {
    return LogDifference{"", 0, 0, "the headers differ: " + std::move(text)};
  };
  if (a.config_hash != b.config_hash)
    return different("config " + a.config_hash + " and " + b.config_hash);
  if (a.seed != b.seed)
    return different("seed " + std::to_string(a.seed) + " and " + std::to_string(b.seed));
  if (a.topics != b.topics) return different("other topics or message types");
  return std::nullopt;
}

std::optional<LogDifference> CompareTails(const LogReader& a, const LogReader& b) {
  const auto show = [](const LogTail& tail) {
    if (!tail.whole) return tail.reason;
    return std::string(tail.stop->mode == StopMode::kNow ? "stopped at once" : "stopped in order") +
           " at " + std::to_string(tail.stop->at.count()) + " ns";
  };
  if (a.tail().whole == b.tail().whole && a.tail().stop == b.tail().stop) return std::nullopt;
  return LogDifference{"", 0, 0, "the ends differ: " + show(a.tail()) + " and " + show(b.tail())};
}

std::optional<LogDifference> Missing(const LogReader& log, const LogRecord& record,
                                     const char* which) {
  return LogDifference{log.header().topics[record.topic].topic, record.header.sequence, 0,
                       ShowRecord(log, record) + " is only in the " + which + " log"};
}

std::optional<LogDifference> CompareExact(LogReader& a, LogReader& b) {
  if (auto difference = CompareHeaders(a.header(), b.header())) return difference;
  while (true) {
    const auto first = a.Next();
    const auto second = b.Next();
    if (!first && !second) return CompareTails(a, b);
    if (!first) return Missing(b, *second, "second");
    if (!second) return Missing(a, *first, "first");
    if (first->topic != second->topic || first->header.sequence != second->header.sequence)
      return LogDifference{a.header().topics[first->topic].topic, first->header.sequence, 0,
                           "at byte " + std::to_string(first->offset) + " the first log has " +
                               ShowRecord(a, *first) + " where the second has " +
                               ShowRecord(b, *second)};
    if (auto difference = CompareRecords(a, *first, *second, CompareMode::kExact))
      return difference;
  }
}

// Offsets of the records of each topic, by name.
using Index = std::map<std::string, std::vector<std::uint64_t>>;
Index IndexOf(LogReader& log) {
  Index index;
  while (const auto record = log.Next())
    index[log.header().topics[record->topic].topic].push_back(record->offset);
  return index;
}

Result<std::optional<LogDifference>> CompareContent(LogReader& a, LogReader& b) {
  const Index first = IndexOf(a);
  const Index second = IndexOf(b);
  Index all = first;
  all.insert(second.begin(), second.end());
  const auto offsets = [](const Index& index, const std::string& topic) {
    const auto found = index.find(topic);
    return found == index.end() ? std::vector<std::uint64_t>() : found->second;
  };
  for (const auto& entry : all) {
    const auto in_first = offsets(first, entry.first);
    const auto in_second = offsets(second, entry.first);
    for (std::size_t i = 0; i < std::max(in_first.size(), in_second.size()); ++i) {
      Result<LogRecord> left = LogRecord{};
      Result<LogRecord> right = LogRecord{};
      if (i < in_first.size()) left = a.ReadAt(in_first[i]);
      if (i < in_second.size()) right = b.ReadAt(in_second[i]);
      if (!left) return Forward(left);
      if (!right) return Forward(right);
      if (i >= in_first.size()) return Missing(b, *right, "second");
      if (i >= in_second.size()) return Missing(a, *left, "first");
      if (auto difference = CompareRecords(a, *left, *right, CompareMode::kContent))
        return difference;
    }
  }
  return std::nullopt;
}

}  // namespace

Result<std::optional<LogDifference>> CompareLogs(const std::filesystem::path& first,
                                                 const std::filesystem::path& second,
                                                 CompareMode mode) {
  auto a = LogReader::Open(first);
  if (!a) return Forward(a);
  auto b = LogReader::Open(second);
  if (!b) return Forward(b);
  if (mode == CompareMode::kContent) return CompareContent(*a, *b);
  return CompareExact(*a, *b);
}

}  // namespace turnlight::nodes::graph
