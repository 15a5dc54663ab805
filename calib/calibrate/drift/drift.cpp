#include "calib/calibrate/drift/drift.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/parallel.h"
#include "calib/calibrate/drift/chi_square.h"
#include "calib/calibrate/drift/hypothesis.h"
#include "calib/calibrate/drift/quantities.h"

namespace turnlight::calib::calibrate::drift {
namespace {

constexpr double kDifferentDeg = 5.0;  // angles that tell the axis
constexpr double kWorstNoise = 3.0;    // pixels; no detector and no lens is so bad
constexpr double kFewestUsed = 0.6;    // of the points
constexpr double kStandsOut = 3.0;     // sigmas
// What is left unexplained: likely by chance, or this share of all.
constexpr double kLeftChance = 1e-3, kLeftShare = 0.02;
constexpr double kSomeChance = 0.05;  // beyond it a cause is none
// Findings fit as well as the best if their misfits, with 2 for each of their numbers (Akaike), are
// as near: odds of 400.
constexpr double kAsWell = 12.0;
// A check that sees no less than this is of no use, as the axis's calibration has it.
constexpr double kWorstDirectionDeg = 1.0, kWorstPlace = 0.01;
constexpr double kUnlikelyFocalPercent = 3.0;

// Sights, and everything that is the same for all hypotheses.
struct Trial {
  const Sights& sights;
  const rig::RigCalibration& stored;
  std::vector<Cause> causes;
  Nuisances nuisances;
  Sifted sifted;
};

std::vector<HypothesisFit> FitAll(const Trial& trial,
                                  const std::vector<std::vector<Cause>>& hypotheses) {
  std::vector<HypothesisFit> fits(hypotheses.size());
  ParallelFor(hypotheses.size(), [&](std::size_t i) {
    fits[i] = FitHypothesis(trial.sights, {hypotheses[i]}, trial.nuisances, trial.sifted);
  });
  return fits;
}

int WholeFreedom(double freedom) { return std::max(1, static_cast<int>(std::lround(freedom))); }

// nothing: the fit without drift; all: the one with every cause.
Finding FindingOf(const HypothesisFit& fit, const HypothesisFit& nothing, const HypothesisFit& all,
                  const rig::RigCalibration& stored) {
  Finding finding;
  finding.causes = fit.hypothesis.causes;
  finding.gain = std::max(0.0, nothing.misfit - fit.misfit);
  finding.freedom = WholeFreedom(fit.freedom);
  finding.chance = ChiSquareTail(finding.gain, finding.freedom);
  const double left = std::max(0.0, fit.misfit - all.misfit);
  finding.left_chance =
      ChiSquareTail(left, std::max(1, WholeFreedom(all.freedom) - finding.freedom));
  finding.explains = finding.left_chance >= kLeftChance ||
                     left < kLeftShare * std::max(0.0, nothing.misfit - all.misfit);
  finding.quantities = QuantitiesOf(fit, stored);
  return finding;
}

// A camera that is touched is more frequent than a lens that changes, by odds of 20: a camera that
// turned looks much as a lens whose centre moved.
constexpr double kLensIsRare = 6.0;

double Price(const Finding& finding) {
  const bool lens = std::count(finding.causes.begin(), finding.causes.end(), Cause::kLens) > 0;
  return 2.0 * finding.freedom - finding.gain + (lens ? kLensIsRare : 0.0);
}

// The best of those that explain the drift, and those as good. Whether there is one.
bool Choose(const std::vector<Finding>& findings, DriftReport& report) {
  std::vector<Finding> good;
  for (const Finding& finding : findings)
    if (finding.explains && finding.chance < kSomeChance) good.push_back(finding);
  if (good.empty()) return false;
  std::stable_sort(good.begin(), good.end(),
                   [](const Finding& a, const Finding& b) { return Price(a) < Price(b); });
  report.found = good.front();
  for (std::size_t i = 1; i < good.size(); ++i)
    if (Price(good[i]) < Price(good.front()) + kAsWell) report.as_well.push_back(good[i]);
  return true;
}

std::vector<std::vector<Cause>> Pairs(const std::vector<Cause>& causes) {
  std::vector<std::vector<Cause>> pairs;
  for (std::size_t i = 0; i < causes.size(); ++i)
    for (std::size_t j = i + 1; j < causes.size(); ++j) pairs.push_back({causes[i], causes[j]});
  return pairs;
}

void FindCauses(const Trial& trial, const HypothesisFit& nothing, const HypothesisFit& all,
                DriftReport& report) {
  if (Choose(report.alone, report)) return;
  std::vector<Finding> pairs;
  for (const HypothesisFit& fit : FitAll(trial, Pairs(trial.causes)))
    pairs.push_back(FindingOf(fit, nothing, all, trial.stored));
  if (!Choose(pairs, report)) report.found = report.everything;
}

const Quantity* Find(const Finding& finding, const std::string& key) {
  for (const Quantity& quantity : finding.quantities)
    if (quantity.key == key) return &quantity;
  return nullptr;
}

// A view most of whose points are outliers.
std::string LostView(const Trial& trial, const HypothesisFit& all) {
  std::vector<double> balance(trial.sights.views.size(), 0.0);
  for (std::size_t i = 0; i < all.residuals.size(); ++i)
    balance[all.residuals[i].view] += trial.sifted.used[i] ? 1.0 : -1.0;
  for (std::size_t v = 0; v < balance.size(); ++v)
    if (balance[v] < 0.0) return trial.sights.views[v].label;
  return "";
}

// Why the pictures are none of this rig and board or target, if they are not.
std::string WhyUnfit(const Trial& trial, const HypothesisFit& all, const DriftReport& report) {
  double used = 0.0;
  for (const bool one : trial.sifted.used) used += one ? 1.0 : 0.0;
  const std::string what = trial.sights.object_free ? "board" : "target";
  const double share = used / static_cast<double>(trial.sifted.used.size());
  if (report.noise > kWorstNoise || share < kFewestUsed)
    return Format(
        "no change of camera, lens or angles makes the pictures fit: %.0f %% of the "
        "points are used, they are %.2g px off (allowed are at least %.0f %% and at most "
        "%.0f px). Is it this %s, did it move between the pictures, are the angles theirs?",
        100.0 * share, report.noise, 100.0 * kFewestUsed, kWorstNoise, what.c_str());
  const std::string lost = LostView(trial, all);
  if (!lost.empty())
    return lost + ": most of its points do not fit the other pictures, whatever changed. Did the " +
           what + " move between the pictures, is the angle its own?";
  return "";
}

// Why pictures that show no drift would not have shown one, if they would not.
std::string WhyBlind(const Trial& trial, const DriftReport& report) {
  const std::string what = trial.sights.object_free ? "board" : "target";
  for (const Finding& finding : report.alone) {
    if (finding.causes.front() != Cause::kCamera) continue;
    const Quantity* direction = Find(finding, "axis_direction_deg");
    const Quantity* place = Find(finding, "axis_place");
    const double worst = kWorstPlace * CameraDistance(trial.stored);
    if (direction && place && direction->sigma <= kWorstDirectionDeg && place->sigma <= worst)
      return "";
    return Format(
        "the pictures tell too little of the camera: sigma of the axis's direction is "
        "%.2g deg (allowed is %.2g), of its place %.2g %s (%.2g); take more pictures, at "
        "angles farther apart, of a larger %s",
        direction ? direction->sigma : INFINITY, kWorstDirectionDeg,
        place ? place->sigma : INFINITY, report.length_unit.c_str(), worst, what.c_str());
  }
  return "";
}

// Corners have two residuals, points of outlines one.
std::vector<PointDrift> PointsOf(const std::vector<bool>& used, const HypothesisFit& stored,
                                 const HypothesisFit& found) {
  std::vector<PointDrift> points;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const placement::Residual& residual = stored.residuals[i];
    const Eigen::Vector2d before = residual.value * residual.normal;
    const Eigen::Vector2d after = found.residuals[i].value * found.residuals[i].normal;
    if (!used[i]) continue;
    if (!residual.edge && i % 2 == 1) {
      points.back().stored += before;
      points.back().found += after;
    } else {
      points.push_back({residual.view, residual.pixel, before, after});
    }
  }
  return points;
}

void SetPixels(const Trial& trial, const HypothesisFit& as_it_is, const HypothesisFit& found,
               DriftReport& report) {
  double sum = 0.0, moved = 0.0, count = 0.0;
  for (std::size_t i = 0; i < trial.sifted.used.size(); ++i) {
    if (!trial.sifted.used[i]) {
      if (as_it_is.residuals[i].edge || i % 2 == 0) ++report.outliers;
      continue;
    }
    const double value = as_it_is.residuals[i].value;
    sum += value * value;
    moved += std::pow(value - found.residuals[i].value, 2);
    count += 1.0;
  }
  report.stored_rms = std::sqrt(sum / std::max(1.0, count));
  report.moved_rms = std::sqrt(moved / std::max(1.0, count));
  report.points = PointsOf(trial.sifted.used, as_it_is, found);
  for (const PointDrift& point : report.points)
    report.worst = std::max(report.worst, point.stored.norm());
}

// Pixels, of the points used, with the fit of everything.
double NoiseOf(const Trial& trial, const HypothesisFit& all) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < trial.sifted.used.size(); ++i) {
    if (!trial.sifted.used[i]) continue;
    sum += all.residuals[i].value * all.residuals[i].value;
    count += 1.0;
  }
  return std::sqrt(sum / std::max(1.0, count - all.taken));
}

