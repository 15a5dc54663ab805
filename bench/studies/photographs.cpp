#include "bench/studies/photographs.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <set>
#include <utility>

#include "base/angles.h"
#include "base/file.h"
#include "base/random.h"
#include "bench/studies/session_score.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"

namespace turnlight::studies {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSeed = 16;
constexpr std::uint64_t kDraws = 20000;  // of all pairs of 100 lights each is met with four times
constexpr double kWhite = 65535.0;

struct SumsWanted {
  std::size_t lights;
  double apart_deg;
  std::size_t count;
};
constexpr SumsWanted kBallSums[] = {{2, 15.0, 24}, {3, 20.0, 16}, {4, 20.0, 12}};
constexpr SumsWanted kGraySums[] = {{2, 20.0, 12}};

// The sessions of a folder whose names begin so, sorted; without the folder none.
std::vector<fs::path> SessionsNamed(const fs::path& folder, const std::string& begin) {
  std::error_code error;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().filename().string().starts_with(begin) &&
        fs::exists(entry.path() / rig::kSessionFile))
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

// Every session that begins so is a scene of the set.
void AddAsTheyAre(const fs::path& folder, const std::string& begin, const std::string& set,
                  std::vector<PhotographScene>& scenes) {
  for (const fs::path& session : SessionsNamed(folder, begin))
    scenes.push_back({set + "/" + session.filename().string().substr(begin.size()), {session}});
}

// Adds sums of the singles. One that lies there as it is takes the place of the one made here.
Status AddSums(const std::vector<PhotographScene>& singles, const std::string& ball,
               const SumsWanted& sums, std::vector<PhotographScene>& scenes) {
  std::vector<Eigen::Vector3d> directions;
  for (const PhotographScene& single : singles) {
    const auto truth = ReadSessionTruth(single.sessions.front());
    if (!truth) return Forward(truth);
    if (truth->scene.lights.size() != 1)
      return InputError((single.sessions.front() / "truth.json").string() +
                        ": lights: allowed is one, in a photograph under a single light");
    directions.push_back(truth->scene.lights.front().direction);
  }
  for (const auto& chosen : ChooseApart(directions, sums.lights, sums.apart_deg, sums.count)) {
    PhotographScene scene{ball + "-" + std::to_string(sums.lights) + "/", {}};
    for (const std::size_t number : chosen) {
      const std::string& id = singles[number].id;
      scene.id += (scene.sessions.empty() ? "" : "_") + id.substr(id.find('/') + 1);
      scene.sessions.push_back(singles[number].sessions.front());
    }
    if (std::none_of(scenes.begin(), scenes.end(),
                     [&](const PhotographScene& other) { return other.id == scene.id; }))
      scenes.push_back(std::move(scene));
  }
  return {};
}

struct Photograph {
  rig::Session session;
  cv::Mat radiance;   // CV_64F, as many channels as the picture has
  cv::Mat1b clipped;  // 255, else 0; of each value, with all channels in a row
  cv::Mat1b mask;
};

Result<Photograph> ReadPhotograph(const fs::path& folder) {
  const auto session = rig::ReadSession(folder);
  if (!session) return Forward(session);
  const calib::Radiometry& radiometry = session->radiometry;
  if (session->frames.size() != 1 || radiometry.encoding != calib::Encoding::kLinear)
    return InputError((folder / rig::kSessionFile).string() +
                      ": allowed in a sum are one frame and the encoding \"linear\"");
  const auto images = rig::ReadFrameImages(*session, 0);
  if (!images) return Forward(images);
  Photograph photograph{*session, {}, {}, images->mask};
  images->image.convertTo(photograph.radiance, CV_64F);
  photograph.clipped = photograph.radiance.reshape(1) >= radiometry.SaturationDn();
  const double scale = 1.0 / (radiometry.white - radiometry.black);
  photograph.radiance.convertTo(photograph.radiance, CV_64F, scale, -radiometry.black * scale);
  return photograph;
}

// truth.json with the lights of all.
Status WriteTruth(const std::vector<fs::path>& sessions, const fs::path& folder) {
  Json lights = Json::array();
  for (const fs::path& session : sessions) {
    const auto truth = ReadSessionTruth(session);
    if (!truth) return Forward(truth);
    for (const estimator::model::Light& light : truth->scene.lights)
      lights.push_back(
          {{"direction", {light.direction.x(), light.direction.y(), light.direction.z()}}});
  }
  return WriteFileAtomic(folder / "truth.json", Json{{"lights", lights}}.dump() + "\n");
}

Status WriteFiles(const Photograph& sum, const std::vector<fs::path>& sessions,
                  const fs::path& folder) {
  rig::Session session = sum.session;
  session.name = folder.filename().string();
  session.calibration.reset();
  session.radiometry = {};
  session.radiometry.white = kWhite;
  rig::FrameRecord frame;
  frame.image = "frames/000.png";
  frame.mask = "frames/000.mask.png";
  frame.X_WC = sum.session.frames.front().X_WC;
  frame.X_WT = sum.session.frames.front().X_WT;
  session.frames = {frame};
  cv::Mat image;
  sum.radiance.convertTo(image, CV_16U, kWhite);
  Status status = MakeDirectory(folder / "frames");
  if (status) status = rig::WriteImage(folder / frame.image, image);
  if (status) status = rig::WriteImage(folder / *frame.mask, sum.mask);
  if (status) status = rig::WriteSession(session, folder);
  if (status) status = WriteTruth(sessions, folder);
  return status;
}

}  // namespace

