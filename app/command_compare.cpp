#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "app/command.h"
#include "app/comparison_report.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "base/file.h"
#include "base/junit.h"
#include "estimator/results/compare_results.h"
#include "rig/session/compare_sessions.h"
#include "rig/session/journal.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxResultBytes = 64 << 20;
constexpr std::uint64_t kMaxToleranceBytes = 1 << 20;
constexpr char kResultFile[] = "result.json";

struct CompareArguments {
  std::string a;
  std::string b;
  std::string tolerance;
  std::string junit;
  bool json = false;
};

// What there is at a path that can be compared.
struct Comparable {
  std::optional<fs::path> session;  // its folder
  std::optional<fs::path> result;   // its file

  std::string Kind() const {
    if (session && result) return "a run with a session and a result";
    return session ? "a session" : "a result";
  }
};

bool IsThere(const fs::path& path) {
  std::error_code code;
  return fs::exists(path, code);
}

// An unfinished capture counts as one, so that it is refused in words.
bool HoldsSession(const fs::path& folder) {
  return IsThere(folder / rig::kSessionFile) || IsThere(folder / rig::kJournalFile);
}

Result<Comparable> Find(const std::string& name) {
  const fs::path path(name);
  std::error_code code;
  Comparable found;
  if (fs::is_regular_file(path, code)) {
    if (path.filename() == rig::kSessionFile)
      return InputError(name + ": allowed is the session's folder, " +
                        fs::absolute(path).parent_path().string());
    found.result = path;
    return found;
  }
  for (const fs::path& folder : {path, path / "session"})
    if (!found.session && HoldsSession(folder)) found.session = folder;
  for (const fs::path& file : {path / kResultFile, path / "result" / kResultFile})
    if (!found.result && IsThere(file)) found.result = file;
  if (found.session || found.result) return found;
  return InputError(name + (IsThere(path) ? ": neither a session nor a result" : ": is not there") +
                    ", allowed is a result.json, a folder with one, the folder of a session, or "
                    "the folder of a run");
}

struct CompareTolerances {
  Tolerances session = StandardTolerances(rig::SessionQuantities());
  Tolerances result = StandardTolerances(estimator::results::ResultQuantities());
};

Result<CompareTolerances> ReadToleranceFile(const std::string& file) {
  CompareTolerances tolerances;
  if (file.empty()) return tolerances;
  const auto text = ReadTypedFile(file, kMaxToleranceBytes);
  if (!text) return Forward(text);
  const auto document = ParseYaml(*text, file);
  if (!document) return Forward(document);
  StrictObject object(*document);
  if (auto section = object.OptionalObject("session")) {
    const auto session = ReadTolerances(std::move(*section), rig::SessionQuantities());
    if (!session) return Forward(session);
    tolerances.session = *session;
  }
  if (auto section = object.OptionalObject("result")) {
    const auto result = ReadTolerances(std::move(*section), estimator::results::ResultQuantities());
    if (!result) return Forward(result);
    tolerances.result = *result;
  }
  if (const Status status = object.Finish(); !status) return Forward(status);
  return tolerances;
}

Result<estimator::results::ReportedResult> ReadReported(const fs::path& file) {
  const auto text = ReadFile(file, kMaxResultBytes);
  if (!text) return Forward(text);
  return estimator::results::ParseReportedResult(*text, file.string());
}

Result<std::vector<Comparison>> CompareAll(const CompareArguments& arguments) {
  const auto a = Find(arguments.a);
  if (!a) return Forward(a);
  const auto b = Find(arguments.b);
  if (!b) return Forward(b);
  if (a->Kind() != b->Kind())
    return InputError(arguments.a + " is " + a->Kind() + ", " + arguments.b + " is " + b->Kind() +
                      ": allowed are two of a kind; of a run, name its folder session or result");
  const auto tolerances = ReadToleranceFile(arguments.tolerance);
  if (!tolerances) return Forward(tolerances);
  std::vector<Comparison> comparisons;
  if (a->session) {
    auto compared = rig::CompareSessions(*a->session, *b->session, tolerances->session);
    if (!compared) return Forward(compared);
    comparisons.push_back(std::move(*compared));
  }
  if (a->result) {
    const auto result_a = ReadReported(*a->result);
    if (!result_a) return Forward(result_a);
    const auto result_b = ReadReported(*b->result);
    if (!result_b) return Forward(result_b);
    comparisons.push_back(
        estimator::results::CompareResults(*result_a, *result_b, tolerances->result));
  }
  return comparisons;
}

int CompareAndPrint(const CompareArguments& arguments) {
  const InterruptAtOnce reading_only;
  const auto comparisons = CompareAll(arguments);
  if (!comparisons) return Fail(comparisons.error());
  if (!arguments.junit.empty()) {
    const std::string suite = "turnlight compare " + arguments.a + " " + arguments.b;
    if (const Status status =
            WriteFileAtomic(arguments.junit, JunitXml(suite, JunitCases(*comparisons)));
        !status)
      return Fail(status.error());
  }
  bool same = true;
  std::string text;
  for (const Comparison& comparison : *comparisons) {
    same = same && comparison.Same();
    text += ComparisonText(comparison);
  }
  std::cout << (arguments.json ? ComparisonsToJson(arguments.a, arguments.b, *comparisons) : text)
            << std::flush;
  return same ? kDone : kDifferent;
}

}  // namespace

void AddCompare(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "compare",
      "Are two results, two sessions or two runs the same, within their sigmas and their noise? "
      "Exit code 0 if they are, 3 if they are different, 2 if the input is refused",
      "turnlight compare reference my_run --tolerance configs/compare_tolerance.yaml --junit "
      "compare.xml");
  auto arguments = std::make_shared<CompareArguments>();
  const std::string what =
      "a result.json, a folder with one, the folder of a session, or the folder of a run";
  command->add_option("A", arguments->a, "The reference: " + what)->required();
  command->add_option("B", arguments->b, "What is compared with it, of the same kind")->required();
  command
      ->add_option("--tolerance", arguments->tolerance,
                   "What else is allowed, quantity by quantity: configs/compare_tolerance.yaml "
                   "shows all keys")
      ->type_name("FILE");
  command
      ->add_option("--junit", arguments->junit,
                   "Write JUnit XML, a test case for each quantity, as CI systems read it")
      ->type_name("FILE");
  command->add_flag("--json", arguments->json,
                    "Print all quantities as JSON on standard output and nothing else there");
  command->callback(
      [arguments, &action] { action = [arguments] { return CompareAndPrint(*arguments); }; });
}

}  // namespace turnlight::app
