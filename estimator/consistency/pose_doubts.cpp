#include "estimator/consistency/pose_doubts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/statistics.h"
#include "estimator/consistency/explanation.h"
#include "estimator/consistency/picture_order.h"
#include "estimator/consistency/pose_changes.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/solve/coordinates.h"
#include "estimator/target/renderer.h"

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
constexpr int kOrderRounds = 4;  // fits of pictures that are put in order by the fit before

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

// The order that a scene asks for: each pose's picture is compared with what the pose should show,
// pixels beside the target with what is usual there. A fit knows shadows, which the explainer does
// not.
std::vector<std::size_t> OrderByScene(const SmallViews& views, const PoseChange& change,
                                      const model::Scene& scene, const target::Geometry& geometry,
                                      const calib::RayGrid& rays) {
  const std::size_t count = views.views.size();
  std::vector<cv::Mat1f> expected(count);
  std::vector<float> beside;
  for (std::size_t k = 0; k < count; ++k) {
    const target::Rendering view = target::Render(scene, geometry, rays, change.poses[k].X_WC,
                                                  change.poses[k].X_WT, {2, true});
    expected[k] = cv::Mat1f(view.coverage.size(), std::numeric_limits<float>::quiet_NaN());
    const cv::Mat1f& picture = views.views[change.picture[k]].radiance;
    for (int row = 0; row < picture.rows; ++row)
      for (int column = 0; column < picture.cols; ++column) {
        const cv::Vec3f& seen = view.radiance(row, column);
        if (view.coverage(row, column) > 0.99f)
          expected[k](row, column) = (seen[0] + seen[1] + seen[2]) / 3.0f;
        else if (view.coverage(row, column) == 0.0f)
          beside.push_back(picture(row, column));
      }
  }
  const float usual = beside.empty() ? 0.0f : Median(beside);
  Eigen::MatrixXd cost(count, count);
  ParallelFor(count, [&](std::size_t k) {
    for (std::size_t v = 0; v < count; ++v) {
      double sum = 0.0;
      const cv::Mat1f& picture = views.views[v].radiance;
      for (int row = 0; row < picture.rows; ++row)
        for (int column = 0; column < picture.cols; ++column) {
          const float model = expected[k](row, column), value = picture(row, column);
          if (!std::isfinite(model)) continue;
          const double off = value - model, off_usual = value - usual;
          sum += off * off - off_usual * off_usual;
        }
      cost(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(v)) = sum;
    }
  });
  return Exchanged(cost, change.picture);
}

struct Tried {
  TriedChange told;
  std::size_t place = 0;
  bool explains = false;
  double factor = 1.0;  // of angle-factor
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
                  change.place,
                  false,
                  change.factor};
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
        Fitted with = FitChanged(views_, change, geometry_, rays_, choice_, stop_);
        if (change.code == "order-shuffled") tried.told = FollowOrder(change, with);
        if (with.pixels > 0) tried.told.rms = with.rms;
        tried.explains = with.pixels > 0 &&
                         Explains(with, given, change.left <= kExplains * out.left) &&
                         !ExplainsAsTheyAre(with);
        fitted.push_back(tried);
      }
      out.tried.push_back(tried.told);
    }
    TryFineFactor(angles_deg, given, fitted, out);
    Tell(fitted, out);
  }

 private:
  // The factor of the angles that a fit leaves least with, downhill from `about`. The explainer
  // tells it roughly: what a few degrees change, some lights or other explain as well. Nothing if
  // no factor leaves less than `least`.
  struct Factor {
    PoseChange change;
    Fitted with;
  };
  std::optional<Factor> BestFactor(const Turning& turning, double about, double least) const {
    const std::vector<calib::RigPoses> poses = PosesOf(views_);
    std::optional<Factor> best;
    const auto look = [&](double factor) {
      if (StopRequested(stop_)) return;
      PoseChange next = ChangeOfFactor(views_, poses, turning, factor, 0.0);
      Fitted fit = FitChanged(views_, next, geometry_, rays_, choice_, stop_);
      if (!(fit.pixels > 0 && fit.rms < least)) return;
      least = fit.rms;
      best = Factor{std::move(next), std::move(fit)};
    };
    for (const double off : {-0.03, -0.015, 0.015, 0.03}) look(about * (1.0 + off));
    for (double step = 0.0075; best && step > 5e-4; step /= 2.0) {
      const double from = best->change.factor;
      look(from * (1.0 - step));
      look(from * (1.0 + step));
    }
    if (!best) return best;
    const Explainer explainer(views_, geometry_, rays_);
    best->change.left = explainer.Residual(explainer.DesignOf(best->change.poses), InOrder(views_));
    return best;
  }
  // Of a factor that explains the pictures a better one; where nothing does, one near 1 that does.
  void TryFineFactor(const std::vector<double>& angles_deg, const Fitted& given,
                     std::vector<Tried>& fitted, Consistency& out) const {
    const auto turning = FindTurning(PosesOf(views_), angles_deg);
    if (!turning || given.pixels == 0 || given.nothing_left) return;
    const auto explains = [](const Tried& one) { return one.explains; };
    const auto rough = std::find_if(fitted.begin(), fitted.end(), [&](const Tried& one) {
      return one.explains && one.told.code == "angle-factor";
    });
    if (rough == fitted.end() && std::any_of(fitted.begin(), fitted.end(), explains)) return;
    const bool known = rough != fitted.end();
    const auto best = BestFactor(*turning, known ? rough->factor : 1.0,
                                 known ? *rough->told.rms : kPromising * given.rms);
    if (!best) return;
    const PoseChange& change = best->change;
    Tried tried{{change.code, change.words, change.question, change.left, best->with.rms},
                known ? rough->place : fitted.size(),
                true,
                change.factor};
    if (known) {
      *rough = tried;
      return;
    }
    if (!Explains(best->with, given, false) || ExplainsAsTheyAre(best->with)) return;
    fitted.push_back(tried);
    out.tried.insert(out.tried.begin(), tried.told);
  }
  // Puts the pictures in the order that the fit asks for, and fits again, as long as that helps.
  // Gives the change as it is then told; `with` is the fit of that.
  TriedChange FollowOrder(PoseChange change, Fitted& with) const {
    for (int round = 0; round < kOrderRounds && with.pixels > 0; ++round) {
      auto picture = OrderByScene(views_, change, with.scene, geometry_, rays_);
      if (picture == change.picture) break;
      PoseChange next = ChangeOfOrder(views_, change.poses, std::move(picture), change.left);
      Fitted better = FitChanged(views_, next, geometry_, rays_, choice_, stop_);
      if (StopRequested(stop_) || !(better.pixels > 0 && better.rms < with.rms)) break;
      change = std::move(next);
      with = std::move(better);
    }
    return {change.code, change.words, change.question, change.left, std::nullopt};
  }
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
  // outline: the change also puts the target where it stands out from what is beside it, so that
  // it need not see as much as before.
  static bool Explains(const Fitted& with, const Fitted& given, bool outline) {
    if (with.rms > kWellExplained * with.brightest) return false;
    if (given.pixels == 0) return true;
    return !given.nothing_left && with.rms <= kExplains * given.rms &&
           (outline ||
            static_cast<double>(with.pixels) >= kSeesEnough * static_cast<double>(given.pixels)) &&
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
