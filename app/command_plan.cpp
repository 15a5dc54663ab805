#include <iostream>
#include <memory>
#include <string>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/rig_config.h"
#include "app/run_config.h"
#include "base/format.h"
#include "nodes/graph/draw.h"
#include "nodes/graph/graph.h"

namespace turnlight::app {
namespace {

std::string Angles(const rig::CapturePlan& plan) {
  std::string text;
  for (const rig::PlannedFrame& frame : rig::PlannedFrames(plan))
    text += (text.empty() ? "" : " ") + Format("%.6g", frame.angle_deg) +
            (frame.closure ? " (closure)" : "");
  return text;
}

std::string MotionText(const rig::CapturePlan& plan, const rig::PlanEstimate& estimate) {
  if (plan.by_hand)
    return Format("  views     %.6g\u00b0 apart at least, wherever the camera is carried\n",
                  plan.step_deg);
  std::string limits = "none given";
  if (plan.limits)
    limits = Format("%.6g to %.6g\u00b0", plan.limits->min_deg, plan.limits->max_deg);
  return "  angles    " + Angles(plan) + "\n" +
         Format("  travel    %.6g\u00b0, from %.6g to %.6g\u00b0; limits: ", estimate.travel_deg,
                estimate.range.min_deg, estimate.range.max_deg) +
         limits + "\n";
}

std::string UntilText(const rig::CapturePlan& plan) {
  if (!plan.until) return "";
  return Format(
      "  until     every direction is known to %.6g\u00b0; sooner than that, or with at most "
      "%lld keyframes more\n",
      plan.until->direction_deg, static_cast<long long>(plan.until->most_extra));
}

std::string PlanText(const RunConfig& config, const rig::RigSetup& rig) {
  const rig::CapturePlan& plan = config.plan;
  const rig::PlanEstimate estimate =
      rig::EstimatePlan(plan, rig.table.kinematics, rig.camera.format, rig.camera.readout_s);
  const std::string duration =
      plan.by_hand ? "" : Format("  duration  %.3g s without repetitions\n", estimate.seconds);
  return config.name + "\n" +
         Format("  frames    %zu, %zu exposures\n", estimate.frames, estimate.exposures) +
         MotionText(plan, estimate) + UntilText(plan) + duration +
         Format("  disk      at most %.3g MB, %.3g MB a frame\n",
                static_cast<double>(estimate.bytes) * 1e-6,
                static_cast<double>(estimate.bytes_per_frame) * 1e-6);
}

int Plan(const std::string& file) {
  const auto config = ReadRunConfig(file);
  if (!config) return Fail(config.error());
  const auto rig = MakeRig(*config);
  if (!rig) return Fail(rig.error());
  if (const auto graph = BuildGraph(*config, *rig); !graph) return Fail(graph.error());
  std::cout << PlanText(*config, *rig) << std::flush;
  return kDone;
}

int Draw(const std::string& file, bool dot) {
  const auto config = ReadRunConfig(file);
  if (!config) return Fail(config.error());
  const auto rig = MakeRig(*config);
  if (!rig) return Fail(rig.error());
  const auto graph = BuildGraph(*config, *rig);
  if (!graph) return Fail(graph.error());
  std::cout << (dot ? nodes::graph::DrawDot(graph->parts())
                    : nodes::graph::DrawText(graph->parts()))
            << std::flush;
  return kDone;
}

}  // namespace

void AddPlan(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "plan", "Show what a run would do: angles, duration, space. Changes nothing",
      "turnlight plan configs/simulated_turntable.yaml");
  auto file = std::make_shared<std::string>();
  command->add_option("CONFIG", *file, "A YAML file for turnlight run")->required();
  command->callback([file, &action] { action = [file] { return Plan(*file); }; });
}

void AddGraph(CLI::App& program, Action& action) {
  CLI::App* command =
      AddCommand(program, "graph", "Check the graph of a config and draw it",
                 "turnlight graph configs/simulated_turntable.yaml --dot | dot -Tsvg -o graph.svg");
  auto file = std::make_shared<std::string>();
  auto dot = std::make_shared<bool>(false);
  command->add_option("CONFIG", *file, "A YAML file for turnlight run")->required();
  command->add_flag("--dot", *dot, "For Graphviz, instead of for a terminal");
  command->callback([file, dot, &action] { action = [file, dot] { return Draw(*file, *dot); }; });
}

}  // namespace turnlight::app
