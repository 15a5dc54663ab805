#include "estimator/notes.h"

#include <algorithm>
#include <string>
#include <variant>

#include "base/angles.h"
#include "base/format.h"
#include "estimator/facets.h"

namespace turnlight::estimator {
namespace {

constexpr double kUnexplained = 2.0;  // residual rms over noise that something is missing from
constexpr double kNoisy = 0.15;       // noise over the brightest radiance that hides lights

}  // namespace

void AddViewsNote(Estimate& out) {
  if (out.distinct_views < out.views)
    out.notes.push_back(
        {"views-add-nothing",
         std::to_string(out.distinct_views) + " of " + std::to_string(out.views) +
             " views differ by more than noise; the others add nothing, and the sigmas are those "
             "of the distinct ones. A homogeneous body of revolution on the axis looks the same at "
             "every angle: use another target, tilt it, or move the camera."});
}

void AddNotes(Estimate& out) {
  AddViewsNote(out);
  if (out.reflectance.specular_model == model::SpecularModel::kNone)
    out.notes.push_back(
        {"no-highlight",
         "No highlight was found: shininess is null, and the lights' places rest on "
         "diffuse shading alone."});
  if (out.channels == 1)
    out.notes.push_back(
        {"grey", "The pictures are grey: albedo and products repeat one value for R, G and B."});
  const bool any_distant = std::any_of(out.lights.begin(), out.lights.end(),
                                       [](const LightEstimate& l) { return !l.near; });
  if (any_distant)
    out.notes.push_back({"distance-unknown",
                         "Lights with distance null are too far for the data to tell how far; "
                         "distance_min is a 95 % bound."});
  if (out.stopped == solve::Stopped::kIterationLimit)
    out.notes.push_back({"not-converged", "The solver reached its limit of iterations."});
  if (out.stopped == solve::Stopped::kNotFinite)
    out.notes.push_back({"not-converged", "The model is not finite where the solver stands."});
}

bool Unexplained(double rms, double noise) { return rms > kUnexplained * noise; }

bool Noisy(double noise, double brightest) { return noise > kNoisy * brightest; }

void AddCountNote(double noise, double brightest, Estimate& out) {
  constexpr std::size_t kFewPixels = 1000;
  if (Noisy(noise, brightest))
    out.notes.push_back({"count-uncertain",
                         Format("The noise is %.2g, %.0f %% of the brightest radiance: lights and "
                                "highlights may be hidden in it.",
                                noise, 100.0 * noise / brightest)});
  if (out.pixels < kFewPixels)
    out.notes.push_back(
        {"count-uncertain",
         Format("Only %zu pixels are usable: they may not show every light.", out.pixels)});
  if (!Unexplained(out.rms, noise)) return;
  out.notes.push_back(
      {"count-uncertain",
       Format("The model leaves %.3g rms of the pictures unexplained, %.1f times their noise: a "
              "light, a shadow or a property of the surface may be missing, and the number of "
              "lights is uncertain.",
              out.rms, out.rms / std::max(noise, 1e-12))});
}

void AddOutliersNote(const observe::FlagCounts& counts, Estimate& out) {
  if (!observe::ManyOutliers(counts)) return;
  out.notes.push_back(
      {"outliers", Format("%zu of %zu target pixels are unlike all around them and were left out; "
                          "some may have been missed.",
                          counts.outliers, counts.on_target)});
}

void AddThinnedNote(const observe::Observations& kept, std::size_t usable, Estimate& out) {
  if (kept.blocks.share >= 1.0) return;
  constexpr int kSide = observe::BlockChoice::kSide;
  out.notes.push_back(
      {"pixels-thinned",
       Format("%zu of about %zu usable pixels were used, in blocks of %d x %d spread evenly over "
              "the pictures: more are not held in memory (--pixels).",
              kept.used, usable, kSide, kSide)});
}

void AddFacetsNote(const calib::TargetShape& shape, Estimate& out) {
  const auto* mesh = std::get_if<calib::MeshShape>(&shape);
  const model::Reflectance& reflectance = out.reflectance;
  if (mesh == nullptr || !mesh->normals_made || reflectance.specular <= 0.0 ||
      reflectance.specular_model == model::SpecularModel::kNone)
    return;
  // The normals over which the highlight is above half of its peak. The mirrored ray turns by twice
  // the angle of the normal, the half vector by the same.
  const double half = model::LobeHalfWidth(reflectance.shininess);
  const double highlight =
      reflectance.specular_model == model::SpecularModel::kPhong ? half : 2.0 * half;
  const double turn = FacetTurn(*mesh);
  if (turn <= highlight) return;
      {"facets-coarse",
       Format("The mesh came without normals, and those made from its faces turn by %.1f degrees "
              "across a facet, while the highlight is %.1f degrees of normals wide: its shape, and "
              "with it shininess and lights, is that of the facets. Use a finer mesh, or one with "
              "normals.",
              RadToDeg(turn), RadToDeg(highlight))});
}

}  // namespace turnlight::estimator
