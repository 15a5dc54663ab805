#include "calib/calibrate/probe/probe_session.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "calib/calibrate/probe/outline.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Pixels: within the step from ball to background, where a mask's maker cut, or the steepest place.
constexpr double kMaskStep = 0.2;
constexpr double kEdgeStep = 0.15;

struct FramePicture {
  LinearImage linear;
  cv::Mat1b mask;  // empty: none
};

// The mask of the target alone: pixels that are not valid for the estimator, such as those that are
// clipped in all exposures, are highlights here.
Result<FramePicture> ReadPicture(const rig::Session& session, std::size_t frame) {
  rig::Session without = session;
  for (rig::FrameRecord& record : without.frames) record.validity.reset();
  const auto images = rig::ReadFrameImages(without, frame);
  if (!images) return Forward(images);
  FramePicture picture{Linearise(images->image, session.radiometry, session.frames[frame].exposure),
                       {}};
  if (session.frames[frame].mask) picture.mask = images->mask;
  return picture;
}

cv::Mat1f GreyPicture(const cv::Mat& radiance) {
  cv::Mat1f grey;
  if (radiance.channels() == 1)
    radiance.copyTo(grey);
  else
    cv::transform(radiance, grey, cv::Matx13f(1.0f / 3, 1.0f / 3, 1.0f / 3));
  return grey;
}

// One place in T from those of all frames, each with its covariance.
struct PlaceInT {
  Matrix3d weights = Matrix3d::Zero();
  Vector3d sum = Vector3d::Zero();
  std::vector<std::pair<Vector3d, Matrix3d>> seen;

  void Add(const Vector3d& place, const Matrix3d& covariance) {
    const Matrix3d weight = covariance.inverse();
    weights += weight;
    sum += weight * place;
    seen.emplace_back(place, weight);
  }
  Vector3d Mean() const { return weights.inverse() * sum; }
  // The larger of what the outlines' sigmas say and what the frames disagree by. What all frames
  // share, the step of their outlines, does not become less by their number.
  Matrix3d Covariance() const {
    const Vector3d mean = Mean();
    double chi_squared = 0.0;
    for (const auto& [place, weight] : seen)
      chi_squared += (place - mean).dot(weight * (place - mean));
    const double freedom = 3.0 * static_cast<double>(seen.size()) - 3.0;
    const double scatter = freedom > 0.0 ? chi_squared / freedom : 1.0;
    return std::max(1.0, scatter) * weights.inverse();
  }
};

Status Outline(const FramePicture& picture, const std::string& label, const Pose& X_TC,
               BallView& view, PlaceInT& place) {
  const Vector3d guess_C = view.X_WC.Inverse() * view.ball.center;
  const bool masked = !picture.mask.empty();
  const auto points = masked ? MaskOutline(picture.mask)
                             : EdgeOutline(GreyPicture(picture.linear.radiance), *view.camera,
                                           guess_C, view.ball.radius);
  const auto ball =
      FitOutline(points, *view.camera, view.ball.radius, masked ? kMaskStep : kEdgeStep, label);
  if (!ball) return Forward(ball);
  place.Add(X_TC * ball->center_C, X_TC.rotation * ball->covariance * X_TC.rotation.transpose());
  return {};
}

// Moves each view's ball.
template <typename Move>
void AddPerturbation(const std::string& item, const std::vector<BallView>& views, const Move& move,
                     std::vector<Perturbation>& perturbations) {
  Perturbation perturbation{item, views};
  for (std::size_t i = 0; i < views.size(); ++i) move(i, perturbation.views[i]);
  perturbations.push_back(std::move(perturbation));
}

// Steps of one sigma along the axes of a covariance.
std::vector<Eigen::VectorXd> StepsOf(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  std::vector<Eigen::VectorXd> steps;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i)
    if (eigen.eigenvalues()[i] > 0.0)
      steps.push_back(std::sqrt(eigen.eigenvalues()[i]) * eigen.eigenvectors().col(i));
  return steps;
}

