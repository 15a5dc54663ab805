#include <filesystem>
#include <iostream>
#include <memory>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "rig/sim/synthetic_config.h"
#include "rig/sim/synthetic_session.h"

namespace turnlight::app {
namespace {

struct SynthesizeOptions {
  std::string config;
  std::string out;
};

Status RequireEmpty(const std::filesystem::path& out) {
  std::error_code code;
  if (!std::filesystem::exists(out, code)) return {};
  if (!std::filesystem::is_directory(out, code))
    return InputError("--out: " + out.string() + " is a file, allowed is a new or empty folder");
  if (!std::filesystem::is_empty(out, code))
    return InputError("--out: " + out.string() +
                      " is not empty, allowed is a new or empty folder: sessions are never "
                      "written over");
  return {};
}

int Synthesize(const SynthesizeOptions& options) {
  const auto config = rig::ReadSyntheticConfig(options.config);
  if (!config) return Fail(config.error());
  if (const Status status = RequireEmpty(options.out); !status) return Fail(status.error());
  Result<rig::SyntheticReport> report;
  {
    Progress progress("rendering", static_cast<std::size_t>(config->motion.frames));
    report = rig::WriteSynthetic(*config, options.out, [&](std::size_t, std::size_t) {
      progress.Step();
      return !Interrupted();
    });
  }
  if (!report) return Fail(report.error());
  if (report->stopped) {
    std::cerr << "turnlight: interrupted; " << options.out << " is no complete session"
              << std::endl;
    return kInterrupted;
  }
  for (const std::string& remark : report->remarks) std::cerr << "remark: " << remark << "\n";
  std::cout << options.out << ": " << config->motion.frames << " frames of " << config->camera.width
            << " x " << config->camera.height << ", with their truth.json" << std::endl;
  return kDone;
}

}  // namespace

void AddSynthesize(CLI::App& program, Action& action) {
  CLI::App* command =
      AddCommand(program, "synthesize",
                 "Generate a session with known lights and reflectance from a configuration",
                 "turnlight synthesize configs/synthetic_sphere.yaml --out sphere");
  auto options = std::make_shared<SynthesizeOptions>();
  command->add_option("CONFIG", options->config, "A YAML file, see configs/")->required();
  command->add_option("--out", options->out, "The session's folder; new or empty")
      ->required()
      ->type_name("DIR");
  command->callback([options, &action] { action = [options] { return Synthesize(*options); }; });
}

}  // namespace turnlight::app
