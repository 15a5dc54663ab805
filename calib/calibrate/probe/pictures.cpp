#include "calib/calibrate/probe/pictures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/angles.h"
#include "base/format.h"
#include "base/plot/chart.h"
#include "base/plot/sky_map.h"
#include "calib/calibrate/probe/lights_json.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRingRadius = 11.0;  // pixels of the page
constexpr int kLineHeight = 20;

cv::Mat3f ThreeChannels(const cv::Mat& radiance) {
  cv::Mat3f three;
  if (radiance.channels() == 3)
    radiance.copyTo(three);
  else
    cv::cvtColor(radiance, three, cv::COLOR_GRAY2RGB);
  return three;
}

// The part of the picture that shows the ball, with a margin.
cv::Rect BallBox(const BallView& view) {
  const Vector2d center = view.camera->Project({view.X_WC.Inverse() * view.ball.center}).front();
  const double reach = 1.15 * RadiusInPixels(view);
  const cv::Rect picture(0, 0, view.camera->width(), view.camera->height());
  if (!center.allFinite() || !(reach > 0.0)) return picture;
  const cv::Rect box(static_cast<int>(center.x() - reach), static_cast<int>(center.y() - reach),
                     static_cast<int>(2.0 * reach) + 1, static_cast<int>(2.0 * reach) + 1);
  const cv::Rect inside = box & picture;
  return inside.area() > 0 ? inside : picture;
}

struct Enlarged {
  cv::Rect box;   // of the picture
  cv::Rect area;  // of the page
  cv::Point2d ToPage(const Vector2d& pixel) const {
    const double scale = static_cast<double>(area.width) / box.width;
    return {area.x + (pixel.x() + 0.5 - box.x) * scale - 0.5,
            area.y + (pixel.y() + 0.5 - box.y) * scale - 0.5};
  }
};

void DrawCross(cv::Mat3b& page, const cv::Point2d& at) {
  constexpr double kArm = 5.0;
  plot::DrawOutlinedPath(page, {{at.x - kArm, at.y}, {at.x + kArm, at.y}});
  plot::DrawOutlinedPath(page, {{at.x, at.y - kArm}, {at.x, at.y + kArm}});
}

// One light in one view: its marks, and the line for the list.
std::string DrawLightsSpot(cv::Mat3b& page, const Enlarged& frame, const BallView& view,
                           const ProbeLight& light, int number, const Spot* spot) {
  const auto predicted = PixelOfLight(view, light.direction, light.inverse_distance);
  if (predicted) DrawCross(page, frame.ToPage(*predicted));
  std::string line = std::to_string(number) + ":  ";
  if (spot == nullptr) return line + "not seen here";
  const cv::Point2d at = frame.ToPage(spot->pixel);
  plot::DrawRing(page, at, kRingRadius);
  plot::DrawOutlinedText(page, std::to_string(number), {at.x + kRingRadius + 5, at.y},
                         plot::Align::kLeft);
  const double sigma = std::sqrt(0.5 * (spot->noise_covariance + spot->shape_covariance).trace());
  line += predicted ? Format("%.3f px from the prediction", (spot->pixel - *predicted).norm())
                    : std::string("predicted to be hidden");
  return line + Format(",  sigma %.3f px", sigma) + (spot->clipped ? ",  clipped" : "");
}

void DrawCandidates(cv::Mat3b& page, const Enlarged& frame, std::size_t view,
                    const std::vector<Spot>& spots, const ProbeLights& found) {
  for (const ProbeCandidate& candidate : found.candidates)
    for (const SpotIndex& index : candidate.spots)
      if (index.view == view)
        plot::DrawRing(page, frame.ToPage(spots[index.spot].pixel), 0.6 * kRingRadius);
}

// Adds a view's pixels to the cells of a map by direction.
void AddToSky(const BallView& view, const cv::Mat& radiance, cv::Mat1d& sum, cv::Mat1d& count) {
  const cv::Mat3f picture = ThreeChannels(radiance);
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const auto seen = MirrorOnBall(view.ball, view.X_WC.translation,
                                     view.X_WC.rotation * view.rays->Ray(column, row));
      constexpr double kLeast = 0.1;  // cosine: nearer to the outline a pixel sees too much
      if (!seen || seen->cosine < kLeast) continue;
      const Vector3d& d = seen->direction;
      const double azimuth = std::atan2(d.y(), d.x()) / (2.0 * std::numbers::pi);
      const double zenith = std::acos(std::clamp(d.z(), -1.0, 1.0)) / std::numbers::pi;
      const int x = std::min(
          sum.cols - 1, static_cast<int>((azimuth < 0.0 ? azimuth + 1.0 : azimuth) * sum.cols));
      const int y = std::min(sum.rows - 1, static_cast<int>(zenith * sum.rows));
      const cv::Vec3f& value = picture(row, column);
      const double grey = (value[0] + value[1] + value[2]) / 3.0;
      if (!std::isfinite(grey)) continue;
      sum(y, x) += grey;
      count(y, x) += 1.0;
    }
  }
}

}  // namespace

