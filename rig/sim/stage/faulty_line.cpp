#include "rig/sim/stage/faulty_line.h"

#include <algorithm>
#include <utility>

#include "base/random.h"

namespace turnlight::rig::sim::stage {
namespace {

constexpr std::uint64_t kSeed = 1953;
constexpr char kHoldsOff = 0x13;
constexpr int kNuls = 3;

DeviceTime FromMs(double ms) { return DeviceTime(static_cast<std::int64_t>(ms * 1e6)); }

// Without the end of the line.
std::size_t TextLength(const std::string& line) {
  const std::size_t last = line.find_last_not_of("\r\n");
  return last == std::string::npos ? 0 : last + 1;
}

}  // namespace

FaultyLine::FaultyLine(std::shared_ptr<FaultScript> faults,
                       std::shared_ptr<const MockTurntable> table)
    : faults_(std::move(faults)), table_(std::move(table)) {}

std::optional<FaultEntry> FaultyLine::Strike(FaultKind kind, DeviceTime now) {
  if (!faults_) return std::nullopt;
  return faults_->Strike(kind, FaultDevice::kTable, table_->CommandedAngleDeg(now), now);
}

std::uint64_t FaultyLine::Draw(std::uint64_t below) {
  const double share = RandomStream(kSeed, 0).Uniform(drawn_++);
  return std::min(below - 1, static_cast<std::uint64_t>(share * static_cast<double>(below)));
}

// Any bytes, but no XOFF: a host that obeys it would never speak again.
std::string FaultyLine::Garbage(std::size_t bytes) {
  std::string text(bytes, '\0');
  for (char& c : text) {
    c = static_cast<char>(Draw(256));
    if (c == kHoldsOff) c = '#';
  }
  return text;
}

void FaultyLine::Alter(std::string& line) {
  const std::size_t length = TextLength(line);
  if (length == 0) return;
  char& c = line[Draw(length)];
  const char before = c;
  while (c == before) c = static_cast<char>(0x21 + Draw(0x7f - 0x21));
}

void FaultyLine::Put(DeviceTime due, std::string bytes) {
  const auto place =
      std::upper_bound(chunks_.begin(), chunks_.end(), due,
                       [](DeviceTime time, const Chunk& chunk) { return time < chunk.due; });
  chunks_.insert(place, {due, std::move(bytes)});
}

void FaultyLine::Send(const FirmwareMessage& message, DeviceTime now) {
  std::string line = message.bytes;
  DeviceTime begin = std::max(now, free_at_);
  if (message.kind == MessageKind::kReply) {
    if (Strike(FaultKind::kDroppedReply, now)) return;
    if (Strike(FaultKind::kDuplicateReply, now)) Put(begin, line);
    if (const auto late = Strike(FaultKind::kLateReply, now))
      return Put(begin + FromMs(late->amount), line);
  }
  if (message.kind == MessageKind::kStatus) {
    if (Strike(FaultKind::kLostStatus, now)) return;
    if (Strike(FaultKind::kAlteredStatus, now)) Alter(line);
  }
  if (Strike(FaultKind::kNulBytes, now))
    for (int i = 0; i < kNuls; ++i)
      line.insert(static_cast<std::size_t>(Draw(TextLength(line) + 1)), 1, '\0');
  if (const auto garbage = Strike(FaultKind::kSerialGarbage, now))
    line = Garbage(static_cast<std::size_t>(garbage->amount)) + line;
  if (const auto flood = Strike(FaultKind::kLongLine, now))
    line = std::string(static_cast<std::size_t>(flood->amount), 'x') + line;
  const auto split = Strike(FaultKind::kSplitLine, now);
  if (!split) return Put(begin, line);
  for (const char c : line) {
    Put(begin, std::string(1, c));
    begin += FromMs(split->amount);
  }
  free_at_ = begin;
}

std::string FaultyLine::Take(DeviceTime now) {
  std::string bytes;
  std::size_t taken = 0;
  while (taken < chunks_.size() && chunks_[taken].due <= now) bytes += chunks_[taken++].bytes;
  chunks_.erase(chunks_.begin(), chunks_.begin() + static_cast<std::ptrdiff_t>(taken));
  return bytes;
}

void FaultyLine::Clear() {
  chunks_.clear();
  free_at_ = DeviceTime(0);
}

bool FaultyLine::IsSilent(DeviceTime now) {
  if (now >= silent_until_)
    if (const auto silent = Strike(FaultKind::kSilent, now))
      silent_until_ = now + FromMs(silent->amount);
  return now < silent_until_;
}

}  // namespace turnlight::rig::sim::stage
