#include "rig/sim/fault_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "base/random.h"

namespace turnlight::rig::sim {
namespace {

constexpr double kMaxAngleDeg = 1e6;
constexpr double kMaxTimeS = 1e7;
// What start + k * step loses.
constexpr double kRoundingDeg = 1e-9;
constexpr int kMaxTimes = 1'000'000;

// What each fault is: its word, whose it is, its amount. A key of null: it has no amount.
struct KindFacts {
  FaultKind kind;
  const char* word;
  std::optional<FaultDevice> device;  // none: either, and the script must say
  const char* amount_key;
  double amount;
  double min;
  double max;
  bool survivable;    // a capture that checks and retries gets through it by itself
  bool mocks = true;  // false: only simulated controllers on a serial line have it
};

constexpr FaultDevice kTable = FaultDevice::kTable;
constexpr FaultDevice kCamera = FaultDevice::kCamera;

// In the order of the enumeration.
constexpr std::array<KindFacts, 35> kKinds{{
    {FaultKind::kLostSteps, "lost_steps", kTable, "deg", 1.0, 0.0, 360.0, true},
    {FaultKind::kStall, "stall", kTable, nullptr, 0, 0, 0, true},
    {FaultKind::kLateArrival, "late_arrival", kTable, "ms", 400.0, 0.0, 1e7, true},
    {FaultKind::kWrongPosition, "wrong_position", kTable, "deg", 1.0, -360.0, 360.0, true},
    {FaultKind::kAlarm, "alarm", kTable, nullptr, 0, 0, 0, true},
    {FaultKind::kReset, "reset", kTable, nullptr, 0, 0, 0, true},
    {FaultKind::kNeverHomes, "never_homes", kTable, nullptr, 0, 0, 0, false},
    {FaultKind::kUnplugged, "unplugged", std::nullopt, "ms", 500.0, 0.0, 1e7, false},
    {FaultKind::kStaleFrame, "stale_frame", kCamera, "ms", 500.0, 0.0, 1e7, true},
    {FaultKind::kDuplicateFrame, "duplicate_frame", kCamera, nullptr, 0, 0, 0, true},
    {FaultKind::kDroppedFrame, "dropped_frame", kCamera, nullptr, 0, 0, 0, true},
    {FaultKind::kIncompleteFrame, "incomplete_frame", kCamera, nullptr, 0, 0, 0, true},
    {FaultKind::kBlurred, "blurred", kCamera, "deg", 0.5, -360.0, 360.0, true},
    {FaultKind::kTriggerIgnored, "trigger_ignored", kCamera, nullptr, 0, 0, 0, true},
    {FaultKind::kUntriggeredFrame, "untriggered_frame", kCamera, nullptr, 0, 0, 0, true},
    {FaultKind::kExposureDrift, "exposure_drift", kCamera, "share", 0.05, -0.99, 100.0, true},
    {FaultKind::kGainDrift, "gain_drift", kCamera, "db", 0.5, -60.0, 60.0, true},
    {FaultKind::kFlicker, "flicker", kCamera, "share", 0.05, -1.0, 100.0, false},
    {FaultKind::kLampOff, "lamp_off", kCamera, nullptr, 0, 0, 0, false},
    {FaultKind::kSaturated, "saturated", kCamera, nullptr, 0, 0, 0, false},
    {FaultKind::kAllBlack, "all_black", kCamera, nullptr, 0, 0, 0, false},
    {FaultKind::kControlLost, "control_lost", kCamera, nullptr, 0, 0, 0, false},
    {FaultKind::kSerialGarbage, "serial_garbage", kTable, "bytes", 40.0, 1.0, 1e5, true, false},
    {FaultKind::kSplitLine, "split_line", kTable, "ms", 20.0, 0.0, 1e4, true, false},
    {FaultKind::kNulBytes, "nul_bytes", kTable, nullptr, 0, 0, 0, true, false},
    {FaultKind::kLongLine, "long_line", kTable, "bytes", 4096.0, 1.0, 1e5, true, false},
    {FaultKind::kDroppedReply, "dropped_reply", kTable, nullptr, 0, 0, 0, true, false},
    {FaultKind::kDuplicateReply, "duplicate_reply", kTable, nullptr, 0, 0, 0, true, false},
    {FaultKind::kLateReply, "late_reply", kTable, "ms", 400.0, 0.0, 1e7, true, false},
    {FaultKind::kLostStatus, "lost_status", kTable, nullptr, 0, 0, 0, true, false},
    {FaultKind::kAlteredStatus, "altered_status", kTable, nullptr, 0, 0, 0, true, false},
    {FaultKind::kSilent, "silent", kTable, "ms", 1500.0, 0.0, 1e7, false, false},
    {FaultKind::kLimit, "limit", kTable, nullptr, 0, 0, 0, true, false},
    {FaultKind::kStuckSwitch, "stuck_switch", kTable, nullptr, 0, 0, 0, false, false},
    {FaultKind::kDisplaced, "displaced", kTable, "deg", 0.5, -360.0, 360.0, false, false},
}};

const KindFacts& Facts(FaultKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

bool Has(FaultWorld world, const KindFacts& facts) {
  return facts.mocks || world == FaultWorld::kRealProtocols;
}

std::vector<std::string> WordsOf(FaultWorld world) {
  std::vector<std::string> words;
  for (const KindFacts& facts : kKinds)
    if (Has(world, facts)) words.emplace_back(facts.word);
  return words;
}

const KindFacts& FactsOfWord(const std::string& word) {
  const auto* found = std::find_if(kKinds.begin(), kKinds.end(),
                                   [&](const KindFacts& facts) { return word == facts.word; });
  return found == kKinds.end() ? kKinds.front() : *found;
}

double AngleOf(const KeyframeAngles& angles, std::int64_t keyframe) {
  return angles.start_deg + static_cast<double>(keyframe) * angles.step_deg;
}

DeviceTime FromSeconds(double seconds) {
  return DeviceTime(static_cast<std::int64_t>(std::llround(seconds * 1e9)));
}

Status ReadAt(StrictObject object, const KeyframeAngles& angles, FaultEntry& entry) {
  const auto keyframe = object.OptionalInteger("keyframe", 0, angles.count - 1);
  const auto angle =
      object.OptionalNumber("angle_deg", {.min = -kMaxAngleDeg, .max = kMaxAngleDeg});
  const auto time = object.OptionalNumber("time_s", {.min = 0.0, .max = kMaxTimeS});
  if (keyframe.has_value() + angle.has_value() + time.has_value() != 1)
    object.RefuseText("", "allowed is exactly one of keyframe, angle_deg, time_s");
  if (keyframe) entry.angle_deg = AngleOf(angles, *keyframe);
  if (angle) entry.angle_deg = *angle;
  if (time) entry.from = FromSeconds(*time);
  return object.Finish();
}

void ReadDevice(StrictObject& object, const KindFacts& facts, FaultEntry& entry) {
  const auto word = object.OptionalChoice("device", {"table", "camera"});
  if (!word && !facts.device)
    object.RefuseText("device", std::string("this key is missing, ") + facts.word +
                                    " strikes one of table, camera");
  if (!word) return;
  entry.device = *word == "table" ? kTable : kCamera;
  if (facts.device && entry.device != *facts.device)
    object.Refuse("device", FaultWord(*facts.device) + ", as " + facts.word + " is a fault of it");
}

Result<FaultEntry> ReadEntry(StrictObject& object, const KeyframeAngles& angles, FaultWorld world) {
  const KindFacts& facts = FactsOfWord(object.Choice("fault", WordsOf(world)));
  FaultEntry entry = MakeFault(facts.kind);
  ReadDevice(object, facts, entry);
  if (facts.amount_key)
    entry.amount = object.OptionalNumber(facts.amount_key, {.min = facts.min, .max = facts.max})
                       .value_or(facts.amount);
  entry.times = static_cast<int>(object.OptionalInteger("times", 1, kMaxTimes).value_or(1));
  if (auto at = object.OptionalObject("at"))
    if (Status status = ReadAt(*at, angles, entry); !status) return Forward(status);
  if (Status status = object.Finish(); !status) return Forward(status);
  return entry;
}

std::vector<FaultKind> ReadRandomKinds(StrictObject& object, FaultWorld world) {
  std::vector<FaultKind> kinds;
  const nlohmann::json& list = object.Raw("faults");
  if (list.is_null()) {
    for (const KindFacts& facts : kKinds)
      if (facts.survivable && Has(world, facts)) kinds.push_back(facts.kind);
    return kinds;
  }
  const std::vector<std::string> words = WordsOf(world);
  for (const auto& word : list) {
    if (!word.is_string() || std::find(words.begin(), words.end(), word) == words.end()) {
      kinds.clear();
      break;
    }
    kinds.push_back(FactsOfWord(word.get<std::string>()).kind);
  }
  if (!list.is_array() || kinds.empty())
    object.Refuse("faults", "a list of any of " + Listed(words));
  return kinds;
}

// Keyed by the keyframe: the same keyframes are struck whatever else the script says.
Status ReadRandom(StrictObject object, const KeyframeAngles& angles, FaultWorld world,
                  std::vector<FaultEntry>& entries) {
  const auto seed = static_cast<std::uint64_t>(
      object.OptionalInteger("seed", 0, std::int64_t{1} << 53).value_or(1));
  const double share = object.Number("share", {.min = 0.0, .max = 1.0});
  const std::vector<FaultKind> kinds = ReadRandomKinds(object, world);
  if (Status status = object.Finish(); !status) return status;
  for (int keyframe = 0; keyframe < angles.count; ++keyframe) {
    const RandomStream random(seed, static_cast<std::uint64_t>(keyframe));
    if (random.Uniform(0) >= share) continue;
    const auto pick =
        static_cast<std::size_t>(random.Uniform(1) * static_cast<double>(kinds.size()));
    FaultEntry entry = MakeFault(kinds[std::min(pick, kinds.size() - 1)]);
    entry.angle_deg = AngleOf(angles, keyframe);
    entries.push_back(entry);
  }
  return {};
}

}  // namespace

std::string FaultWord(FaultKind kind) { return Facts(kind).word; }
std::string FaultWord(FaultDevice device) {
  return device == FaultDevice::kTable ? "table" : "camera";
}

FaultEntry MakeFault(FaultKind kind) {
  FaultEntry entry;
  entry.kind = kind;
  entry.device = Facts(kind).device.value_or(FaultDevice::kTable);
  entry.amount = Facts(kind).amount;
  return entry;
}

Result<std::vector<FaultEntry>> ReadFaultScript(StrictObject object, const KeyframeAngles& angles,
                                                FaultWorld world) {
  std::vector<FaultEntry> entries;
  if (object.Has("list")) {
    for (StrictObject& item : object.Objects("list", 0)) {
      auto entry = ReadEntry(item, angles, world);
      if (!entry) return Forward(entry);
      entries.push_back(*entry);
    }
  }
  if (auto random = object.OptionalObject("random"))
    if (Status status = ReadRandom(*random, angles, world, entries); !status)
      return Forward(status);
  object.Ignore("list");
  if (Status status = object.Finish(); !status) return Forward(status);
  return entries;
}

FaultScript::FaultScript(std::vector<FaultEntry> entries) : entries_(std::move(entries)) {}

std::optional<FaultEntry> FaultScript::Strike(FaultKind kind, FaultDevice device,
                                              double commanded_deg, DeviceTime now) {
  const std::lock_guard lock(mutex_);
  for (FaultEntry& entry : entries_) {
    if (entry.kind != kind || entry.device != device || entry.times <= 0) continue;
    if (entry.from && now < *entry.from) continue;
    if (entry.angle_deg &&
        !(std::abs(*entry.angle_deg - commanded_deg) <= 0.5 * resolution_deg_ + kRoundingDeg))
      continue;
    --entry.times;
    fired_.push_back({entry, now, commanded_deg});
    return entry;
  }
  return std::nullopt;
}

void FaultScript::SetResolution(double deg) {
  const std::lock_guard lock(mutex_);
  resolution_deg_ = deg;
}

std::vector<FiredFault> FaultScript::Fired() const {
  const std::lock_guard lock(mutex_);
  return fired_;
}

int FaultScript::Remaining() const {
  const std::lock_guard lock(mutex_);
  int remaining = 0;
  for (const FaultEntry& entry : entries_) remaining += entry.times;
  return remaining;
}

}  // namespace turnlight::rig::sim
