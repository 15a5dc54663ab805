#include "estimator/consistency/pose_doubts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimator/consistency/explanation.h"
#include "estimator/consistency/pose_changes.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/solve/coordinates.h"

namespace turnlight::estimator::consistency {
namespace {

constexpr int kMostFitted = 3;           // changes
constexpr double kPromising = 0.9;       // of what is left without a change
constexpr double kExplains = 0.5;        // of the rms without a change
constexpr double kAboutAsLittle = 1.3;   // of what is left by a change that explains them
constexpr double kAlike = 1.1;           // ratio of the residuals of changes that explain alike
constexpr double kSame = 1e-3;           // difference of what two changes leave
constexpr double kWellExplained = 0.03;  // of the brightest radiance
constexpr double kFits = 0.01, kFitsNoise = 2.0;  // of the level, and of the noise: what fits
constexpr double kSeesEnough = 0.5;               // of the pixels that were seen without a change
constexpr double kNothingLeft = 1e-3;             // of the level: nothing to explain
constexpr double kBlack = 1e-7;

struct Fitted {
  double rms = 0.0, brightest = 0.0;  // of white
  std::size_t pixels = 0;
  model::Scene scene;         // in W
  bool nothing_left = false;  // that a change could explain
};

double BrightestOf(const observe::Observations& all) {
  return observe::BrightestRadiance(all) * all.radiance_unit;
}

Fitted FitChanged(const SmallViews& views, const PoseChange& change,
                  const target::Geometry& geometry, const calib::RayGrid& rays,
                  const model::ModelChoice& choice, const StopFlag* stop) {
  const observe::Observations all =
      observe::BuildObservations(ToKeyframes(views, change.poses, change.picture), geometry, rays);
  if (all.used < kFewestPixels) return {};
  const Fit fit = FitQuickly(all, choice, stop);
  return {fit.rms, BrightestOf(all), all.used, solve::ToWorld(fit.scene, all)};
}

struct Tried {
  TriedChange told;
  std::size_t place = 0;
  bool explains = false;
};

// Of the changes that explain the pictures alike the simplest is told, the others with it.
void Tell(const std::vector<Tried>& fitted, Consistency& out) {
  double least = std::numeric_limits<double>::infinity();
  for (const Tried& tried : fitted)
    if (tried.explains) least = std::min(least, *tried.told.rms);
  std::vector<Tried> alike;
  for (const Tried& tried : fitted)
    if (tried.explains && *tried.told.rms <= kAlike * least) alike.push_back(tried);
  if (alike.empty()) return;
  std::sort(alike.begin(), alike.end(),
            [](const Tried& a, const Tried& b) { return a.place < b.place; });
  out.change = alike.front().told;
  for (std::size_t i = 1; i < alike.size(); ++i) out.alike.push_back(alike[i].told.words);
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
  void Run(const std::vector<double>& angles_deg, const Fitted& given, Consistency& out) {
    const Explainer explainer(views_, geometry_, rays_);
    out.left = explainer.Residual(explainer.DesignOf(PosesOf(views_)), InOrder(views_));
    const std::vector<PoseChange> ranked =
        RankChanges(views_, geometry_, explainer, angles_deg, stop_);
    std::vector<Tried> fitted;
    for (const PoseChange& change : ranked) {
      if (StopRequested(stop_)) return;
      Tried tried{{change.code, change.words, change.question, change.left, std::nullopt},
                  change.place};
      const auto same = std::find_if(fitted.begin(), fitted.end(), [&](const Tried& other) {
        return other.told.code == change.code || Same(other.told.left, change.left);
      });
      if (same != fitted.end() && Same(same->told.left, change.left)) {
        tried.told.rms = same->told.rms;
        tried.explains = same->explains;
        if (tried.explains) fitted.push_back(tried);
      } else if (same == fitted.end() && fits_left_ > 0 &&
                 Promising(change.left, fitted, out.left)) {
        --fits_left_;
        const Fitted with = FitChanged(views_, change, geometry_, rays_, choice_, stop_);
        if (with.pixels > 0) tried.told.rms = with.rms;
        tried.explains = with.pixels > 0 && Explains(with, given) && !ExplainsAsTheyAre(with);
        fitted.push_back(tried);
      }
      out.tried.push_back(tried.told);
    }
    Tell(fitted, out);
  }

 private:
  // Whether what was found with a change explains the pictures with the poses as they are, too:
  // then only the first fit had not found it.
  bool ExplainsAsTheyAre(const Fitted& with) const {
    if (as_they_are_.used < kFewestPixels) return false;
    const Fit fit = FitFrom(as_they_are_, solve::ToSolver(with.scene, as_they_are_), stop_);
    return fit.rms * kExplains <= with.rms;
  }
  // Whether two changes leave the same of the pictures: they are the same to them.
  static bool Same(double a, double b) { return std::abs(a - b) <= kSame * std::max(a, b); }
  // Beside one that explains the pictures only what leaves about as little is fitted.
  static bool Promising(double left, const std::vector<Tried>& fitted, double as_they_are) {
    double limit = kPromising * as_they_are;
    for (const Tried& tried : fitted)
      if (tried.explains) limit = std::min(limit, kAboutAsLittle * tried.told.left);
    return left <= limit;
  }
  static bool Explains(const Fitted& with, const Fitted& given) {
    if (with.rms > kWellExplained * with.brightest) return false;
    if (given.pixels == 0) return true;
    return !given.nothing_left && with.rms <= kExplains * given.rms &&
           static_cast<double>(with.pixels) >= kSeesEnough * static_cast<double>(given.pixels) &&
           with.brightest >= kSeesEnough * given.brightest;
  }

  const SmallViews& views_;
  const observe::Observations& as_they_are_;
  const target::Geometry& geometry_;
  const calib::RayGrid& rays_;
  const model::ModelChoice& choice_;
  const StopFlag* stop_;
  int fits_left_ = kMostFitted;
};

}  // namespace

Consistency CheckConsistency(const SmallViews& views, const std::vector<double>& angles_deg,
                             const target::Geometry& geometry, const model::ModelChoice& choice,
                             bool all_changes, const StopFlag* stop) {
  Consistency out;
  out.comparable = views.views.size() > 1 &&
                   std::any_of(views.views.begin(), views.views.end(), [](const SmallView& view) {
                     return cv::norm(view.radiance, cv::NORM_INF) > kBlack;
                   });
  if (!out.comparable) return out;
  const calib::RayGrid rays(views.camera);
  const observe::Observations all = observe::BuildObservations(ToKeyframes(views), geometry, rays);
  Fitted given;
  out.seen = all.used >= kFewestPixels;
  double noise = 0.0, level = 0.0;
  if (out.seen) {
    noise = observe::EstimateNoise(all) * all.radiance_unit;
    given = {0.0, BrightestOf(all), all.used, {}};
    level = given.brightest;
    if (views.views.size() >= kFewestJudged) {
      out.frames = JudgeFrames(views, all, geometry, rays, choice, stop);
      out.rms = out.frames.rms_of_rest;
      level = out.frames.level;
    } else {
      out.rms = FitQuickly(all, choice, stop).rms;
    }
    given.rms = out.rms;
    out.fits = out.rms <= std::max(kFitsNoise * noise, kFits * level);
  }
  if (StopRequested(stop)) return out;
  // Odd frames among others that fit are those frames' matter.
  if (out.frames.odd > 0 && out.fits && !all_changes) return out;
  given.nothing_left = out.seen && out.rms <= std::max(kFitsNoise * noise, kNothingLeft * level);
  if (given.nothing_left && !all_changes) return out;
  Search(views, all, geometry, rays, choice, stop).Run(angles_deg, given, out);
  return out;
}

}  // namespace turnlight::estimator::consistency
