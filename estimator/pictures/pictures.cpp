#include "estimator/pictures/pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "base/plot/canvas.h"
#include "base/statistics.h"
#include "estimator/pictures/correlation_picture.h"
#include "estimator/pictures/plots.h"
#include "estimator/pictures/sphere.h"
#include "estimator/pictures/view.h"
#include "estimator/target/renderer.h"

namespace turnlight::estimator::pictures {
namespace {

constexpr std::size_t kMaxKeyframes = 6;
constexpr int kMinPanelWidth = 480;
constexpr int kMaxPanelWidth = 960;

// The mean of each block of factor^2 values that are finite; `none` where there is none.
template <int kChannels>
cv::Mat ReducedMap(const cv::Mat& map, int factor, float none) {
  using Value = cv::Vec<float, kChannels>;
  cv::Mat result(map.rows / factor, map.cols / factor, map.type());
  for (int row = 0; row < result.rows; ++row) {
    for (int column = 0; column < result.cols; ++column) {
      for (int c = 0; c < kChannels; ++c) {
        double sum = 0.0;
        int count = 0;
        for (int y = row * factor; y < (row + 1) * factor; ++y) {
          for (int x = column * factor; x < (column + 1) * factor; ++x) {
            const float value = map.at<Value>(y, x)[c];
            if (!std::isfinite(value)) continue;
            sum += value;
            ++count;
          }
        }
        result.at<Value>(row, column)[c] = count > 0 ? static_cast<float>(sum / count) : none;
      }
    }
  }
  return result;
}

// A keyframe's picture in three channels at the size it is shown from; pixels that are not finite
// are black.
cv::Mat3f ColourPicture(const cv::Mat& radiance, int reduce) {
  cv::Mat colour = radiance;
  if (radiance.channels() == 1) cv::cvtColor(radiance, colour, cv::COLOR_GRAY2RGB);
  return ReducedMap<3>(colour, reduce, 0.0f);
}

// A block is target if any of it is.
cv::Mat1b ReducedMask(const cv::Mat1b& mask, int factor) {
  cv::Mat1b result(mask.rows / factor, mask.cols / factor);
  for (int row = 0; row < result.rows; ++row)
    for (int column = 0; column < result.cols; ++column)
      result(row, column) =
          cv::countNonZero(mask({column * factor, row * factor, factor, factor})) > 0 ? 255 : 0;
  return result;
}

std::string NumberedName(const char* stem, std::size_t keyframe) {
  char text[64];
  std::snprintf(text, sizeof text, "%s_%03zu.png", stem, keyframe);
  return text;
}

struct Panels {
  cv::Mat3f original, relit, sphere;
  cv::Mat1f coverage;
};

Panels MakePanels(const PictureView& view, const VirtualSphere& sphere, const cv::Mat3f& original,
                  const cv::Mat1b& mask) {
  const target::Rendering rendering =
      target::Render(view.scene, view.geometry, view.rays, view.X_WC, view.X_WT,
                     {.samples_per_side = view.samples_per_side, .cast_shadows = true});
  return {original, Relit(TakeApart(original, rendering.coverage, mask), rendering.radiance),
          InsertSphere(original, TakeApart(original, rendering.coverage), view, sphere),
          rendering.coverage};
}

// One exposure for all: the 99.5 percentile of the brightest channel on the target at 0.9.
double CommonExposure(const std::vector<Panels>& panels) {
  std::vector<float> on_target, anywhere;
  for (const Panels& panel : panels) {
    for (int row = 0; row < panel.original.rows; ++row) {
      for (int column = 0; column < panel.original.cols; ++column) {
        const cv::Vec3f& pixel = panel.original(row, column);
        const float brightest = std::max({pixel[0], pixel[1], pixel[2]});
        anywhere.push_back(brightest);
        if (panel.coverage(row, column) > 0.5f) on_target.push_back(brightest);
      }
    }
  }
  const double level =
      NearestRank(on_target.empty() ? std::move(anywhere) : std::move(on_target), 0.995);
  return level > 0.0 ? 0.9 / level : 1.0;
}

cv::Mat3b ComparisonPicture(const Panels& panels, double exposure, int enlarge,
                            std::size_t keyframe) {
  constexpr int kTop = 44, kGap = 16;
  const int width = panels.original.cols * enlarge, height = panels.original.rows * enlarge;
  cv::Mat3b page =
      plot::Page(3 * width + 2 * kGap + 2 * plot::kMargin, height + kTop + plot::kMargin);
  const std::pair<std::string, const cv::Mat3f*> parts[] = {
      {"Original, keyframe " + std::to_string(keyframe), &panels.original},
      {"Relit by the estimate", &panels.relit},
      {"Virtual sphere of the estimated material", &panels.sphere}};
  int x = plot::kMargin;
  for (const auto& [caption, radiance] : parts) {
    plot::DrawText(page, caption, {double(x), 0.5 * kTop}, plot::kCaption, plot::Align::kLeft);
    plot::Place(page, plot::ToDisplay(*radiance, exposure, enlarge), {x, kTop});
    x += width + kGap;
  }
  return page;
}

Status AddComparisons(const model::KeyframeSource& keyframes, const std::vector<std::size_t>& shown,
                      const target::Geometry& geometry, const calib::CameraModel& camera,
                      const model::Scene& scene, int reduce, int enlarge,
                      std::vector<NamedPicture>& pictures) {
  const calib::RayGrid rays(camera);
  const int samples = enlarge > 1 ? 6 : 4;  // enlarging shows the steps of an edge
  std::vector<model::Scene> scenes;
  for (const std::size_t i : shown) scenes.push_back(model::AtKeyframe(scene, i));
  std::vector<PictureView> views;
  views.reserve(shown.size());
  for (std::size_t v = 0; v < shown.size(); ++v) {
    const calib::RigPoses& poses = keyframes.poses[shown[v]];
    views.push_back({scenes[v], geometry, camera, rays, poses.X_WC, poses.X_WT, samples});
  }
  const std::vector<VirtualSphere> spheres = PlaceSpheres(views);
  std::vector<Panels> panels;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto keyframe = keyframes.read(shown[i]);
    if (!keyframe) return Forward(keyframe);
    panels.push_back(MakePanels(views[i], spheres[i],
                                ColourPicture(keyframe->image.radiance, reduce),
                                ReducedMask(keyframe->mask, reduce)));
  }
  const double exposure = CommonExposure(panels);
  for (std::size_t i = 0; i < shown.size(); ++i)
    pictures.push_back({NumberedName("comparison", shown[i]),
                        ComparisonPicture(panels[i], exposure, enlarge, shown[i])});
  return {};
}

// Frames that were left out are shown in the range of the others.
void AddResiduals(const EstimateOutput& output, int reduce, int enlarge,
                  std::vector<NamedPicture>& pictures) {
  const auto reduced = [&](const cv::Mat1f& map) {
    return ReducedMap<1>(map, reduce, std::numeric_limits<float>::quiet_NaN());
  };
  std::vector<cv::Mat1f> maps;
  for (const auto& [keyframe, map] : output.residuals) maps.push_back(reduced(map));
  const double range = ResidualRange(maps);
  std::size_t at = 0;
  for (const auto& [keyframe, map] : output.residuals)
    pictures.push_back(
        {NumberedName("residual", keyframe),
         ResidualPicture(maps[at++], range, enlarge,
                         "Observed minus model, keyframe " + std::to_string(keyframe))});
  for (const auto& [frame, map] : output.left_out)
    pictures.push_back({NumberedName("residual_left_out", frame),
                        ResidualPicture(reduced(map), range, enlarge,
                                        "Observed minus model, frame " + std::to_string(frame) +
                                            " of the session, left out")});
}

}  // namespace