Result<std::vector<PhotographScene>> PhotographScenes(const fs::path& data) {
  const fs::path glossy = data / "diligent_ball";
  std::vector<PhotographScene> balls, grays;
  AddAsTheyAre(glossy, "single_", "ball-1", balls);
  AddAsTheyAre(data, "uw_gray_", "gray-1", grays);
  if (balls.empty() && grays.empty())
    return InputError(data.string() +
                      ": neither sessions diligent_ball/single_* nor uw_gray_* in it");
  std::vector<PhotographScene> scenes = balls;
  for (const SumsWanted& sums : kBallSums) {
    const std::string lights = std::to_string(sums.lights);
    AddAsTheyAre(glossy, "sum" + lights + "_", "ball-" + lights, scenes);
    if (const Status status = AddSums(balls, "ball", sums, scenes); !status) return Forward(status);
  }
  scenes.insert(scenes.end(), grays.begin(), grays.end());
  for (const SumsWanted& sums : kGraySums)
    if (const Status status = AddSums(grays, "gray", sums, scenes); !status) return Forward(status);
  return scenes;
}

std::vector<std::vector<std::size_t>> ChooseApart(const std::vector<Eigen::Vector3d>& directions,
                                                  std::size_t lights, double apart_deg,
                                                  std::size_t wanted) {
  const RandomStream stream(kSeed, lights);
  const double most = std::cos(DegToRad(apart_deg));  // of two unit vectors' product
  std::set<std::vector<std::size_t>> chosen;
  for (std::uint64_t draw = 0; draw < kDraws && chosen.size() < wanted; ++draw) {
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < lights && !directions.empty(); ++i)
      numbers.push_back(static_cast<std::size_t>(stream.Uniform(draw * lights + i) *
                                                 static_cast<double>(directions.size())));
    std::sort(numbers.begin(), numbers.end());
    bool apart = !numbers.empty();
    for (std::size_t i = 0; i < numbers.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        apart &= directions[numbers[i]].dot(directions[numbers[j]]) <= most;
    if (apart) chosen.insert(numbers);
  }
  return {chosen.begin(), chosen.end()};
}

Status WriteSum(const std::vector<fs::path>& sessions, const fs::path& folder) {
  auto sum = ReadPhotograph(sessions.front());
  if (!sum) return Forward(sum);
  for (std::size_t i = 1; i < sessions.size(); ++i) {
    const auto next = ReadPhotograph(sessions[i]);
    if (!next) return Forward(next);
    if (next->radiance.size() != sum->radiance.size() ||
        next->radiance.type() != sum->radiance.type())
      return InputError(sessions[i].string() + ": its picture is not like that of " +
                        sessions.front().string() + ", allowed in a sum are those of one camera");
    sum->radiance += next->radiance;
    sum->clipped |= next->clipped;
    sum->mask &= next->mask;
  }
  sum->radiance /= static_cast<double>(sessions.size());
  cv::Mat values = sum->radiance.reshape(1);
  values.setTo(1.0, sum->clipped);
  return WriteFiles(*sum, sessions, folder);
}

}  // namespace turnlight::studies
