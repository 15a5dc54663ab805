#include "rig/session/journal.h"

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/file.h"
#include "base/sha256.h"
#include "base/strict_object.h"
#include "rig/session/session_fields.h"
#include "rig/session/session_files.h"
#include "rig/session/session_json.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::uint64_t kMaxJournalBytes = std::uint64_t{1} << 28;
constexpr std::string_view kBegin = "{\"crc32\":\"";
constexpr std::string_view kMiddle = "\",\"record\":";
constexpr std::string_view kEnd = "}";
constexpr std::size_t kCrcDigits = 8;

std::string Crc(std::string_view record) {
  const auto value = ::crc32_z(0, reinterpret_cast<const Bytef*>(record.data()), record.size());
  std::array<char, kCrcDigits + 1> digits{};
  std::snprintf(digits.data(), digits.size(), "%08x", static_cast<unsigned>(value));
  return digits.data();
}

std::string Frame(const ordered_json& record) {
  // Text that is no UTF-8, in a config's comment say, is no reason to refuse a capture.
  const std::string text = record.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  return std::string(kBegin) + Crc(text) + std::string(kMiddle) + text + std::string(kEnd) + "\n";
}

// The record of a line without its end; nothing if it is torn or damaged.
std::optional<std::string_view> Unframe(std::string_view line) {
  const std::size_t around = kBegin.size() + kCrcDigits + kMiddle.size() + kEnd.size();
  if (line.size() <= around || !line.starts_with(kBegin) || !line.ends_with(kEnd) ||
      line.substr(kBegin.size() + kCrcDigits, kMiddle.size()) != kMiddle)
    return std::nullopt;
  const std::string_view record = line.substr(around - kEnd.size(), line.size() - around);
  if (line.substr(kBegin.size(), kCrcDigits) != Crc(record)) return std::nullopt;
  return record;
}

std::string Sha256Of(StrictObject& object, const std::string& key, std::string text) {
  if (object.ok() && !IsSha256(text)) object.Refuse(key, "64 lower-case hexadecimal digits");
  return text;
}

std::vector<double> Angles(StrictObject& object) {
  std::vector<double> angles;
  const nlohmann::json& list = object.Raw("angles_deg");
  bool fits = list.is_array() && !list.empty();
  for (std::size_t i = 0; fits && i < list.size(); ++i) {
    fits = list[i].is_number() && std::isfinite(list[i].get<double>());
    if (fits) angles.push_back(list[i].get<double>());
  }
  if (!fits) object.Refuse("angles_deg", "a list of at least one finite number");
  return angles;
}

Result<JournalHeader> ParseHeader(std::string_view record, const std::string& where) {
  const auto document = ParseJson(record, where);
  if (!document) return Forward(document);
  StrictObject object(*document);
  object.Choice("format", {"turnlight-capture"});
  object.Integer("version", 1, 1);
  JournalHeader header;
  header.config_text = object.String("config");
  header.camera_path = object.String("camera");
  header.camera_sha256 = Sha256Of(object, "camera_sha256", object.String("camera_sha256"));
  header.mesh_path = object.OptionalString("mesh");
  if (header.mesh_path)
    header.mesh_sha256 = Sha256Of(object, "mesh_sha256", object.String("mesh_sha256"));
  header.camera_identity = object.String("camera_device");
  header.table_identity = object.String("table_device");
  header.angles_deg = Angles(object);
  header.closure_deg = object.OptionalNumber("closure_deg");
  header.by_hand = object.OptionalBoolean("by_hand").value_or(false);
  header.most_extra =
      static_cast<std::size_t>(object.OptionalInteger("most_extra", 0, 1000).value_or(0));
  if (const Status status = object.Finish(); !status) return Forward(status);
  return header;
}

Result<JournalEntry> ParseEntry(std::string_view record, const std::string& where,
                                const JournalHeader& header) {
  const auto document = ParseJson(record, where);
  if (!document) return Forward(document);
  StrictObject object(*document);
  const std::size_t frames =
      header.angles_deg.size() + (header.closure_deg ? 1 : header.most_extra);
  JournalEntry entry;
  entry.index =
      static_cast<std::size_t>(object.Integer("index", 0, static_cast<std::int64_t>(frames) - 1));
  std::vector<std::string> problems;
  entry.frame = ParseFrame(object.Object("frame"), problems);
  if (const auto sha256 = object.OptionalString("validity_sha256"))
    entry.validity_sha256 = Sha256Of(object, "validity_sha256", *sha256);
  if (object.ok() && problems.empty() && !entry.frame.sha256)
    object.RefuseText("frame/sha256", "this key is missing");
  if (object.ok() && entry.frame.validity.has_value() != entry.validity_sha256.has_value())
    object.RefuseText("validity_sha256", "allowed is one if the frame has a validity, else none");
  if (const Status status = object.Finish(); !status) return Forward(status);
  if (!problems.empty()) return InputError(problems.front());
  return entry;
}

