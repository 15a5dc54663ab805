#include "estimator/consistency/pose_doubts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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
constexpr double kInMasks = 0.5;                  // of the target
constexpr double kBlack = 1e-7;
constexpr int kOrderRounds = 4;  // fits of pictures that are put in order by the fit before

struct Fitted {
  double rms = 0.0, brightest = 0.0;  // of white
  std::size_t pixels = 0;             // 0: too few to be fitted
  model::Scene scene;                 // in W
};

double BrightestOf(const observe::Observations& all) {
  return observe::BrightestRadiance(all) * all.radiance_unit;
}

// What all changes are judged by.
struct Evidence {
  const SmallViews& views;
  const observe::Observations& as_they_are;  // with the poses as they are
  const target::Geometry& geometry;
  const calib::RayGrid& rays;
  const model::ModelChoice& choice;
  const StopFlag* stop;
  Fitted given;               // with the poses as they are
  bool nothing_left = false;  // that a change could explain
};

// Every change that was tried: what the explainer leaves of it, what a fit leaves if it was fitted,
// and whether that explains the pictures.
struct Tried {
  PoseChange change;
  std::optional<double> rms;
  bool explains = false, fitted = false;
};

class Search {
 public:
  // The evidence must outlive it.
  Search(const Evidence& evidence, const std::vector<double>& angles_deg)
      : evidence_(evidence),
        explainer_(evidence.views, evidence.geometry, evidence.rays, evidence.stop),
        as_given_(explainer_.DesignOf(PosesOf(evidence.views))),
        left_(explainer_.Residual(as_given_, InOrder(evidence.views))),
        turning_(FindTurning(PosesOf(evidence.views), angles_deg)) {}

  // Fits the most promising, one of each kind, and says which explains the pictures. With stop set
  // on the way it tells what it has.
  void Run(Consistency& out) {
    for (PoseChange& change : RankChanges(evidence_.views, evidence_.geometry, explainer_,
                                          as_given_, turning_, evidence_.stop))
      tried_.push_back({std::move(change), std::nullopt, false});
    int fits_left = kMostFitted;
    for (Tried& tried : tried_) {
      if (Stopped()) break;
      if (const Tried* same = FittedWith(&Search::SameLeft, tried.change)) {
        tried.rms = same->rms;
        tried.explains = same->explains;
      } else if (fits_left > 0 && Promising(tried.change.left) &&
                 FittedWith(&Search::SameKind, tried.change) == nullptr) {
        --fits_left;
        tried = FitInEarnest(std::move(tried.change));
        tried.fitted = true;
      }
    }
    TryFineFactor();
    Tell(out);
  }

 private:
  bool Stopped() const { return StopRequested(evidence_.stop); }

  Fitted FitWith(const PoseChange& change) const {
    if (Stopped()) return {};
    const observe::Observations all =
        observe::BuildObservations(ToKeyframes(evidence_.views, change.poses, change.picture),
                                   evidence_.geometry, evidence_.rays);
    if (all.used < kFewestPixels) return {};
    const Fit fit = FitQuickly(all, evidence_.choice, evidence_.stop);
    return {fit.rms, BrightestOf(all), all.used, solve::ToWorld(fit.scene, all)};
  }

  // The one rule by which a change is accepted. What a fit that was stopped says is not taken.
  Tried Judged(PoseChange change, const Fitted& with) const {
    const bool explains = with.pixels > 0 && Explains(change, with);
    if (with.pixels == 0 || Stopped()) return {std::move(change), std::nullopt, false};
    return {std::move(change), with.rms, explains};
  }
  bool Explains(const PoseChange& change, const Fitted& with) const {
    const Fitted& given = evidence_.given;
    if (evidence_.nothing_left || with.rms > kWellExplained * with.brightest) return false;
    // A fit alone proves nothing of poses that put the target somewhere else: a few pixels of what
    // stands there can always be explained.
    if (given.pixels == 0) return OutlineFits(change);
    return with.rms <= kExplains * given.rms && with.brightest >= kSeesEnough * given.brightest &&
           (static_cast<double>(with.pixels) >= kSeesEnough * static_cast<double>(given.pixels) ||
            OutlineFits(change)) &&
           !ExplainsAsTheyAre(with);
  }
  // Whether the change puts the target where it stands out from what is beside it, and into the
  // masks.
  bool OutlineFits(const PoseChange& change) const {
    return change.left <= kExplains * left_ &&
           explainer_.ShareInMasks(explainer_.DesignOf(change.poses), change.picture) >= kInMasks;
  }
  // Whether what was found with a change explains the pictures with the poses as they are, too:
  // then only the first fit had not found it.
  bool ExplainsAsTheyAre(const Fitted& with) const {
    const observe::Observations& all = evidence_.as_they_are;
    const Fit fit = FitFrom(all, solve::ToSolver(with.scene, all), evidence_.stop);
    return fit.rms * kExplains <= with.rms;
  }

