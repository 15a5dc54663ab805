#include "rig/capture/capture_plan.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "rig/session/session.h"

namespace turnlight::rig {
namespace {

constexpr double kMicro = 1e6;
constexpr int kDigits = 12;                  // microdegrees of many turns
constexpr std::int64_t kTurn = 360'000'000;  // microdegrees
// A small file's share on disk: its line in session.json, journal and provenance.
constexpr std::uint64_t kBytesOfLines = 4096;
constexpr std::uint64_t kBytesOfStart = 1 << 20;  // camera, config, headers

// A range of plain numbers: closed below unless above is set.
struct Bounds {
  const char* key;
  double value;
  double min;
  double max;
  bool above = false;
};

std::optional<PlanProblem> CheckBounds(const Bounds& bounds) {
  const bool low = bounds.above ? bounds.value > bounds.min : bounds.value >= bounds.min;
  if (low && bounds.value <= bounds.max) return std::nullopt;  // NaN is neither
  return PlanProblem{bounds.key,
                     NumberText(bounds.value, kDigits) + ", allowed is a number " +
                         (bounds.above ? "above " : "from ") + NumberText(bounds.min, kDigits) +
                         (bounds.above ? ", at most " : " to ") + NumberText(bounds.max, kDigits)};
}

std::int64_t ToMicro(double deg) { return std::llround(deg * kMicro); }

// The double nearest to the decimal number, as a person would have written it.
double ToDegrees(std::int64_t micro) { return static_cast<double>(micro) / kMicro; }

std::optional<PlanProblem> CheckDecimal(const char* key, double deg) {
  if (ToDegrees(ToMicro(deg)) == deg) return std::nullopt;
  return PlanProblem{key, NumberText(deg, kDigits) + ", allowed are at most 6 decimal places"};
}

std::int64_t Sign(const CapturePlan& plan) {
  return plan.direction == TurnDirection::kCcw ? 1 : -1;
}

std::int64_t Swept(const CapturePlan& plan) { return (plan.count - 1) * ToMicro(plan.step_deg); }

std::optional<PlanProblem> CheckNumbers(const CapturePlan& plan) {
  for (const Bounds& bounds : {
           Bounds{"start_deg", plan.start_deg, -36000.0, 36000.0},
           Bounds{"step_deg", plan.step_deg, 0.0, 360.0, true},
           Bounds{"count", static_cast<double>(plan.count), 1.0, 100000.0},
           Bounds{"backlash_deg", plan.backlash_deg, 0.0, 90.0},
           Bounds{"settle_ms", plan.settle_ms, 0.0, 60000.0},
           Bounds{"gain_db", plan.gain_db, -40.0, 80.0},
           Bounds{"retries", static_cast<double>(plan.retries), 0.0, 100.0},
           Bounds{"tolerance_deg", plan.tolerance_deg, 0.0, 5.0, true},
           Bounds{"move_timeout_s", plan.move_timeout_s, 0.0, 3600.0, true},
           Bounds{"frame_timeout_s", plan.frame_timeout_s, 0.0, 3600.0, true},
       })
    if (auto problem = CheckBounds(bounds)) return problem;
  for (const auto& [key, deg] : {std::pair("start_deg", plan.start_deg),
                                 {"step_deg", plan.step_deg},
                                 {"backlash_deg", plan.backlash_deg}})
    if (auto problem = CheckDecimal(key, deg)) return problem;
  return std::nullopt;
}

std::optional<PlanProblem> CheckExposures(const std::vector<double>& exposures_us) {
  if (exposures_us.empty() || exposures_us.size() > 16)
    return PlanProblem{"exposures_us", std::to_string(exposures_us.size()) +
                                           " exposures, allowed is a list of 1 to 16"};
  for (std::size_t i = 0; i < exposures_us.size(); ++i) {
    if (auto problem = CheckBounds({"exposures_us", exposures_us[i], 0.1, 1e8})) return problem;
    if (std::find(exposures_us.begin(), exposures_us.begin() + static_cast<std::ptrdiff_t>(i),
                  exposures_us[i]) != exposures_us.begin() + static_cast<std::ptrdiff_t>(i))
      return PlanProblem{"exposures_us", NumberText(exposures_us[i], kDigits) +
                                             " appears twice, allowed are different exposures"};
  }
  return std::nullopt;
}

// A picture of a bracket would have a pose of its own.
std::optional<PlanProblem> CheckByHand(const CapturePlan& plan) {
  if (plan.exposures_us.size() != 1)
    return PlanProblem{"exposures_us", std::to_string(plan.exposures_us.size()) +
                                           " exposures, allowed is one of a camera that is carried "
                                           "by hand"};
  if (plan.closure)
    return PlanProblem{"closure", "true, allowed is false of a camera that is carried by hand"};
  return CheckBounds({"step_deg", plan.step_deg, 0.0, 180.0, true});
}

std::optional<PlanProblem> CheckUntil(const CapturePlan& plan) {
  if (!plan.until) return std::nullopt;
  const UntilDirections& until = *plan.until;
  for (const Bounds& bounds :
       {Bounds{"until/direction_deg", until.direction_deg, 0.0, 45.0, true},
        Bounds{"until/most_extra", static_cast<double>(until.most_extra), 0.0, 1000.0}})
    if (auto problem = CheckBounds(bounds)) return problem;
  if (plan.closure)
    return PlanProblem{"until",
                       "beside closure: true, whose frame is the last one that is planned; allowed "
                       "is one of the two"};
  return std::nullopt;
}

// What only the whole plan shows.
std::optional<PlanProblem> CheckTogether(const CapturePlan& plan) {
  if (plan.tolerance_deg * 2.0 >= plan.step_deg)
    return PlanProblem{"tolerance_deg", NumberText(plan.tolerance_deg, kDigits) +
                                            ", allowed is less than half of step_deg, " +
                                            NumberText(plan.step_deg, kDigits) +
                                            ": neighbouring angles could not be told apart"};
  if (plan.closure && plan.count > 1 && Swept(plan) % kTurn == 0)
    return PlanProblem{"closure", "true, but the last of the " + std::to_string(plan.count) +
                                      " keyframes is at the start already, " +
                                      NumberText(ToDegrees(Swept(plan)), kDigits) +
                                      " deg later; allowed is one keyframe less, or false"};
  if (auto problem = CheckUntil(plan)) return problem;
  if (!plan.limits) return std::nullopt;
  const AngleLimits& limits = *plan.limits;
  const auto range = EstimatePlan(plan, {}, {}).range;
  if (!(limits.min_deg < limits.max_deg))
    return PlanProblem{"limits_deg", NumberText(limits.min_deg, kDigits) + " to " +
                                         NumberText(limits.max_deg, kDigits) +
                                         ", allowed is a lower end below the upper one"};
  if (range.min_deg < limits.min_deg || range.max_deg > limits.max_deg)
    return PlanProblem{
        "limits_deg",
        "the plan commands angles from " + NumberText(range.min_deg, kDigits) + " to " +
            NumberText(range.max_deg, kDigits) + " (with the approach), allowed by the table are " +
            NumberText(limits.min_deg, kDigits) + " to " + NumberText(limits.max_deg, kDigits)};
  return std::nullopt;
}

std::vector<double> ReadExposures(StrictObject& object) {
  std::vector<double> exposures_us;
  const nlohmann::json& list = object.Raw("exposures_us");
  bool fits = list.is_array();
  for (std::size_t i = 0; fits && i < list.size(); ++i) {
    fits = list[i].is_number();
    if (fits) exposures_us.push_back(list[i].get<double>());
  }
  if (!fits) object.Refuse("exposures_us", "a list of 1 to 16 exposures in microseconds");
  return exposures_us;
}

// At most, whatever the picture shows: encoders add little to incompressible data.
std::uint64_t PictureBytes(const PictureFormat& format, int depth, int channels) {
  const auto pixels = static_cast<std::uint64_t>(format.size.width) *
                      static_cast<std::uint64_t>(format.size.height);
  const std::uint64_t raw = pixels * static_cast<std::uint64_t>(CV_ELEM_SIZE1(depth)) *
                            static_cast<std::uint64_t>(channels);
  return raw + raw / 100 + static_cast<std::uint64_t>(format.size.height) * 16 + 4096;
}

}  // namespace

std::optional<PlanProblem> Validate(const CapturePlan& plan) {
  if (auto problem = CheckNumbers(plan)) return problem;
  if (auto problem = CheckExposures(plan.exposures_us)) return problem;
  return plan.by_hand ? CheckByHand(plan) : CheckTogether(plan);
}

namespace {

// What plans of both kinds have; then validates.
Result<CapturePlan> ReadRest(StrictObject& object, CapturePlan plan) {
  const auto number = [&object](const char* key, double& value) {
    value = object.OptionalNumber(key).value_or(value);
  };
  number("step_deg", plan.step_deg);
  number("gain_db", plan.gain_db);
  number("frame_timeout_s", plan.frame_timeout_s);
  plan.count = object.OptionalInteger("count", 1, 100000).value_or(plan.count);
  plan.retries = object.OptionalInteger("retries", 0, 100).value_or(plan.retries);
  if (object.Has("exposures_us")) plan.exposures_us = ReadExposures(object);
  if (object.ok())
    if (const auto problem = Validate(plan)) object.RefuseText(problem->key, problem->text);
  if (const Status status = object.Finish(); !status) return Forward(status);
  return plan;
}

}  // namespace

namespace {

Result<UntilDirections> ReadUntil(StrictObject object) {
  UntilDirections until;
  until.direction_deg = object.Number("direction_deg", {.max = 45.0, .above = 0.0});
  until.most_extra = object.OptionalInteger("most_extra", 0, 1000).value_or(until.most_extra);
  if (const Status status = object.Finish(); !status) return Forward(status);
  return until;
}

}  // namespace

Result<CapturePlan> ParsePlanByHand(StrictObject object) {
  CapturePlan plan;
  plan.by_hand = true;
  return ReadRest(object, plan);
}

Result<CapturePlan> ParseCapturePlan(StrictObject object) {
  CapturePlan plan;
  const auto number = [&object](const char* key, double& value) {
    value = object.OptionalNumber(key).value_or(value);
  };
  number("start_deg", plan.start_deg);
  number("backlash_deg", plan.backlash_deg);
  number("settle_ms", plan.settle_ms);
  number("tolerance_deg", plan.tolerance_deg);
  number("move_timeout_s", plan.move_timeout_s);
  plan.closure = object.OptionalBoolean("closure").value_or(plan.closure);
  if (object.OptionalChoice("direction", {"ccw", "cw"}) == "cw")
    plan.direction = TurnDirection::kCw;
  if (object.OptionalChoice("approach", {"one-sided", "direct"}) == "direct")
    plan.approach = Approach::kDirect;
  if (const auto limits = object.OptionalNumbers("limits_deg", 2))
    plan.limits = AngleLimits{(*limits)[0], (*limits)[1]};
  if (auto until = object.OptionalObject("until")) {
    auto read = ReadUntil(std::move(*until));
    if (!read) return Forward(read);
    plan.until = *read;
  }
  return ReadRest(object, plan);
}

std::string Label(const PlannedFrame& planned) {
  if (planned.by_hand) return FrameLabel(planned.index, std::nullopt);
  return FrameLabel(planned.index, planned.angle_deg, planned.closure);
}

std::vector<PlannedFrame> PlannedFrames(const CapturePlan& plan) {
  const std::int64_t start = ToMicro(plan.start_deg);
  const std::int64_t step = plan.by_hand ? 0 : Sign(plan) * ToMicro(plan.step_deg);
  std::vector<PlannedFrame> frames;
  for (std::int64_t i = 0; i < plan.count; ++i)
    frames.push_back(
        {static_cast<std::size_t>(i), ToDegrees(start + i * step), false, plan.by_hand});
  if (plan.closure) {
    const std::int64_t turns = Swept(plan) / kTurn + 1;  // the next whole one
    frames.push_back({frames.size(), ToDegrees(start + Sign(plan) * turns * kTurn), true});
  }
  return frames;
}

std::vector<double> ExtraAngles(const CapturePlan& plan, const std::vector<double>& taken_deg) {
  const std::int64_t start = ToMicro(plan.start_deg), step = ToMicro(plan.step_deg);
  const std::int64_t tolerance = ToMicro(plan.tolerance_deg);
  std::vector<double> all;
  for (std::int64_t quarter = 1; quarter * step < 4 * kTurn; ++quarter) {
    const double angle_deg = ToDegrees(start + Sign(plan) * (quarter * step / 4));
    const bool allowed =
        std::ranges::all_of(MoveLegs(plan, std::nullopt, angle_deg), [&](double leg) {
          return !plan.limits || (leg >= plan.limits->min_deg && leg <= plan.limits->max_deg);
        });
    const bool there = std::ranges::any_of(taken_deg, [&](double taken) {
      const std::int64_t apart = std::abs(ToMicro(taken) - ToMicro(angle_deg)) % kTurn;
      return std::min(apart, kTurn - apart) <= tolerance;
    });
    if (allowed && !there) all.push_back(angle_deg);
  }
  const std::size_t count = std::min(all.size(), kMostExtraAngles);
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(all[i * all.size() / count]);
  return out;
}

std::vector<double> MoveLegs(const CapturePlan& plan, std::optional<double> from_deg,
                             double angle_deg) {
  const std::int64_t backlash = ToMicro(plan.backlash_deg);
  if (plan.approach == Approach::kDirect || backlash == 0) return {angle_deg};
  const std::int64_t to = ToMicro(angle_deg);
  if (from_deg && (to - ToMicro(*from_deg)) * Sign(plan) >= backlash) return {angle_deg};
  return {ToDegrees(to - Sign(plan) * backlash), angle_deg};
}

double MoveSeconds(const TableKinematics& kinematics, double distance_deg) {
  const double distance = std::abs(distance_deg);
  const double speed = kinematics.speed_deg_per_s;
  const double acceleration = kinematics.acceleration_deg_per_s2;
  const double ramps = speed * speed / acceleration;  // both, when full speed is reached
  if (distance < ramps) return 2.0 * std::sqrt(distance / acceleration);
  return 2.0 * speed / acceleration + (distance - ramps) / speed;
}

PlanEstimate EstimatePlan(const CapturePlan& plan, const TableKinematics& kinematics,
                          const PictureFormat& format, double readout_s) {
  PlanEstimate estimate;
  double exposure_s = 0.0;
  for (const double exposure_us : plan.exposures_us) exposure_s += exposure_us * 1e-6 + readout_s;
  std::optional<double> at;
  estimate.range = {plan.start_deg, plan.start_deg};
  for (const PlannedFrame& frame : PlannedFrames(plan)) {
    for (const double leg :
         plan.by_hand ? std::vector<double>() : MoveLegs(plan, at, frame.angle_deg)) {
      const double distance = std::abs(leg - at.value_or(plan.start_deg));
      estimate.travel_deg += distance;
      estimate.seconds += MoveSeconds(kinematics, distance);
      estimate.range.min_deg = std::min(estimate.range.min_deg, leg);
      estimate.range.max_deg = std::max(estimate.range.max_deg, leg);
      at = leg;
    }
    estimate.seconds += (plan.by_hand ? 0.0 : plan.settle_ms * 1e-3) + exposure_s;
    ++estimate.frames;
  }
  estimate.exposures = estimate.frames * plan.exposures_us.size();
  const bool bracket = plan.exposures_us.size() > 1;
  estimate.bytes_per_frame =
      PictureBytes(format, bracket ? CV_32F : format.depth, format.channels) +
      (bracket ? PictureBytes(format, CV_8U, 1) : 0) + kBytesOfLines;
  estimate.bytes = estimate.frames * estimate.bytes_per_frame + kBytesOfStart;
  return estimate;
}

}  // namespace turnlight::rig
