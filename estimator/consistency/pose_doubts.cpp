#include "estimator/consistency/pose_doubts.h"

#include <algorithm>
#include <cmath>

#include "estimator/consistency/explanation.h"
#include "estimator/consistency/pose_changes.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/solve/coordinates.h"

namespace turnlight::estimator::consistency {
namespace {

constexpr std::size_t kMostFitted = 3;            // changes
constexpr double kPromising = 0.9;                // of what is left without a change
constexpr double kExplains = 0.5;                 // of the rms without a change
constexpr double kSettles = 0.25;                 // likewise, so that no other need be tried
constexpr double kWellExplained = 0.03;           // of the brightest radiance
constexpr double kFits = 0.01, kFitsNoise = 2.0;  // of the level, and of the noise: what fits
constexpr double kSeesEnough = 0.5;               // of the pixels that were seen without a change
constexpr std::size_t kFewestPixels = 300;

struct Fitted {
  double rms = 0.0, brightest = 0.0;
  std::size_t pixels = 0;
  model::Scene scene;  // in W
};

std::vector<model::Keyframe> KeyframesOf(const SmallViews& views,
                                         const std::vector<calib::RigPoses>& poses,
                                         const std::vector<std::size_t>& picture) {
  std::vector<model::Keyframe> out;
  for (std::size_t k = 0; k < poses.size(); ++k)
    out.push_back(ToKeyframe(views.views[picture[k]], poses[k]));
  return out;
}

Fitted FitChanged(const SmallViews& views, const PoseChange& change,
                  const target::Geometry& geometry, const calib::RayGrid& rays,
                  const model::ModelChoice& choice, const StopFlag* stop) {
  const observe::Observations all =
      observe::BuildObservations(KeyframesOf(views, change.poses, change.picture), geometry, rays);
  if (all.used < kFewestPixels) return {};
  const Fit fit = FitQuickly(all, choice, stop);
  return {fit.rms, observe::BrightestRadiance(all), all.used, solve::ToWorld(fit.scene, all)};
}

std::vector<calib::RigPoses> GivenPoses(const SmallViews& views) {
  std::vector<calib::RigPoses> out;
  for (const SmallView& view : views.views) out.push_back(view.poses);
  return out;
}

std::vector<std::size_t> InOrder(std::size_t count) {
  std::vector<std::size_t> out(count);
  for (std::size_t k = 0; k < count; ++k) out[k] = k;
  return out;
}

class Search {
 public:
  // as_they_are: the observations with the poses as they are.
  Search(const SmallViews& views, const observe::Observations& as_they_are,
         const target::Geometry& geometry, const calib::RayGrid& rays,
         const model::ModelChoice& choice, const StopFlag* stop)
      : views_(views),
        as_they_are_(as_they_are),
        geometry_(geometry),
        rays_(rays),
        choice_(choice),
        stop_(stop) {}

  // Fits the most promising, one of each kind, and says which explains the pictures.
  void Run(const std::vector<double>& angles_deg, const Fitted& given, Consistency& out) const {
    const Explainer explainer(views_, geometry_, rays_);
    const std::vector<calib::RigPoses> poses = GivenPoses(views_);
    out.left = explainer.Residual(explainer.DesignOf(poses), InOrder(poses.size()));
    const std::vector<PoseChange> ranked = RankChanges(views_, geometry_, explainer, angles_deg);
    std::vector<TriedChange> fitted;
    for (const PoseChange& change : ranked) {
      if (StopRequested(stop_)) return;
      TriedChange& tried = out.tried.emplace_back(
          TriedChange{change.code, change.words, change.question, change.left, std::nullopt});
      const auto same = std::find_if(fitted.begin(), fitted.end(), [&](const TriedChange& other) {
        return other.code == tried.code || Alike(other.left, tried.left);
      });
      if (same != fitted.end() && Alike(same->left, tried.left)) tried.rms = same->rms;
      if (fitted.size() == kMostFitted || same != fitted.end() || Settles(out, given) ||
          change.left > kPromising * out.left)
        continue;
      const Fitted with = FitChanged(views_, change, geometry_, rays_, choice_, stop_);
      if (with.pixels > 0) tried.rms = with.rms;
      fitted.push_back(tried);
      if (with.pixels > 0 && Explains(with, given) && !ExplainsAsTheyAre(with) &&
          (!out.change || with.rms < *out.change->rms))
        out.change = tried;
    }
    if (!out.change) return;
    for (const TriedChange& tried : out.tried)
      if (tried.code != out.change->code && Alike(tried.left, out.change->left))
        out.alike.push_back(tried.words);
  }

 private:
  // Whether what was found with a change explains the pictures with the poses as they are, too:
  // then only the first fit had not found it.
  bool ExplainsAsTheyAre(const Fitted& with) const {
    if (as_they_are_.used < kFewestPixels) return false;
    const Fit fit = FitFrom(as_they_are_, solve::ToSolver(with.scene, as_they_are_), stop_);
    return fit.rms * kExplains < with.rms;
  }
  // Whether two changes leave the same, so that the pictures cannot tell which it was.
  static bool Alike(double a, double b) { return std::abs(a - b) <= kAlike * std::max(a, b); }
  // Whether what was found leaves so little that no other change need be fitted.
  static bool Settles(const Consistency& out, const Fitted& given) {
    return out.change && *out.change->rms < kSettles * given.rms;
  }
  static bool Explains(const Fitted& with, const Fitted& given) {
    if (with.rms > kWellExplained * with.brightest) return false;
    if (given.pixels == 0) return true;
    return with.rms <= kExplains * given.rms &&
           static_cast<double>(with.pixels) >= kSeesEnough * static_cast<double>(given.pixels) &&
           with.brightest >= kSeesEnough * given.brightest;
  }

  const SmallViews& views_;
  const observe::Observations& as_they_are_;
  const target::Geometry& geometry_;
  const calib::RayGrid& rays_;
  const model::ModelChoice& choice_;
  const StopFlag* stop_;
};

}  // namespace

Consistency CheckConsistency(const SmallViews& views, const std::vector<double>& angles_deg,
                             const target::Geometry& geometry, const model::ModelChoice& choice,
                             bool all_changes, const StopFlag* stop) {
  Consistency out;
  const calib::RayGrid rays(views.camera);
  const std::size_t count = views.views.size();
  if (count < 2) return out;  // nothing to compare with
  const observe::Observations all = observe::BuildObservations(
      KeyframesOf(views, GivenPoses(views), InOrder(count)), geometry, rays);
  Fitted given;
  if (all.used >= kFewestPixels) {
    if (count >= kFewestJudged) {
      out.frames = JudgeFrames(views, all, geometry, rays, choice, stop);
      out.rms = out.frames.rms_of_all;
    } else {
      out.rms = FitQuickly(all, choice, stop).rms;
    }
    given = {out.rms, observe::BrightestRadiance(all), all.used, {}};
  }
  if (StopRequested(stop)) return out;
  if (out.frames.odd > 0) {
    given.rms = out.frames.rms_of_rest;
    // Odd frames among others that fit are those frames' matter.
    const double fits = std::max(kFitsNoise * out.frames.noise, kFits * out.frames.level);
    if (given.rms <= fits && !all_changes) return out;
  }
  Search(views, all, geometry, rays, choice, stop).Run(angles_deg, given, out);
  return out;
}

}  // namespace turnlight::estimator::consistency