void CheckFile(const fs::path& root, const NamedPath& named, const std::string& sha256,
               std::vector<std::string>& problems) {
  const auto file = Locate(root, named);
  const auto bytes = file ? ReadFile(*file) : Result<std::string>(Forward(file));
  if (!bytes) {
    problems.push_back(bytes.error().text);
    return;
  }
  const std::string found = Sha256Hex(*bytes);
  if (found != sha256)
    problems.push_back(file->string() + ": the file changed: its SHA-256 is " + found + ", the " +
                       "journal has " + sha256);
}

}  // namespace

std::string PrintJournalLine(const JournalHeader& header) {
  ordered_json record{{"format", "turnlight-capture"},
                      {"version", 1},
                      {"config", header.config_text},
                      {"camera", header.camera_path},
                      {"camera_sha256", header.camera_sha256}};
  if (header.mesh_path) {
    record["mesh"] = *header.mesh_path;
    record["mesh_sha256"] = header.mesh_sha256.value_or("");
  }
  record["camera_device"] = header.camera_identity;
  record["table_device"] = header.table_identity;
  record["angles_deg"] = header.angles_deg;
  if (header.closure_deg) record["closure_deg"] = *header.closure_deg;
  if (header.by_hand) record["by_hand"] = true;
  if (header.most_extra > 0) record["most_extra"] = header.most_extra;
  return Frame(record);
}

std::string PrintJournalLine(const JournalEntry& entry) {
  ordered_json record{{"index", entry.index}, {"frame", PrintFrame(entry.frame)}};
  if (entry.validity_sha256) record["validity_sha256"] = *entry.validity_sha256;
  return Frame(record);
}

Result<Journal> ReadJournal(const fs::path& root) {
  const fs::path file = root / kJournalFile;
  auto text = ReadFile(file, kMaxJournalBytes);
  if (!text) return Forward(text);
  Journal journal;
  std::map<std::size_t, JournalEntry> entries;
  std::string_view rest = *text;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = rest.find('\n');
    const auto record = Unframe(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    const std::string where = file.string() + ":" + std::to_string(line);
    const std::string torn = where + ": torn or damaged: its checksum does not match";
    if (line == 1) {
      auto header = record ? ParseHeader(*record, where)
                           : Result<JournalHeader>(InputError(
                                 torn + "; without its first line a capture cannot be resumed"));
      if (!header) return Forward(header);
      journal.header = std::move(*header);
      continue;
    }
    auto entry = record ? ParseEntry(*record, where, journal.header)
                        : Result<JournalEntry>(InputError(torn));
    if (entry)
      entries.insert_or_assign(entry->index, std::move(*entry));
    else
      journal.problems.push_back(entry.error().text);
  }
  if (journal.header.angles_deg.empty()) return InputError(file.string() + ": is empty");
  for (auto& [index, entry] : entries) journal.entries.push_back(std::move(entry));
  journal.text = std::move(*text);
  return journal;
}

std::vector<std::string> EntryProblems(const fs::path& root, const JournalEntry& entry,
                                       EntryFiles which) {
  std::vector<std::string> problems;
  const std::string key = "frame " + std::to_string(entry.index) + "/";
  if (which == EntryFiles::kAll)
    CheckFile(root, {key + "image", entry.frame.image, kJournalFile}, *entry.frame.sha256,
              problems);
  if (entry.frame.validity && entry.validity_sha256)
    CheckFile(root, {key + "validity", *entry.frame.validity, kJournalFile}, *entry.validity_sha256,
              problems);
  return problems;
}

std::string EntryLabel(const JournalHeader& header, std::size_t index) {
  const bool closure = index >= header.angles_deg.size();
  if (header.by_hand || (closure && !header.closure_deg)) return FrameLabel(index, std::nullopt);
  return FrameLabel(index, closure ? header.closure_deg : header.angles_deg[index], closure);
}

}  // namespace turnlight::rig
