// Frames and poses of a session that do not fit, as a reader is told of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/stop_flag.h"
#include "estimator/consistency/pose_doubts.h"
#include "estimator/consistency/small_views.h"
#include "estimator/estimate.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/target/geometry.h"
#include "rig/session/session.h"

namespace turnlight::estimator::from_session {

// Takes small copies of a session's keyframes while they are in memory.
class SmallCopies {
 public:
  // frames: of the session, as the keyframes have them.
  SmallCopies(const rig::Session& session, const std::vector<std::size_t>& frames,
              const std::vector<calib::RigPoses>& poses, const target::Geometry& geometry);
  void Take(std::size_t keyframe, const model::Keyframe& full);

  bool full() const { return taken_ == views_.views.size(); }  // all were taken
  const consistency::SmallViews& views() const { return views_; }
  // The session's angle of each view; empty if one has none.
  const std::vector<double>& angles_deg() const { return angles_deg_; }

 private:
  std::vector<std::size_t> frames_;
  consistency::SmallViews views_;
  std::vector<double> angles_deg_;
  std::size_t taken_ = 0;
};

// Whether what an estimate leaves, of all frames or of one, is more than noise, or one frame's mask
// lets through less of the target than the others'.
bool CallsForACheck(const EstimateOutput& output, const consistency::SmallViews& views,
                    const target::Geometry& geometry);

// Views that do not belong to the others, if no change of all poses explains them too.
std::vector<std::size_t> OddViews(const consistency::Consistency& found);

// The note about frames that were left out, or that are odd and were kept because they were chosen
// by hand. frames: of the session, by view.
Note NoteOfOddFrames(const rig::Session& session, const std::vector<std::size_t>& frames,
                     const consistency::Consistency& found, bool left_out);

// "With the angles reversed the residual falls from 0.08 to 0.003 of white: is the table's
// direction wrong?" and what cannot be told from it.
std::string WordsOfChange(const consistency::Consistency& found);

// A session against a model: what `verify --model` tells.
struct ModelCheck {
  struct Frame {
    std::size_t number = 0;
    std::optional<double> angle_deg;
    std::string file;
    consistency::FrameJudgement judged;
  };
  std::vector<Frame> frames;  // empty if they cannot be judged by each other
  std::size_t frames_in_all = 0;
  consistency::Consistency found;
};
// Fails with kInput as reading does, and with kInterrupted.
Result<ModelCheck> CheckModel(const std::filesystem::path& folder, const StopFlag* stop);

}  // namespace turnlight::estimator::from_session
