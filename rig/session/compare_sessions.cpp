#include "rig/session/compare_sessions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/angles.h"
#include "base/file.h"
#include "base/format.h"
#include "base/parallel.h"
#include "base/sha256.h"
#include "rig/session/image_file.h"
#include "rig/session/picture_difference.h"
#include "rig/session/session.h"
#include "rig/session/session_fields.h"

namespace turnlight::rig {
namespace {

using nlohmann::json;

// What captures of one rig differ by that does not matter, where no file says something else: a
// lens's rounding, an
// encoder's last digits, poses from measured angles, outlines that noise moves.
constexpr double kLensShiftPx = 1e-6;
constexpr double kMeasuredAngleDeg = 0.01;
constexpr double kPoseRotationDeg = 0.001;
constexpr double kPoseShift = 1e-5;  // of the distance between camera and target
constexpr double kMaskShare = 0.001;

// A frame of each session that show the same angle.
struct FramePair {
  std::size_t a = 0;
  std::size_t b = 0;
};

struct FramePairs {
  std::vector<FramePair> pairs;
  std::vector<std::size_t> only_a, only_b;
};

FramePairs PairFrames(const Session& a, const Session& b) {
  FramePairs frames;
  if (a.frames.size() == b.frames.size()) {
    for (std::size_t i = 0; i < a.frames.size(); ++i) frames.pairs.push_back({i, i});
    return frames;
  }
  std::multimap<double, std::size_t> of_angle;
  for (std::size_t j = 0; j < b.frames.size(); ++j) {
    if (b.frames[j].angle_deg)
      of_angle.emplace(*b.frames[j].angle_deg, j);
    else
      frames.only_b.push_back(j);
  }
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    const auto found =
        a.frames[i].angle_deg ? of_angle.find(*a.frames[i].angle_deg) : of_angle.end();
    if (found == of_angle.end()) {
      frames.only_a.push_back(i);
      continue;
    }
    frames.pairs.push_back({i, found->second});
    of_angle.erase(found);
  }
  for (const auto& [angle, j] : of_angle) frames.only_b.push_back(j);
  return frames;
}

// The largest distance in the picture between where the two lenses see one direction; infinite
// where only one of them sees it.
double LargestLensShift(const calib::CameraModel& a, const calib::CameraModel& b) {
  constexpr int kSteps = 16;  // of the grid, along each side
  std::vector<Eigen::Vector2d> points;
  for (int y = 0; y <= kSteps; ++y)
    for (int x = 0; x <= kSteps; ++x)
      points.emplace_back(static_cast<double>(x) * (a.width() - 1) / kSteps,
                          static_cast<double>(y) * (a.height() - 1) / kSteps);
  std::vector<Eigen::Vector3d> rays = a.Unproject(points);
  const std::vector<Eigen::Vector2d> seen = b.Project(rays);
  double largest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!rays[i].allFinite()) continue;
    const double shift = (seen[i] - points[i]).norm();
    largest = std::max(largest, std::isfinite(shift) ? shift : INFINITY);
  }
  return largest;
}

json RadiometryToJson(const Session& session) {
  const calib::Radiometry& radiometry = session.radiometry;
  const auto or_null = [](const std::optional<double>& value) {
    return value ? json(*value) : json();
  };
  static const std::map<calib::Encoding, std::string> kWords{{calib::Encoding::kLinear, "linear"},
                                                             {calib::Encoding::kSrgb, "srgb"},
                                                             {calib::Encoding::kGamma, "gamma"},
                                                             {calib::Encoding::kCurve, "curve"}};
  json object{
      {"encoding", kWords.at(radiometry.encoding)},
      {"gamma", radiometry.encoding == calib::Encoding::kGamma ? json(radiometry.gamma) : json()},
      {"black", radiometry.black},
      {"white", radiometry.white},
      {"saturation", radiometry.SaturationDn()},
      {"reference_exposure_us", or_null(radiometry.reference_exposure_us)},
      {"reference_gain_db", or_null(radiometry.reference_gain_db)},
      {"white_balance", radiometry.white_balance},
      {"bayer", session.bayer ? json(*session.bayer) : json()}};
  // The noise only weighs pixels: what they mean is the same without it.
  object["curve"] =
      radiometry.encoding == calib::Encoding::kCurve ? json(radiometry.curve) : json();
  object["vignetting"] =
      radiometry.vignetting ? json(PrintVignetting(*radiometry.vignetting)) : json();
  return object;
}