  // Whether two changes leave the same of the pictures: they are the same to them.
  static bool SameLeft(const PoseChange& a, const PoseChange& b) {
    return std::abs(a.left - b.left) <= kSame * std::max(a.left, b.left);
  }
  static bool SameKind(const PoseChange& a, const PoseChange& b) { return a.code == b.code; }
  const Tried* FittedWith(bool (*same)(const PoseChange&, const PoseChange&),
                          const PoseChange& change) const {
    for (const Tried& tried : tried_)
      if (tried.fitted && same(tried.change, change)) return &tried;
    return nullptr;
  }
  // Beside one that explains the pictures only what leaves about as little is fitted.
  bool Promising(double left) const {
    double limit = kPromising * left_;
    for (const Tried& tried : tried_)
      if (tried.explains) limit = std::min(limit, kAboutAsLittle * tried.change.left);
    return left <= limit;
  }

  Tried FitInEarnest(PoseChange change) const {
    Fitted with = FitWith(change);
    if (change.code == "order-shuffled") FollowOrder(change, with);
    return Judged(std::move(change), with);
  }
  // Puts the pictures in the order that the fit asks for, and fits again, as long as that helps.
  // Where it asks for the order as it is, no other is better than that.
  void FollowOrder(PoseChange& change, Fitted& with) const {
    for (int round = 0; round < kOrderRounds && with.pixels > 0 && !Stopped(); ++round) {
      auto picture = OrderByScene(change, with.scene);
      if (picture == change.picture || picture == InOrder(evidence_.views)) break;
      const double left = explainer_.Residual(as_given_, picture);
      PoseChange next = ChangeOfOrder(evidence_.views, change.poses, std::move(picture), left);
      next.place = change.place;
      Fitted better = FitWith(next);
      if (Stopped() || !(better.pixels > 0 && better.rms < with.rms)) break;
      change = std::move(next);
      with = std::move(better);
    }
  }
  std::vector<std::size_t> OrderByScene(const PoseChange& change, const model::Scene& scene) const;

  struct Factor {
    PoseChange change;
    Fitted with;
  };
  std::optional<Factor> BestFactor(double about, double least) const;
  void TryFineFactor();
  void Tell(Consistency& out) const;

  const Evidence& evidence_;
  const Explainer explainer_;
  const Design as_given_;  // of the poses as they are
  const double left_;      // by the explainer with them
  const std::optional<Turning> turning_;
  std::vector<Tried> tried_;  // best first
};

// The order that a scene asks for: each pose's picture is compared with what the pose should show,
// pixels beside the target with what is usual there. A fit knows shadows, which the explainer does
// not.
std::vector<std::size_t> Search::OrderByScene(const PoseChange& change,
                                              const model::Scene& scene) const {
  const std::size_t count = change.poses.size();
  std::vector<cv::Mat1f> pictures, expected;
  for (const SmallView& view : evidence_.views.views) pictures.push_back(Masked(view));
  std::vector<float> beside;
  for (std::size_t k = 0; k < count; ++k) {
    if (Stopped()) return change.picture;
    const target::Rendering view =
        target::Render(scene, evidence_.geometry, evidence_.rays, change.poses[k].X_WC,
                       change.poses[k].X_WT, {2, true});
    cv::Mat1f& model =
        expected.emplace_back(view.coverage.size(), std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < model.rows; ++row)
      for (int column = 0; column < model.cols; ++column) {
        const cv::Vec3f& seen = view.radiance(row, column);
        if (view.coverage(row, column) > 0.99f)
          model(row, column) = (seen[0] + seen[1] + seen[2]) / 3.0f;
        else if (view.coverage(row, column) == 0.0f)
          beside.push_back(pictures[change.picture[k]](row, column));
      }
  }
  const float usual = beside.empty() ? 0.0f : Median(beside);
  Eigen::MatrixXd cost =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
  ParallelFor(count, [&](std::size_t k) {
    for (std::size_t v = 0; v < count && !Stopped(); ++v) {
      double sum = 0.0;
      for (int row = 0; row < expected[k].rows; ++row)
        for (int column = 0; column < expected[k].cols; ++column) {
          const float model = expected[k](row, column), value = pictures[v](row, column);
          if (!std::isfinite(model)) continue;
          const double off = value - model, off_usual = value - usual;
          sum += off * off - off_usual * off_usual;
        }
      cost(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(v)) = sum;
    }
  });
  return Stopped() ? change.picture : Exchanged(cost, change.picture);
}