std::vector<std::size_t> ViewsToDraw(std::size_t views, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(views, most);
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(i * views / count);
  return chosen;
}

cv::Mat3b SpotsPicture(const std::vector<ProbeSession>& sessions, std::size_t view_index,
                       const ProbeLights& found) {
  const FrameOfView at = FindFrame(sessions, view_index);
  const ProbeSession& session = sessions[at.session];
  const BallView& view = session.views[at.frame];
  const cv::Rect box = BallBox(view);
  constexpr int kWanted = 640;
  const int enlarge = std::max(1, kWanted / std::max(box.width, box.height));
  const cv::Mat3f part = ThreeChannels(session.pictures[at.frame](box));
  const cv::Mat3b shown = plot::ToDisplay(part, 1.0, enlarge);
  const Enlarged frame{box, {{plot::kMargin, plot::kTitleHeight}, shown.size()}};
  constexpr int kLeastWidth = 560;
  const int lines = static_cast<int>(found.lights.size()) + 1;
  const int below = frame.area.y + frame.area.height + plot::kMargin;
  cv::Mat3b page = plot::Page(std::max(kLeastWidth, frame.area.width + 2 * plot::kMargin),
                              below + lines * kLineHeight + plot::kMargin / 2);
  plot::DrawTitle(page, plot::kMargin,
                  session.session->name + ", " +
                      rig::FrameLabel(at.frame, session.session->frames[at.frame].angle_deg));
  plot::Place(page, shown, frame.area.tl());
  const auto& spots = session.spots[at.frame];
  DrawCandidates(page, frame, view_index, spots, found);
  std::vector<std::string> words;
  for (std::size_t i = 0; i < found.lights.size(); ++i) {
    const ProbeLight& light = found.lights[i];
    const auto seen = std::find_if(light.spots.begin(), light.spots.end(),
                                   [&](const SpotIndex& s) { return s.view == view_index; });
    words.push_back(DrawLightsSpot(page, frame, view, light, static_cast<int>(i) + 1,
                                   seen == light.spots.end() ? nullptr : &spots[seen->spot]));
  }
  words.push_back(words.empty() ? "no compact highlight"
                                : "ring: spot;  cross: predicted;  small ring: candidate");
  for (std::size_t i = 0; i < words.size(); ++i)
    plot::DrawText(page, words[i],
                   {double(plot::kMargin), below + (static_cast<double>(i) + 0.5) * kLineHeight},
                   plot::kLabel, plot::Align::kLeft);
  return page;
}

cv::Mat3b SkyPicture(const std::vector<ProbeSession>& sessions, const ProbeLights& found,
                     const std::string& length_unit) {
  constexpr int kRows = 180;  // a degree each
  cv::Mat1d sum(kRows, 2 * kRows, 0.0), count(kRows, 2 * kRows, 0.0);
  for (const ProbeSession& session : sessions)
    for (std::size_t i = 0; i < session.views.size(); ++i)
      AddToSky(session.views[i], session.pictures[i], sum, count);
  cv::Mat1f map(kRows, 2 * kRows, std::numeric_limits<float>::quiet_NaN());
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.cols; ++column)
      if (count(row, column) > 0.0)
        map(row, column) =
            static_cast<float>(std::sqrt(std::max(0.0, sum(row, column) / count(row, column))));
  std::vector<plot::SkyMark> marks;
  for (std::size_t i = 0; i < found.lights.size(); ++i) {
    const ProbeLight& light = found.lights[i];
    std::string words = std::to_string(i + 1) + ":  " + plot::SkyAngles(light.direction) +
                        Format(",  sigma %.2g", RadToDeg(light.sigma.direction)) + "\xC2\xB0";
    if (light.near)
      words += Format(",  %.4g +- %.2g ", 1.0 / light.inverse_distance, light.sigma.distance) +
               length_unit + " away";
    marks.push_back({light.direction, 3.0 * light.sigma.direction, std::to_string(i + 1), words});
  }
  return plot::SkyMap(
      map,
      {"What the ball reflects, by direction, and the lights found", "root of the share of white"},
      marks);
}

}  // namespace turnlight::calib::calibrate::probe