// R -> Exp(w) R, t -> t + d, of a step (w, d).
Pose Moved(const Pose& pose, const Eigen::VectorXd& step) {
  const double angle = step.head<3>().norm();
  Pose moved = pose;
  if (angle > 0.0) moved.rotation = Turn(step.head<3>() / angle, angle).rotation * pose.rotation;
  moved.translation += step.tail<3>();
  return moved;
}

// The ball of a table that stands otherwise than the calibration says.
void AddTable(const std::string& item, const rig::Session& session, ProbeSession& probe,
              const TurntableGeometry& before, const TurntableGeometry& after) {
  AddPerturbation(
      item, probe.views,
      [&](std::size_t i, BallView& view) {
        const double angle = session.frames[i].angle_measured_deg.value_or(
            session.frames[i].angle_deg.value_or(0.0));
        view.ball.center =
            PosesAt(after, angle).X_WT * (PosesAt(before, angle).X_WT.Inverse() * view.ball.center);
      },
      probe.perturbations);
}

Status AddCalibration(const rig::RigCalibration& calibration, bool ball_from_outline,
                      ProbeSession& probe) {
  const rig::Session& session = *probe.session;
  if (calibration.length_unit != session.length_unit)
    return InputError(calibration.source + ": length_unit: \"" + calibration.length_unit +
                      "\", allowed is the session's, \"" + session.length_unit + "\"");
  const auto& covariances = calibration.covariances;
  if (covariances.X_WC)
    for (const auto& step : StepsOf(*covariances.X_WC))
      AddPerturbation(
          "camera pose", probe.views,
          [&](std::size_t, BallView& view) {
            const Vector3d center_C = view.X_WC.Inverse() * view.ball.center;
            view.X_WC = Moved(view.X_WC, step);
            if (ball_from_outline) view.ball.center = view.X_WC * center_C;
          },
          probe.perturbations);
  if (ball_from_outline) return {};
  const TurntableGeometry& geometry = calibration.geometry;
  if (covariances.X_WA)
    for (const auto& step : StepsOf(*covariances.X_WA)) {
      TurntableGeometry moved = geometry;
      moved.X_WA = Moved(moved.X_WA, step);
      AddTable("table axis", session, probe, geometry, moved);
    }
  if (covariances.X_AT)
    for (const auto& step : StepsOf(*covariances.X_AT)) {
      TurntableGeometry moved = geometry;
      moved.X_AT = Moved(moved.X_AT, step);
      AddTable("ball's place on the table", session, probe, geometry, moved);
    }
  return {};
}

void AddBall(const ProbeOptions& options, const Matrix3d& covariance_T, ProbeSession& probe) {
  const auto& frames = probe.session->frames;
  for (const auto& step : StepsOf(covariance_T))
    AddPerturbation(
        "ball centre", probe.views,
        [&](std::size_t i, BallView& view) {
          view.ball.center += frames[i].X_WT.rotation * Vector3d(step);
        },
        probe.perturbations);
  if (options.radius_sigma > 0.0)
    AddPerturbation(
        "ball radius", probe.views,
        [&](std::size_t, BallView& view) {
          const double ratio = 1.0 + options.radius_sigma / view.ball.radius;
          view.ball.radius *= ratio;
          // An outline is that of a larger ball further away.
          if (options.sphere_from_outline)
            view.ball.center =
                view.X_WC.translation + ratio * (view.ball.center - view.X_WC.translation);
        },
        probe.perturbations);
}