Result<json> TargetToJson(const Session& session) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&session.target))
    return json{{"shape", "sphere"}, {"radius", sphere->radius}};
  if (const auto* plane = std::get_if<calib::PlaneShape>(&session.target))
    return json{
        {"shape", "plane"}, {"size", {plane->width, plane->height}}, {"sides", plane->sides}};
  const auto bytes = ReadFile(session.root / std::get<MeshFile>(session.target).path);
  if (!bytes) return Forward(bytes);
  return json{{"shape", "mesh"}, {"sha256", Sha256Hex(*bytes)}};
}

// What there is to compare of two pictures.
struct ComparedPictures {
  std::string problem;  // why they cannot be compared: they are different
  PictureDifference difference;
  std::optional<double> mask_share;  // of pixels that only one mask has; nothing without masks
};

Result<std::optional<cv::Mat1b>> ReadOptionalMask(const Session& session,
                                                  const std::optional<std::string>& path,
                                                  cv::Size size) {
  if (!path) return std::optional<cv::Mat1b>();
  auto mask = ReadMask(session.root / *path, size);
  if (!mask) return Forward(mask);
  return std::optional(std::move(*mask));
}

Result<ComparedPictures> ReadAndCompare(const Session& a, const Session& b, FramePair pair) {
  const FrameRecord& frame_a = a.frames[pair.a];
  const FrameRecord& frame_b = b.frames[pair.b];
  const auto image_a = ReadImage(a.root / frame_a.image);
  if (!image_a) return Forward(image_a);
  const auto image_b = ReadImage(b.root / frame_b.image);
  if (!image_b) return Forward(image_b);
  ComparedPictures compared;
  if (image_a->size() != image_b->size() || image_a->type() != image_b->type()) {
    compared.problem = "the pictures are of another size, depth or number of channels";
    return compared;
  }
  cv::Mat1b valid(image_a->size(), uchar{255});
  for (const auto& [session, frame] : {std::pair(&a, &frame_a), {&b, &frame_b}}) {
    const auto validity = ReadOptionalMask(*session, frame->validity, valid.size());
    if (!validity) return Forward(validity);
    if (*validity) valid &= **validity;
  }
  const auto mask_a = ReadOptionalMask(a, frame_a.mask, valid.size());
  if (!mask_a) return Forward(mask_a);
  const auto mask_b = ReadOptionalMask(b, frame_b.mask, valid.size());
  if (!mask_b) return Forward(mask_b);
  if (*mask_a && *mask_b)
    compared.mask_share = static_cast<double>(cv::countNonZero(**mask_a != **mask_b)) /
                          static_cast<double>((*mask_a)->total());
  compared.difference =
      ComparePictures(*image_a, *image_b, valid, a.radiometry, a.bayer.has_value());
  const bool equal = cv::norm(image_a->reshape(1), image_b->reshape(1), cv::NORM_INF) == 0.0;
  if (compared.difference.values == 0 && !equal)
    compared.problem = "no pixel is valid in both pictures and unsaturated in one, and they differ";
  return compared;
}

double RotationDeg(const calib::Pose& a, const calib::Pose& b) {
  // The angle from the chord, exact for small ones too.
  const double chord = (a.rotation - b.rotation).norm() / std::sqrt(2.0);
  return RadToDeg(2.0 * std::asin(std::min(1.0, 0.5 * chord)));
}

class SessionComparer {
 public:
  SessionComparer(const Session& a, const Session& b, const Tolerances& tolerances)
      : a_(a), b_(b), tolerances_(tolerances), frames_(PairFrames(a, b)) {}

  Result<Comparison> Compare() {
    comparison_.what = "sessions";
    const Status status = CompareHeads();
    if (!status) return Forward(status);
    const auto pictures = ComparePairs();
    if (!pictures) return Forward(pictures);
    std::size_t blocks = 0;
    for (const ComparedPictures& pair : *pictures) blocks += pair.difference.blocks;
    for (std::size_t i = 0; i < pictures->size(); ++i) {
      CompareRecords(frames_.pairs[i]);
      AddPictures(frames_.pairs[i], (*pictures)[i], blocks);
    }
    for (const std::size_t i : frames_.only_a) AddAlone("A", a_.frames[i], i);
    for (const std::size_t j : frames_.only_b) AddAlone("B", b_.frames[j], j);
    return std::move(comparison_);
  }

