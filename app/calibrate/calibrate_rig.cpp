#include "app/calibrate/calibrate_rig.h"

#include <iostream>
#include <optional>
#include <string>
#include <utility>

#include "app/calibrate/rig_steps.h"
#include "app/calibrate/rig_summary.h"
#include "app/capture_run.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "base/file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

void SayOfRig(const std::string& text) { std::cerr << text << std::endl; }

// The folder is this config's from here on.
Status TakeRigFolder(const RigRecipe& recipe, const fs::path& out) {
  const fs::path copy = out / "config.yaml";
  std::error_code code;
  if (fs::exists(copy, code)) {
    const auto before = ReadFile(copy);
    if (!before) return Forward(before);
    if (*before == recipe.text) return {};
    return InputError("--out: " + out.string() + " was begun with another config, " +
                      copy.string() + "; allowed is the same one, or another folder");
  }
  if (fs::exists(out, code) && !fs::is_empty(out, code))
    return InputError("--out: " + out.string() + " is not empty, allowed is a new folder");
  if (Status status = MakeDirectory(out); !status) return status;
  return WriteFileAtomic(copy, recipe.text);
}

struct Calibrated {
  std::optional<calib::calibrate::response::Response> response;
  LensFound lens;
  AxisFound axis;
  TargetFound target;
};

Result<Calibrated> CalibrateParts(const RigWork& work) {
  const InterruptHaltsMotor guard;
  SayOfRig("1 of 4: the response");
  auto response = FindResponse(work);
  if (!response) return Forward(response);
  SayOfRig("2 of 4: the lens");
  auto lens = FindLens(work);
  if (!lens) return Forward(lens);
  SayOfRig("3 of 4: the axis");
  auto axis = FindAxis(work, *lens, *response);
  if (!axis) return Forward(axis);
  SayOfRig("4 of 4: the target's place");
  auto target = FindTarget(work, *axis);
  if (!target) return Forward(target);
  return Calibrated{std::move(*response), std::move(*lens), std::move(*axis), std::move(*target)};
}

Status WriteCalibrated(const RigWork& work, const Calibrated& found) {
  const fs::path file = fs::absolute(work.out) / "rig-calibration.json";
  const auto run = RunTextWith(work.recipe, file);
  if (!run) return Forward(run);
  Status status = rig::WriteRigCalibration(found.target.calibration, file);
  if (status) status = WriteFileAtomic(work.out / "rig.yaml", *run);
  return status;
}

// The normal capture, with what was found.
int CaptureCalibrated(const RigWork& work) {
  const RunFolder folder(work.out / "capture");
  if (folder.complete() && folder.estimated()) return kDone;
  if (const Status status = work.stage.Put("target", "the target stays where it is"); !status)
    return Fail(status.error());
  return folder.begun()
             ? ResumeCapture(folder, work.drivers)
             : RunCapture(work.out / "rig.yaml", folder, CaptureGoal::kEstimate, work.drivers);
}

Status Summarise(const RigWork& work, const Calibrated& found, bool captured) {
  std::optional<TrueRig> truth;
  if (work.recipe.simulator) {
    auto known = TruthOf(*work.recipe.simulator);
    if (!known) return Forward(known);
    truth = std::move(*known);
  }
  auto summary = SummaryOf({found.response, found.lens, found.axis, found.target}, truth);
  if (captured)
    if (Status status =
            AddLights(RunFolder(work.out / "capture").result() / "result.json", truth, summary);
        !status)
      return status;
  if (Status status = WriteFileAtomic(work.out / "summary.json", summary.dump(1) + "\n"); !status)
    return status;
  std::cout << SummaryText(summary) << "written      "
            << (work.out / "rig-calibration.json").string() << ", "
            << (work.out / "summary.json").string() << std::endl;
  return {};
}

}  // namespace

int RunCalibrateRig(const CalibrateRigArguments& arguments, const Drivers& drivers) {
  const auto recipe = ReadRigRecipe(arguments.config);
  if (!recipe) return Fail(recipe.error());
  if (const Status status = TakeRigFolder(*recipe, arguments.out); !status)
    return Fail(status.error());
  const bool asks = !arguments.yes && !recipe->simulator;
  PropStage stage(*recipe, asks, &InterruptFlag());
  const RigWork work{*recipe, arguments.out, stage, drivers, asks, &InterruptFlag(), SayOfRig};
  auto found = CalibrateParts(work);
  if (!found) {
    Error error = found.error();
    if (error.kind == ErrorKind::kDevice || error.kind == ErrorKind::kInterrupted)
      error.text += "; what was taken is safe, the same command goes on";
    return Fail(error);
  }
  if (const Status status = WriteCalibrated(work, *found); !status) return Fail(status.error());
  int code = kDone;
  if (arguments.capture) code = CaptureCalibrated(work);
  if (code != kDone) return code;
  const Status told = Summarise(work, *found, arguments.capture);
  return told ? kDone : Fail(told.error());
}

}  // namespace turnlight::app