// The factor of the angles that a fit leaves least with, downhill from `about`. The explainer
// tells it roughly: what a few degrees change, some lights or other explain as well. Nothing if
// no factor leaves less than `least`.
std::optional<Search::Factor> Search::BestFactor(double about, double least) const {
  const std::vector<calib::RigPoses> poses = PosesOf(evidence_.views);
  std::optional<Factor> best;
  const auto look = [&](double factor) {
    PoseChange next = ChangeOfFactor(evidence_.views, poses, *turning_, factor, 0.0);
    Fitted fit = FitWith(next);
    if (Stopped() || !(fit.pixels > 0 && fit.rms < least)) return;
    least = fit.rms;
    best = Factor{std::move(next), std::move(fit)};
  };
  for (const double off : {-0.03, -0.015, 0.015, 0.03}) look(about * (1.0 + off));
  for (double step = 0.0075; best && step > 5e-4; step /= 2.0) {
    const double from = best->change.factor;
    look(from * (1.0 - step));
    look(from * (1.0 + step));
  }
  if (best)
    best->change.left =
        explainer_.Residual(explainer_.DesignOf(best->change.poses), InOrder(evidence_.views));
  return best;
}

// Of a factor that explains the pictures a better one; where nothing does, one near 1 that does.
void Search::TryFineFactor() {
  if (!turning_ || evidence_.given.pixels == 0 || evidence_.nothing_left || Stopped()) return;
  const auto explains = [](const Tried& one) { return one.explains; };
  const auto rough = std::find_if(tried_.begin(), tried_.end(), [&](const Tried& one) {
    return one.explains && one.change.code == "angle-factor";
  });
  const bool known = rough != tried_.end();
  if (!known && std::any_of(tried_.begin(), tried_.end(), explains)) return;
  auto best = BestFactor(known ? rough->change.factor : 1.0,
                         known ? *rough->rms : kPromising * evidence_.given.rms);
  if (!best) return;
  Tried fine = Judged(std::move(best->change), best->with);
  if (!fine.explains) return;
  fine.change.place = known ? rough->change.place : tried_.size();
  if (known)
    *rough = std::move(fine);
  else
    tried_.insert(tried_.begin(), std::move(fine));
}

// Of the changes that explain the pictures alike the simplest is told, the others with it.
void Search::Tell(Consistency& out) const {
  out.left = left_;
  double least = std::numeric_limits<double>::infinity();
  for (const Tried& tried : tried_)
    if (tried.explains) least = std::min(least, *tried.rms);
  std::vector<std::pair<std::size_t, TriedChange>> alike;
  for (const Tried& tried : tried_) {
    const PoseChange& change = tried.change;
    out.tried.push_back(
        {change.code, change.words, change.question, change.factor, change.left, tried.rms});
    if (tried.explains && *tried.rms <= kAlike * least)
      alike.emplace_back(change.place, out.tried.back());
  }
  std::sort(alike.begin(), alike.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [place, change] : alike) {
    if (!out.change)
      out.change = change;
    else
      out.alike.push_back(change.words);
  }
}

// What a fit with the poses as they are leaves; says which frames do not belong to the others.
Fitted FitAsGiven(const Evidence& of, Consistency& out) {
  const observe::Observations& all = of.as_they_are;
  if (of.views.views.size() >= kFewestJudged) {
    out.frames = JudgeFrames(of.views, all, of.geometry, of.rays, of.choice, of.stop);
    out.rms = out.frames.rms_of_rest;
    out.scene = solve::ToWorld(out.frames.scene, all);
  } else {
    const Fit fit = FitQuickly(all, of.choice, of.stop);
    out.rms = fit.rms;
    out.scene = solve::ToWorld(fit.scene, all);
  }
  return {out.rms, BrightestOf(all), all.used, *out.scene};
}

}  // namespace

Consistency CheckConsistency(const SmallViews& views, const std::vector<double>& angles_deg,
                             const target::Geometry& geometry, const model::ModelChoice& choice,
                             bool all_changes, const StopFlag* stop) {
  Consistency out;
  out.comparable = views.views.size() > 1 &&
                   std::any_of(views.views.begin(), views.views.end(), [](const SmallView& view) {
                     return cv::norm(view.radiance, cv::NORM_INF) > kBlack;
                   });
  if (!out.comparable || StopRequested(stop)) return out;
  const calib::RayGrid rays(views.camera);
  const observe::Observations all = observe::BuildObservations(ToKeyframes(views), geometry, rays);
  Evidence evidence{views, all, geometry, rays, choice, stop, {}, false};
  out.seen = all.used >= kFewestPixels;
  if (out.seen) {
    const double noise = observe::EstimateNoise(all) * all.radiance_unit;
    evidence.given = FitAsGiven(evidence, out);
    const double level = out.frames.frames.empty() ? evidence.given.brightest : out.frames.level;
    out.fits = out.rms <= std::max(kFitsNoise * noise, kFits * level);
    evidence.nothing_left = out.rms <= std::max(kFitsNoise * noise, kNothingLeft * level);
  }
  if (StopRequested(stop)) return out;
  // Odd frames among others that fit are those frames' matter.
  if (out.frames.odd > 0 && out.fits && !all_changes) return out;
  if (evidence.nothing_left && !all_changes) return out;
  Search(evidence, angles_deg).Run(out);
  return out;
}

}  // namespace turnlight::estimator::consistency
