#include "app/session_estimate.h"

#include <utility>

#include "app/closure.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/pictures_out.h"
#include "app/progress.h"
#include "app/scene_input.h"
#include "app/summary.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "estimator/pictures/pictures.h"
#include "estimator/results/result_json.h"

namespace turnlight::app {
namespace {

namespace from_session = estimator::from_session;

// The estimate, with a bar while frames are read.
Result<from_session::SessionEstimate> EstimateForAPerson(const std::filesystem::path& session,
                                                         const WriteOptions& options) {
  from_session::Options estimate = options.estimate;
  if (!options.initial.empty()) {
    auto guess = ReadInitialGuess(options.initial);
    if (!guess) return Forward(guess);
    estimate.initial = std::move(*guess);
  }
  std::optional<Progress> bar;
  estimate.progress = [&bar](from_session::Stage stage, std::size_t done, std::size_t total) {
    if (stage != from_session::Stage::kReading) return;
    if (done == 0)
      bar.emplace("reading", total);
    else
      bar->Step();
    if (done == total) bar.reset();
  };
  estimate.on_closure = TellVerdict;
  if (options.pictures) estimate.residuals_of = estimator::pictures::ShownKeyframes;
  estimate.stop = &InterruptFlag();
  return from_session::EstimateSession(session, estimate);
}

}  // namespace

Result<WrittenEstimate> WriteEstimate(const std::filesystem::path& session,
                                      const std::filesystem::path& out,
                                      const WriteOptions& options) {
  const Stopwatch stopwatch;
  if (const Status status = CheckOutputFolder(out, session); !status) return Forward(status);
  const auto estimated = EstimateForAPerson(session, options);
  if (!estimated) return Forward(estimated);
  const estimator::Estimate& estimate = estimated->output.estimate;
  if (const Status status = MakeDirectory(out); !status) return Forward(status);
  std::size_t pictures = 0;
  if (options.pictures) {
    const auto written = WritePictures(estimated->keyframes, estimated->geometry,
                                       *estimated->session.camera, estimated->output, out);
    if (!written) return Forward(written);
    pictures = *written;
  }
  const double total_s = stopwatch.Seconds();
  WrittenEstimate done;
  done.closure = estimated->closure;
  done.json = estimator::results::ResultToJson(
      estimate, estimated->session.name, options.estimate.method, {estimated->load_s, total_s},
      estimated->next_view ? &*estimated->next_view : nullptr);
  if (const Status status = WriteFileAtomic(out / "result.json", done.json); !status)
    return Forward(status);
  done.summary =
      Summary(estimate, estimated->session.name, estimated->session.length_unit) +
      (estimated->next_view ? "\nnext view\n  " + estimated->next_view->words + "\n" : "") + "\n" +
      (out / "result.json").string() +
      (pictures > 0 ? " and " + std::to_string(pictures) + " pictures beside it" : "") +
      " written\n";
  return done;
}

}  // namespace turnlight::app