std::vector<std::size_t> ShownKeyframes(std::size_t count) {
  const std::size_t shown = std::min(count, kMaxKeyframes);
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < shown; ++i) result.push_back(i * count / shown);
  return result;
}

Result<std::vector<NamedPicture>> MakePictures(const model::KeyframeSource& keyframes,
                                               const target::Geometry& geometry,
                                               const calib::CameraModel& camera,
                                               const EstimateOutput& output) {
  std::vector<NamedPicture> pictures;
  const int reduce = (camera.width() + kMaxPanelWidth - 1) / kMaxPanelWidth;
  const int width = camera.width() / reduce;
  const int enlarge = (kMinPanelWidth + width - 1) / width;
  const std::vector<std::size_t> shown = ShownKeyframes(keyframes.size());
  if (!shown.empty()) {
    const Status status = AddComparisons(keyframes, shown, geometry, camera.InBlocks(reduce),
                                         output.estimate.ToScene(), reduce, enlarge, pictures);
    if (!status) return Forward(status);
  }
  AddResiduals(output, reduce, enlarge, pictures);
  if (!output.map.intensity.empty())
    pictures.push_back({"intensity_map.png", IntensityPicture(output.map, output.estimate.lights)});
  if (!output.estimate.history.empty())
    pictures.push_back({"convergence.png", ConvergencePicture(output.estimate.history)});
  if (HasCorrelationPicture(output.estimate.correlation))
    pictures.push_back({"correlation.png", CorrelationPicture(output.estimate.correlation)});
  return pictures;
}

}  // namespace turnlight::estimator::pictures