void AddRemarks(const Trial& trial, DriftReport& report) {
  const auto missing = WithoutCovariance(trial.stored, !trial.sights.object_free);
  if (!missing.empty())
    report.remarks.push_back("the calibration has no covariance of " + Listed(missing) +
                             ": counted as exact, so that its own error may look like a drift");
  if (trial.sights.object_free && report.verdict == Verdict::kStillTrue)
    report.remarks.push_back(
        "a board that may lie anywhere does not tell whether the camera moved along the axis or "
        "went round it, nor whether the table lost its zero: the target's outlines do");
  if (report.verdict != Verdict::kDrifted) return;
  const Quantity* focal = Find(report.found, "focal_length_percent");
  if (focal && std::abs(focal->value) > kUnlikelyFocalPercent && trial.sights.object_free)
    report.remarks.push_back(
        "so large a change of the focal length may be a wrong size of the board's squares");
  if (!trial.sights.object_free && trial.sights.views.size() == 1)
    report.remarks.push_back(
        "one picture hardly tells the camera from the target: take two more, at other angles");
}

// Whether anything that the finding says is beyond what its sigma allows.
bool StandsOut(const Finding& finding) {
  return std::any_of(finding.quantities.begin(), finding.quantities.end(),
                     [](const Quantity& quantity) {
                       return std::abs(quantity.value) > kStandsOut * quantity.sigma;
                     });
}