 private:
  void Add(ComparedQuantity quantity) { comparison_.quantities.push_back(std::move(quantity)); }

  void AddMeasured(const std::string& group, const std::string& word, const std::string& name,
                   double difference, double size) {
    ComparedQuantity quantity{.group = group, .quantity = word, .name = name};
    Judge(difference, std::nullopt, size, tolerances_.Of(word), quantity);
    Add(std::move(quantity));
  }

  Status CompareHeads() {
    const std::string group = "session";
    const auto lens = [](const Session& session) {
      return json{{"lens_model", session.camera->lens_model()},
                  {"size", {session.camera->width(), session.camera->height()}}};
    };
    Add(CompareEqual(group, "camera", lens(a_), lens(b_)));
    if (lens(a_) == lens(b_))
      AddMeasured(group, "camera_px", "lens, largest shift",
                  LargestLensShift(*a_.camera, *b_.camera),
                  std::max(a_.camera->width(), a_.camera->height()));
    const json radiometry_a = RadiometryToJson(a_), radiometry_b = RadiometryToJson(b_);
    for (const auto& [key, value] : radiometry_a.items())
      Add(CompareEqual("radiometry", key, value, radiometry_b[key]));
    Add(CompareEqual(group, "length unit", a_.length_unit, b_.length_unit));
    auto target_a = TargetToJson(a_);
    if (!target_a) return Forward(target_a);
    auto target_b = TargetToJson(b_);
    if (!target_b) return Forward(target_b);
    Add(CompareEqual(group, "target", *target_a, *target_b));
    Add(CompareEqual(group, "frames", a_.frames.size(), b_.frames.size()));
    return {};
  }

  Result<std::vector<ComparedPictures>> ComparePairs() const {
    std::vector<Result<ComparedPictures>> compared(frames_.pairs.size());
    ParallelFor(compared.size(),
                [&](std::size_t i) { compared[i] = ReadAndCompare(a_, b_, frames_.pairs[i]); });
    std::vector<ComparedPictures> pictures;
    for (auto& pair : compared) {
      if (!pair) return Forward(pair);
      pictures.push_back(std::move(*pair));
    }
    return pictures;
  }

  std::string LabelOf(FramePair pair) const {
    return FrameLabel(pair.a, a_.frames[pair.a].angle_deg) +
           (pair.a == pair.b ? "" : ", frame " + std::to_string(pair.b) + " of B");
  }

  void AddAlone(const std::string& side, const FrameRecord& frame, std::size_t index) {
    ComparedQuantity quantity{.group = FrameLabel(index, frame.angle_deg) + " of " + side,
                              .name = "frame"};
    (side == "A" ? quantity.a : quantity.b) = frame.image;
    quantity.verdict = Verdict::kDifferent;
    quantity.why = "this frame is in " + side + " only";
    Add(std::move(quantity));
  }

  void CompareRecords(FramePair pair) {
    const FrameRecord& a = a_.frames[pair.a];
    const FrameRecord& b = b_.frames[pair.b];
    const std::string group = LabelOf(pair);
    const auto number = [&](const char* word, const char* name, const std::optional<double>& of_a,
                            const std::optional<double>& of_b) {
      Add(CompareNumbers({.group = group, .quantity = word, .name = name}, {of_a, {}}, {of_b, {}},
                         tolerances_));
    };
    number("angle_deg", "angle", a.angle_deg, b.angle_deg);
    number("angle_measured_deg", "measured angle", a.angle_measured_deg, b.angle_measured_deg);
    number("exposure_us", "exposure", a.exposure.exposure_us, b.exposure.exposure_us);
    number("gain_db", "gain", a.exposure.gain_db, b.exposure.gain_db);
    const double distance = (a.X_WC.translation - a.X_WT.translation).norm();
    const auto pose = [&](const std::string& name, const calib::Pose& of_a,
                          const calib::Pose& of_b) {
      AddMeasured(group, "pose_rotation_deg", name + ", rotation", RotationDeg(of_a, of_b), 180.0);
      AddMeasured(group, "pose_shift", name + ", shift",
                  (of_a.translation - of_b.translation).norm(), distance);
    };
    pose("camera's pose", a.X_WC, b.X_WC);
    pose("target's pose", a.X_WT, b.X_WT);
  }

