#include "estimator/from_session/frame_doubts.h"

#include <algorithm>
#include <utility>

#include "base/format.h"
#include "base/messages/messages.h"
#include "base/statistics.h"
#include "estimator/consistency/oddness.h"
#include "estimator/from_session/session_keyframe.h"
#include "estimator/notes.h"
#include "estimator/residual_maps.h"

namespace turnlight::estimator::from_session {
namespace {

constexpr std::size_t kMostNamed = 6;  // odd frames in a note
constexpr std::size_t kMostAlike = 2;

std::string NameOf(const rig::Session& session, std::size_t frame) {
  const rig::FrameRecord& record = session.frames[frame];
  return rig::FrameLabel(frame, record.angle_deg) + ", " + record.image;
}

}  // namespace

SmallCopies::SmallCopies(const rig::Session& session, const std::vector<std::size_t>& frames,
                         const std::vector<calib::RigPoses>& poses,
                         const target::Geometry& geometry)
    : frames_(frames),
      views_{*session.camera, consistency::BlockFor(*session.camera, geometry, poses), {}} {
  views_.camera = session.camera->InBlocks(views_.block);
  views_.views.resize(frames.size());
  for (const std::size_t frame : frames)
    if (session.frames[frame].angle_deg) angles_deg_.push_back(*session.frames[frame].angle_deg);
  if (angles_deg_.size() != frames.size()) angles_deg_.clear();
}

void SmallCopies::Take(std::size_t keyframe, const model::Keyframe& full) {
  views_.views[keyframe] = consistency::MakeSmallView(full, views_.block, frames_[keyframe]);
  ++taken_;
}

bool CallsForACheck(const EstimateOutput& output, const consistency::SmallViews& views,
                    const target::Geometry& geometry) {
  if (Unexplained(output.estimate.rms, output.noise) || OneStandsOut(output.frame_rms)) return true;
  // Factors explain a frame that is darker than it should be.
  if (output.estimate.ToScene().flickers()) return true;
  const calib::RayGrid rays(views.camera);
  std::vector<double> masks = consistency::MasksOnTarget(views, geometry, rays);
  const double least = *std::min_element(masks.begin(), masks.end());
  return Median(masks) - least > consistency::kMaskStep;
}

std::vector<std::size_t> OddViews(const consistency::Consistency& found) {
  std::vector<std::size_t> out;
  if (found.change) return out;
  for (std::size_t k = 0; k < found.frames.frames.size(); ++k)
    if (found.frames.frames[k].odd) out.push_back(k);
  return out;
}

Note NoteOfOddFrames(const rig::Session& session, const std::vector<std::size_t>& frames,
                     const consistency::Consistency& found, bool left_out) {
  const std::vector<std::size_t> odd = OddViews(found);
  std::string list;
  for (std::size_t i = 0; i < std::min(odd.size(), kMostNamed); ++i)
    list += (i == 0 ? "" : "; ") + NameOf(session, frames[odd[i]]) + ", " +
            found.frames.frames[odd[i]].what;
  if (odd.size() > kMostNamed) list += Format("; and %zu more", odd.size() - kMostNamed);
  const std::string id = left_out ? "frames-left-out" : "frames-odd";
  return {id, messages::Text(id, {{"odd", std::to_string(odd.size())},
                                  {"frames", std::to_string(frames.size())},
                                  {"list", list}})};
}

std::string WordsOfChange(const consistency::Consistency& found) {
  const consistency::TriedChange& change = *found.change;
  std::string alike;
  for (std::size_t i = 0; i < std::min(found.alike.size(), kMostAlike); ++i)
    alike += (i == 0 ? " The pictures are explained equally well " : " and ") + found.alike[i];
  std::string words = change.words;
  words[0] = 'W';
  return messages::Text(found.rms > 0.0 ? "poses-doubtful" : "poses-doubtful/unseen",
                        {{"change", words},
                         {"before", Format("%.2g", found.rms)},
                         {"after", Format("%.2g", *change.rms)},
                         {"question", change.question},
                         {"alike", alike.empty() ? "" : alike + "."}});
}

Result<ModelCheck> CheckModel(const std::filesystem::path& folder, const StopFlag* stop) {
  const auto session = rig::ReadSession(folder);
  if (!session) return Forward(session);
  auto shape = rig::ReadTarget(*session);
  if (!shape) return Forward(shape);
  const target::Geometry geometry(std::move(*shape));
  std::vector<std::size_t> frames;
  std::vector<calib::RigPoses> poses;
  for (const rig::FrameRecord& frame : session->frames) {
    frames.push_back(frames.size());
    poses.push_back({frame.X_WC, frame.X_WT});
  }
  SmallCopies copies(*session, frames, poses, geometry);
  for (const std::size_t k : frames) {
    if (StopRequested(stop)) return InterruptedError();
    const auto keyframe = ReadKeyframe(*session, k);
    if (!keyframe) return Forward(keyframe);
    copies.Take(k, *keyframe);
  }
  ModelCheck out;
  out.frames_in_all = frames.size();
  out.found =
      consistency::CheckConsistency(copies.views(), copies.angles_deg(), geometry, {}, true, stop);
  if (StopRequested(stop)) return InterruptedError();
  for (std::size_t k = 0; k < out.found.frames.frames.size(); ++k)
    out.frames.push_back(
        {k, session->frames[k].angle_deg, session->frames[k].image, out.found.frames.frames[k]});
  return out;
}

}  // namespace turnlight::estimator::from_session