// Small systematic errors of outlines add up to what is unlikely, and say nothing that is known.
void TakeBack(const Trial& trial, DriftReport& report) {
  report.remarks.push_back(
      Format("all deviations together are unlikely by chance (%.2g), but nothing stands out: no "
             "length or angle is beyond %g sigmas",
             report.found.chance, kStandsOut));
  report.found = {};
  report.why = WhyBlind(trial, report);
  report.verdict = report.why.empty() ? Verdict::kStillTrue : Verdict::kCannotTell;
}

DriftReport Check(Trial trial) {
  DriftReport report;
  report.length_unit = trial.stored.length_unit;
  report.left_out = trial.sights.left_out;
  for (const placement::View& view : trial.sights.views) report.views.push_back(view.label);
  trial.sifted = Sift(trial.sights, trial.causes, trial.nuisances);
  std::vector<std::vector<Cause>> hypotheses{{}, trial.causes};
  for (const Cause cause : trial.causes) hypotheses.push_back({cause});
  const auto fits = FitAll(trial, hypotheses);
  const HypothesisFit &nothing = fits[0], &all = fits[1];
  report.everything = FindingOf(all, nothing, all, trial.stored);
  for (std::size_t i = 2; i < fits.size(); ++i)
    report.alone.push_back(FindingOf(fits[i], nothing, all, trial.stored));
  report.noise = NoiseOf(trial, all);
  double least = report.everything.chance;
  for (const Finding& finding : report.alone) least = std::min(least, finding.chance);
  const bool drifted = least * static_cast<double>(report.alone.size() + 1) < kFalseAlarms;
  report.why = WhyUnfit(trial, all, report);
  if (report.why.empty() && !drifted) report.why = WhyBlind(trial, report);
  if (report.why.empty()) report.verdict = drifted ? Verdict::kDrifted : Verdict::kStillTrue;
  if (report.verdict == Verdict::kDrifted) FindCauses(trial, nothing, all, report);
  if (report.verdict == Verdict::kDrifted && !StandsOut(report.found)) TakeBack(trial, report);
  const HypothesisFit as_it_is =
      FitHypothesis(trial.sights, {{}, false}, trial.nuisances, trial.sifted);
  SetPixels(trial, as_it_is,
            report.verdict == Verdict::kDrifted
                ? FitHypothesis(trial.sights, {report.found.causes}, trial.nuisances, trial.sifted)
                : nothing,
            report);
  AddRemarks(trial, report);
  return report;
}

bool HasTwoAngles(const std::vector<placement::View>& views) {
  return std::any_of(views.begin(), views.end(), [&views](const placement::View& view) {
    return std::abs(std::remainder(view.angle_deg - views.front().angle_deg, 360.0)) >
           kDifferentDeg;
  });
}

}  // namespace

Result<DriftReport> CheckWithBoard(const rig::RigCalibration& calibration,
                                   const board::Board& board,
                                   const std::vector<axis::AxisView>& views,
                                   const DriftOptions& options) {
  const auto sights = SightsOfBoard(calibration, board, views);
  if (!sights) return Forward(sights);
  if (!HasTwoAngles(sights->views)) {
    DriftReport report;
    report.left_out = sights->left_out;
    for (const placement::View& view : sights->views) report.views.push_back(view.label);
    report.length_unit = calibration.length_unit;
    report.why =
        "the board is seen at one angle of the table only, and may lie anywhere; allowed "
        "are at least two angles, some 60 degrees apart";
    return report;
  }
  return Check({*sights,
                calibration,
                {Cause::kCamera, Cause::kAngles, Cause::kLens},
                {options.angle_sigma_deg, 0.0, 0.0},
                {}});
}

Result<DriftReport> CheckWithOutlines(const rig::RigCalibration& calibration,
                                      const TargetShape& shape,
                                      const std::vector<placement::View>& views,
                                      const DriftOptions& options) {
  if (const Status status = rig::CheckTargetPlaced(calibration); !status) return Forward(status);
  const auto sights = SightsOfOutlines(calibration, shape, views);
  if (!sights) return Forward(sights);
  return Check({*sights,
                calibration,
                {kCauses.begin(), kCauses.end()},
                {options.angle_sigma_deg, options.edge_offset_sigma, options.shading_sigma},
                {}});
}

}  // namespace turnlight::calib::calibrate::drift