  // count: of how many values this is the largest.
  void AddPicture(const std::string& group, const std::string& word, const std::string& name,
                  double difference, double sigmas, std::size_t count,
                  const std::string& remark = "") {
    ComparedQuantity quantity{.group = group, .quantity = word, .name = name};
    Tolerance tolerance = tolerances_.Of(word);
    tolerance.sigmas = LimitOfLargest(*tolerance.sigmas, std::max<std::size_t>(count, 1));
    Judge(difference, std::max(0.0, sigmas), 1.0, tolerance, quantity);
    quantity.remark = remark;
    Add(std::move(quantity));
  }

  void AddPictures(FramePair pair, const ComparedPictures& compared, std::size_t blocks) {
    const std::string group = LabelOf(pair);
    const bool has_mask_a = a_.frames[pair.a].mask.has_value();
    const bool has_mask_b = b_.frames[pair.b].mask.has_value();
    if (has_mask_a != has_mask_b) Add(CompareEqual(group, "has a mask", has_mask_a, has_mask_b));
    if (compared.mask_share) AddMeasured(group, "mask", "mask", *compared.mask_share, 1.0);
    if (!compared.problem.empty()) {
      ComparedQuantity quantity{.group = group, .name = "picture"};
      quantity.a = a_.frames[pair.a].image;
      quantity.b = b_.frames[pair.b].image;
      quantity.verdict = Verdict::kDifferent;
      quantity.why = compared.problem;
      return Add(std::move(quantity));
    }
    const PictureDifference& found = compared.difference;
    const std::size_t count = frames_.pairs.size();
    const double brightness_sigmas =
        found.brightness_sigma > 0.0 ? std::abs(found.brightness) / found.brightness_sigma : 0.0;
    AddPicture(group, "brightness", "brightness", std::abs(found.brightness), brightness_sigmas,
               count, Format("B is %+.3g %% brighter", 100.0 * found.brightness));
    AddPicture(group, "picture_level", "levels of blocks", found.level_rms, found.level_sigmas,
               count);
    AddPicture(group, "picture_shift", "shifts of blocks", found.shift_rms_px, found.shift_sigmas,
               count, "something moved: was the table at this angle?");
    AddPicture(group, "picture_block", "largest block", found.largest, found.largest_sigmas, blocks,
               Format("at pixel (%d, %d)", found.largest_at.x, found.largest_at.y));
  }

  const Session& a_;
  const Session& b_;
  const Tolerances& tolerances_;
  FramePairs frames_;
  Comparison comparison_;
};

// A good session's hash.
Result<std::string> VerifiedContent(const std::filesystem::path& root) {
  const auto report = VerifySession(root);
  if (!report) return Forward(report);
  if (!report->problems.empty())
    return InputError(report->problems.front() + "; allowed is a session that `turnlight verify " +
                      root.string() + "` finds good");
  return report->content_sha256;
}

}  // namespace

const std::vector<QuantityWord>& SessionQuantities() {
  static const std::vector<QuantityWord> kWords{
      {"camera_px", {.absolute = kLensShiftPx}},
      {"angle_deg", {}},
      {"angle_measured_deg", {.absolute = kMeasuredAngleDeg}},
      {"exposure_us", {}},
      {"gain_db", {}},
      {"pose_rotation_deg", {.absolute = kPoseRotationDeg}},
      {"pose_shift", {.relative = kPoseShift}},
      {"mask", {.absolute = kMaskShare}},
      {"brightness", {}},
      {"picture_level", {}},
      {"picture_shift", {}},
      {"picture_block", {}}};
  return kWords;
}

Result<Comparison> CompareSessions(const std::filesystem::path& a, const std::filesystem::path& b,
                                   const Tolerances& tolerances) {
  const auto content_a = VerifiedContent(a);
  if (!content_a) return Forward(content_a);
  const auto content_b = VerifiedContent(b);
  if (!content_b) return Forward(content_b);
  if (*content_a == *content_b) {
    Comparison comparison;
    comparison.what = "sessions";
    comparison.content_sha256 = *content_a;
    return comparison;
  }
  const auto session_a = ReadSession(a);
  if (!session_a) return Forward(session_a);
  const auto session_b = ReadSession(b);
  if (!session_b) return Forward(session_b);
  return SessionComparer(*session_a, *session_b, tolerances).Compare();
}

}  // namespace turnlight::rig
