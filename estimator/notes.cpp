#include "estimator/notes.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "base/angles.h"
#include "base/format.h"
#include "estimator/facets.h"

namespace turnlight::estimator {
namespace {

constexpr double kUnexplained = 2.0;  // residual rms over noise that something is missing from
constexpr double kNoisy = 0.15;       // noise over the brightest radiance that hides lights
constexpr double kHardlyKept = 1.3;   // of what is asked for a light

}  // namespace

void AddNote(const std::string& id, const messages::Values& values, Estimate& out) {
  out.notes.push_back({messages::CodeOf(id), messages::Text(id, values)});
}

void AddViewsNote(Estimate& out) {
  if (out.distinct_views < out.views)
    AddNote(
        "views-add-nothing",
        {{"distinct", std::to_string(out.distinct_views)}, {"views", std::to_string(out.views)}},
        out);
}

void AddNotes(Estimate& out) {
  AddViewsNote(out);
  if (out.reflectance.lobes[0].model == model::SpecularModel::kNone)
    AddNote("no-highlight", {}, out);
  if (out.channels == 1) AddNote("grey", {}, out);
  const bool any_distant = std::any_of(out.lights.begin(), out.lights.end(),
                                       [](const LightEstimate& l) { return !l.near; });
  if (any_distant) AddNote("distance-unknown", {}, out);
  if (out.stopped == solve::Stopped::kIterationLimit) AddNote("not-converged", {}, out);
  if (out.stopped == solve::Stopped::kNotFinite) AddNote("not-converged/not-finite", {}, out);
}

bool Unexplained(double rms, double noise) { return rms > kUnexplained * noise; }

bool Noisy(double noise, double brightest) { return noise > kNoisy * brightest; }

void AddCountNotes(double noise, double brightest, double least_kept, Estimate& out) {
  constexpr std::size_t kFewPixels = 300;
  constexpr double kClearly = 5.0;  // sigmas: right counts seldom reach it
  if (Noisy(noise, brightest))
    AddNote(
        "count-uncertain/noise",
        {{"noise", Format("%.2g", noise)}, {"share", Format("%.0f", 100.0 * noise / brightest)}},
        out);
  if (out.pixels < kFewPixels)
    AddNote("count-uncertain/few-pixels", {{"pixels", std::to_string(out.pixels)}}, out);
  if (out.count.further > kClearly) {
    const Eigen::Vector3d& u = out.count.further_direction;
    AddNote("count-uncertain/further",
            {{"sigmas", Format("%.0f", out.count.further)},
             {"direction", Format("(%+.1f, %+.1f, %+.1f)", u.x(), u.y(), u.z())}},
            out);
  }
  if (out.count.split > kClearly)
    AddNote("count-uncertain/split",
            {{"sigmas", Format("%.0f", out.count.split)},
             {"light", std::to_string(out.count.split_light + 1)}},
            out);
  if (least_kept < kHardlyKept)
    AddNote("count-uncertain/hardly-kept", {{"kept", Format("%.2g", least_kept)}}, out);
}

void AddUnexplainedNote(double noise, Estimate& out) {
  if (Unexplained(out.rms, noise))
    AddNote("unexplained",
            {{"rms", Format("%.3g", out.rms)},
             {"times", Format("%.1f", out.rms / std::max(noise, 1e-12))}},
            out);
}

void AddPhotographNotes(const start::PhotographLights& lights, Estimate& out) {
  constexpr double kNearlyKept = 0.7;
  AddNote("photograph", {{"misfit", Format("%.2g", std::sqrt(lights.misfit))}}, out);
  if (lights.least_kept < kHardlyKept)
    AddNote("count-uncertain/hardly-kept", {{"kept", Format("%.2g", lights.least_kept)}}, out);
  if (lights.most_dropped > kNearlyKept)
    AddNote("count-uncertain/nearly-kept", {{"dropped", Format("%.2g", lights.most_dropped)}}, out);
}

void AddOutliersNote(const observe::FlagCounts& counts, Estimate& out) {
  if (!observe::ManyOutliers(counts)) return;
  AddNote(
      "outliers",
      {{"count", std::to_string(counts.outliers)}, {"on_target", std::to_string(counts.on_target)}},
      out);
}

void AddThinnedNote(const observe::Observations& kept, std::size_t usable, Estimate& out) {
  if (kept.blocks.share >= 1.0) return;
  constexpr int kSide = observe::BlockChoice::kSide;
  AddNote("pixels-thinned",
          {{"used", std::to_string(kept.used)},
           {"usable", std::to_string(usable)},
           {"side", std::to_string(kSide)}},
          out);
}

void AddFacetsNote(const calib::TargetShape& shape, Estimate& out) {
  const auto* mesh = std::get_if<calib::MeshShape>(&shape);
  const model::Reflectance& reflectance = out.reflectance;
  if (mesh == nullptr || !mesh->normals_made || reflectance.lobes[0].strength <= 0.0 ||
      !reflectance.lobes[0].present())
    return;
  // The normals over which the highlight is above half of its peak: the mirrored ray turns by twice
  // the angle of the normal, to both sides.
  const double highlight = model::MirroredHalfWidth(reflectance.lobes[0]);
  const double turn = FacetTurn(*mesh);
  if (turn <= highlight) return;
  AddNote("facets-coarse",
          {{"turn", Format("%.1f", RadToDeg(turn))},
           {"highlight", Format("%.1f", RadToDeg(highlight))}},
          out);
}

}  // namespace turnlight::estimator