// Takes the pictures in, and the ball's places if they are asked for.
Status ReadFrames(const ProbeOptions& options, const std::function<bool()>& step,
                  ProbeSession& probe, std::vector<FramePicture>& pictures, PlaceInT& place) {
  const rig::Session& session = *probe.session;
  const double radius = std::get<SphereShape>(session.target).radius;
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    const rig::FrameRecord& frame = session.frames[i];
    auto picture = ReadPicture(session, i);
    if (!picture) return Forward(picture);
    BallView view{&*session.camera, probe.rays.get(), frame.X_WC, {frame.X_WT.translation, radius}};
    if (options.sphere_from_outline) {
      const std::string label = session.root.string() + ": " + rig::FrameLabel(i, frame.angle_deg);
      const Status status =
          Outline(*picture, label, frame.X_WT.Inverse() * frame.X_WC, view, place);
      if (!status) return status;
    }
    probe.views.push_back(view);
    probe.pictures.push_back(picture->linear.radiance);
    pictures.push_back(std::move(*picture));
    if (!step()) return InterruptedError();
  }
  return {};
}

void Note(const SpotsFound& found, const std::string& label, std::vector<std::string>& notes) {
  constexpr double kMuchClipped = 0.02;
  if (!found.ball_seen)
    notes.push_back(label + ": the ball is not in the picture, or hidden, or too small");
  else if (found.clipped_share > kMuchClipped)
    notes.push_back(label + Format(": %.0f %% of the ball are clipped and no lamps: a shorter "
                                   "exposure shows what is in there",
                                   100.0 * found.clipped_share));
}

}  // namespace

Result<ProbeSession> ReadProbeSession(const std::filesystem::path& folder,
                                      const ProbeOptions& options,
                                      const std::function<bool()>& step) {
  auto session = rig::ReadSession(folder);
  if (!session) return Forward(session);
  if (!std::holds_alternative<SphereShape>(session->target))
    return InputError((folder / rig::kSessionFile).string() +
                      ": target/shape: no sphere, allowed is a mirror ball: a sphere of known "
                      "radius");
  ProbeSession probe;
  probe.session = std::make_unique<rig::Session>(std::move(*session));
  probe.rays = std::make_unique<RayGrid>(*probe.session->camera);
  std::vector<FramePicture> pictures;
  PlaceInT place;
  if (const Status status = ReadFrames(options, step, probe, pictures, place); !status)
    return Forward(status);
  Matrix3d covariance = options.center_sigma * options.center_sigma * Matrix3d::Identity();
  if (options.sphere_from_outline) {
    covariance = place.Covariance();
    probe.center_T = place.Mean();
    probe.center_sigma_T = covariance.diagonal().cwiseSqrt();
    for (std::size_t i = 0; i < probe.views.size(); ++i)
      probe.views[i].ball.center = probe.session->frames[i].X_WT * *probe.center_T;
  }
  AddBall(options, covariance, probe);
  if (options.calibration)
    if (const Status status =
            AddCalibration(*options.calibration, options.sphere_from_outline, probe);
        !status)
      return Forward(status);
  for (std::size_t i = 0; i < probe.views.size(); ++i) {
    const SpotsFound found = FindSpots(pictures[i].linear, pictures[i].mask, probe.views[i]);
    Note(found, rig::FrameLabel(i, probe.session->frames[i].angle_deg), probe.notes);
    probe.spots.push_back(found.spots);
    if (!step()) return InterruptedError();
  }
  return probe;
}

ProbeInput Joined(const std::vector<ProbeSession>& sessions) {
  ProbeInput joined;
  for (const ProbeSession& session : sessions) {
    joined.views.insert(joined.views.end(), session.views.begin(), session.views.end());
    joined.spots.insert(joined.spots.end(), session.spots.begin(), session.spots.end());
  }
  std::size_t first = 0;
  for (const ProbeSession& session : sessions) {
    for (const Perturbation& perturbation : session.perturbations) {
      Perturbation whole{perturbation.item, joined.views};
      std::copy(perturbation.views.begin(), perturbation.views.end(),
                whole.views.begin() + static_cast<std::ptrdiff_t>(first));
      joined.perturbations.push_back(std::move(whole));
    }
    first += session.views.size();
  }
  return joined;
}

}  // namespace turnlight::calib::calibrate::probe
