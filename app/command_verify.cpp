#include <algorithm>
#include <iostream>
#include <memory>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "base/format.h"
#include "base/printable.h"
#include "estimator/from_session/frame_doubts.h"
#include "rig/capture/closure_check.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

int Verify(const std::string& folder) {
  const InterruptAtOnce reading_only;
  const auto report = rig::VerifySession(folder);
  if (!report) return Fail(report.error());
  for (const std::string& remark : report->remarks)
    std::cout << "remark: " << Printable(remark) << "\n";
  if (report->problems.empty()) {
    const auto closure = rig::CheckClosure(folder);
    if (!closure || *closure)
      std::cout << "remark: closure: "
                << Printable(closure ? (*closure)->text : closure.error().text) << "\n";
  }
  for (const std::string& problem : report->problems)
    std::cout << "problem: " << Printable(problem) << "\n";
  if (report->problems.empty()) {
    std::cout << folder << ": good, " << Counted(report->frames, "frame") << "\n"
              << "content sha256 " << report->content_sha256 << std::endl;
    return kDone;
  }
  std::cout << folder << ": " << Counted(report->problems.size(), "problem") << ", "
            << Counted(report->frames, "good frame") << std::endl;
  return report->session_good && report->frames > 0 ? kIncomplete : kRefused;
}

// What the frames are judged against.
void PrintModel(const estimator::consistency::Consistency& found) {
  if (!found.scene) return;
  const estimator::model::Scene& scene = *found.scene;
  const auto near = static_cast<std::size_t>(
      std::count_if(scene.lights.begin(), scene.lights.end(),
                    [](const auto& light) { return light.inverse_distance > 0.0; }));
  std::string specular;
  for (const estimator::model::Lobe& lobe : scene.reflectance.lobes)
    if (lobe.present() && lobe.strength > 0.0)
      specular += (specular.empty() ? "" : " and ") +
                  Format("%s (%s %.3g)", estimator::model::FactsOf(lobe.model).name,
                         estimator::model::FactsOf(lobe.model).shape_key, lobe.shape);
  std::cout << "model: fitted to small copies of the pictures, "
            << Counted(scene.lights.size(), "light")
            << (near > 0 ? Format(" (%zu near)", near) : std::string()) << ", diffuse "
            << estimator::model::FactsOf(scene.reflectance.diffuse_model).name << ", specular "
            << (specular.empty() ? "none" : specular)
            << Format("; it leaves %.2g of white (rms)\n", found.rms);
}

void PrintFrames(const estimator::from_session::ModelCheck& check) {
  const estimator::consistency::FramesJudged& judged = check.found.frames;
  if (check.frames.empty()) {
    std::cout << Format("model: fewer than %zu frames, too few to judge each by the others\n",
                        estimator::consistency::kFewestJudged);
    return;
  }
  std::cout << Format(
                   "model: how far each frame is from what the others tell (80 %% of its pixels "
                   "within, of white); %.2g is usual\n",
                   judged.usual)
            << "  frame    angle   residual  brightness  file\n";
  for (const auto& frame : check.frames) {
    const auto& of = frame.judged.residual;
    std::cout << Format("  %5zu %8s  %9.2g  %10.3f  ", frame.number,
                        frame.angle_deg ? Format("%.1f", *frame.angle_deg).c_str() : "-", of.left,
                        of.gain)
              << Printable(frame.file) << (frame.judged.odd ? "  <- " + frame.judged.what : "")
              << "\n";
  }
}

void PrintChanges(const estimator::consistency::Consistency& found) {
  constexpr std::size_t kMostShown = 8;
  if (found.tried.empty()) return;
  std::cout << Format(
      "poses: what lights cannot explain of the pictures, rms of white: as the poses are %.2g, "
      "after a fit %.2g; with all of them changed:\n",
      found.left, found.rms);
  for (std::size_t i = 0; i < std::min(found.tried.size(), kMostShown); ++i) {
    const auto& tried = found.tried[i];
    std::cout << Format("  %9.2g  ", tried.left) << tried.words
              << (tried.rms ? Format("; after a fit %.2g", *tried.rms) : "") << "\n";
  }
  if (found.tried.size() > kMostShown)
    std::cout << Format("  and %zu other changes that explain less\n",
                        found.tried.size() - kMostShown);
}

// Exit code 3 if a frame or the poses do not fit.
int VerifyAgainstModel(const std::string& folder) {
  const auto check = estimator::from_session::CheckModel(folder, &InterruptFlag());
  if (!check) return Fail(check.error());
  PrintModel(check->found);
  PrintFrames(*check);
  PrintChanges(check->found);
  const estimator::consistency::Consistency& found = check->found;
  const std::size_t odd = estimator::from_session::OddViews(found).size();
  std::string verdict = "frames and poses belong together, as far as pictures can tell";
  if (!found.comparable)
    verdict = "remark: whether frames and poses belong together cannot be told from " +
              (check->frames_in_all < 2 ? Counted(check->frames_in_all, "frame")
                                        : std::string("black pictures"));
  else if (found.change)
    verdict = "problem: " + estimator::from_session::WordsOfChange(found);
  else if (odd > 0)
    verdict = "problem: " + Counted(odd, "frame") + (odd == 1 ? " does" : " do") +
              " not belong to the others";
  else if (!found.seen)
    verdict =
        "problem: the target is hardly seen with these poses, and no change of them that was "
        "tried shows it; check the poses, the target's size and the masks";
  else if (!found.fits)
    verdict = Format(
        "remark: a fit leaves %.2g of white, and neither single frames nor a change of "
        "all poses that was tried explain it: a surface or lights that the model has "
        "not, or poses wrong in another way",
        found.rms);
  std::cout << verdict << std::endl;
  return verdict.starts_with("problem") ? kIncomplete : kDone;
}

}  // namespace

void AddVerify(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "verify",
      "Check a session: every file, checksum, pose and size. Exit code 0 if all is well, 3 if some "
      "frames are bad and the rest is good, 2 otherwise",
      "turnlight verify my_session");
  struct Arguments {
    std::string folder;
    bool model = false;
  };
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SESSION", arguments->folder, "The session's folder")->required();
  command->add_flag("--model", arguments->model,
                    "Also fit a scene, and tell which frames do not belong to the others and which "
                    "change of all poses would explain the pictures: exit code 3 if something does "
                    "not fit. It changes nothing");
  command->callback([arguments, &action] {
    action = [arguments] {
      const int files = Verify(arguments->folder);
      if (!arguments->model || files == kRefused) return files;
      const int model = VerifyAgainstModel(arguments->folder);
      return files == kDone ? model : files;
    };
  });
}

}  // namespace turnlight::app
