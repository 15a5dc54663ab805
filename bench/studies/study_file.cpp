#include "bench/studies/study_file.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "base/file.h"
#include "base/sha256.h"

namespace turnlight::studies {
namespace {

std::string OutputOf(const std::string& command) {
  const auto close = [](FILE* pipe) { pclose(pipe); };
  const std::unique_ptr<FILE, decltype(close)> pipe(popen(command.c_str(), "r"), close);
  std::string text;
  std::array<char, 256> buffer{};
  while (pipe && std::fgets(buffer.data(), buffer.size(), pipe.get())) text += buffer.data();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace

Result<StudyFile> ReadStudyFile(const std::filesystem::path& path) {
  const auto bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  const Json json = Json::parse(*bytes, nullptr, false);
  if (json.is_discarded() || json.value("format", "") != "turnlight-study" ||
      !json.contains("records"))
    return InputError(path.string() + ": not a turnlight-study file");
  StudyFile file;
  file.study = json.value("study", "");
  for (const Json& record : json["records"]) file.records[record.value("id", "")] = record;
  return file;
}

Status WriteStudyFile(const StudyFile& file, const std::filesystem::path& path) {
  std::string text = R"({"format": "turnlight-study", "version": 1, "study": )" +
                     Json(file.study).dump() + ",\n\"records\": [";
  const char* before = "\n";
  for (const auto& [id, record] : file.records) {
    text += before + record.dump();
    before = ",\n";
  }
  return WriteFileAtomic(path, text + "\n]}\n");
}

std::string TreeCommit() {
  const std::string commit = OutputOf("git -C '" TURNLIGHT_SOURCE_DIR
                                      "' describe --always --dirty --abbrev=12 2>/dev/null");
  return commit.empty() ? "unknown" : commit;
}

std::string ProgramHash() {
  const auto bytes = ReadFile(std::filesystem::read_symlink("/proc/self/exe"));
  return bytes ? Sha256Hex(*bytes).substr(0, 12) : "unknown";
}

Json Rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return std::strtod(text, nullptr);
}

}  // namespace turnlight::studies
