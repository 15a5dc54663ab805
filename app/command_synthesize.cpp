#include <iostream>
#include <memory>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "app/run_config.h"
#include "base/printable.h"
#include "rig/sim/synthetic_config.h"
#include "rig/sim/synthetic_session.h"

namespace turnlight::app {
namespace {

struct SynthesizeOptions {
  std::string config;
  std::string out;
};

int Synthesize(const SynthesizeOptions& options) {
  const auto is_run = IsRunConfig(options.config);
  if (!is_run) return Fail(is_run.error());
  if (*is_run)
    return Fail({ErrorKind::kInput,
                 options.config + ": a config for turnlight run, allowed is one for turnlight "
                                  "synthesize, with a scene and neither rig nor graph"});
  const auto config = rig::sim::ReadSyntheticConfig(options.config);
  if (!config) return Fail(config.error());
  if (const Status status = CheckNewFolder(options.out); !status) return Fail(status.error());
  Result<rig::sim::SyntheticReport> report;
  {
    Progress progress("rendering", static_cast<std::size_t>(config->motion.frames));
    report = rig::sim::WriteSynthetic(*config, options.out, [&](std::size_t, std::size_t) {
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
  for (const std::string& remark : report->remarks)
    std::cerr << "remark: " << Printable(remark) << "\n";
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
  AddOut(*command, options->out, "The session's folder; new or empty");
  command->callback([options, &action] { action = [options] { return Synthesize(*options); }; });
}

}  // namespace turnlight::app
