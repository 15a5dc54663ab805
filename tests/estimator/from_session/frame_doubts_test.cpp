// Proves that a session on disk with odd frames is estimated as if they had never been there and
// says which they were, that a wrong direction of turning is told and nothing changed, also where
// there is no estimate at all, and what `verify --model` has of both. How surely frames and poses
// are told: consistency_test and consistency_study.
#include "estimator/from_session/frame_doubts.h"

#include <gtest/gtest.h>

#include "base/file.h"
#include "estimator/from_session/session_estimate.h"
#include "rig/session/image_file.h"
#include "rig/sim/synthetic_session.h"
#include "tests/estimator/consistency/mangled.h"

namespace turnlight::estimator::from_session {
namespace {

namespace fs = std::filesystem;

class FrameDoubts : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(rig::sim::WriteSynthetic(
        consistency::SmallCapture(4, consistency::Shape::kLump, 12), root_));
  }
  void TearDown() override { fs::remove_all(root_); }

  // Rewrites the session with other records of its frames.
  template <typename Change>
  void ChangeRecords(const Change& change) {
    auto session = rig::ReadSession(root_);
    ASSERT_TRUE(session);
    change(session->frames);
    ASSERT_TRUE(rig::WriteSession(*session, root_));
  }
  void Blacken(std::size_t frame) {
    ChangeRecords([&](std::vector<rig::FrameRecord>& frames) {
      frames[frame].sha256.reset();
      const auto picture = rig::ReadImage(root_ / frames[frame].image);
      ASSERT_TRUE(picture);
      ASSERT_TRUE(rig::WriteImage(root_ / frames[frame].image, 0.0 * *picture));
    });
  }

  const fs::path root_ =
      fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

const Note* NoteOf(const SessionEstimate& estimate, const std::string& code) {
  for (const Note& note : estimate.output.estimate.notes)
    if (note.code == code) return &note;
  return nullptr;
}

TEST_F(FrameDoubts, AnEstimateIsAsIfOddFramesHadNeverBeenThere) {
  Blacken(7);
  Options options;
  options.residuals_of = [](std::size_t) { return std::vector<std::size_t>{0}; };
  const auto found = EstimateSession(root_, options);
  ASSERT_TRUE(found) << found.error().text;
  const Note* note = NoteOf(*found, "frames-left-out");
  ASSERT_NE(note, nullptr);
  EXPECT_NE(note->text.find("1 of 12 frames do not belong"), std::string::npos) << note->text;
  EXPECT_NE(note->text.find("frame 7 (210.0 deg), frames/007.png, is black"), std::string::npos)
      << note->text;
  EXPECT_EQ(found->output.left_out.count(7), 1u);
  EXPECT_EQ(found->keyframes.size(), 11u);

  ChangeRecords([](std::vector<rig::FrameRecord>& frames) { frames.erase(frames.begin() + 7); });
  const auto without = EstimateSession(root_);
  ASSERT_TRUE(without);
  EXPECT_EQ(NoteOf(*without, "frames-left-out"), nullptr);
  EXPECT_EQ(without->output.estimate.rms, found->output.estimate.rms);
  ASSERT_EQ(without->output.estimate.lights.size(), found->output.estimate.lights.size());
  for (std::size_t l = 0; l < without->output.estimate.lights.size(); ++l)
    EXPECT_EQ(without->output.estimate.lights[l].light.direction,
              found->output.estimate.lights[l].light.direction);
}

TEST_F(FrameDoubts, FramesChosenByHandStayAndAreNamed) {
  Blacken(7);
  Options options;
  for (std::size_t k = 0; k < 12; ++k)
    if (k != 3) options.frames.push_back(k);
  const auto found = EstimateSession(root_, options);
  std::string words;
  if (!found)
    words = found.error().text;
  else if (const Note* note = NoteOf(*found, "frames-odd"))
    words = note->text;
  EXPECT_NE(words.find("frame 7 (210.0 deg), frames/007.png, is black"), std::string::npos)
      << words;
  EXPECT_TRUE(!found || found->keyframes.size() == 11);
}

// Of the views 0, 2, 4, ...: numbers are those of the session.
TEST_F(FrameDoubts, OddFramesAmongChosenViewsAreLeftOut) {
  Blacken(4);
  Options options;
  options.views = 6;
  const auto found = EstimateSession(root_, options);
  ASSERT_TRUE(found) << found.error().text;
  const Note* note = NoteOf(*found, "frames-left-out");
  ASSERT_NE(note, nullptr);
  EXPECT_NE(note->text.find("frame 4 (120.0 deg), frames/004.png, is black"), std::string::npos)
      << note->text;
  EXPECT_EQ(found->keyframes.size(), 5u);
}

TEST_F(FrameDoubts, TheCheckEndsWhenItIsTold) {
  Blacken(7);
  StopFlag stop(false);
  Options options;
  options.stop = &stop;
  bool checking = false;
  options.progress = [&](Stage stage, std::size_t, std::size_t) {
    checking = checking || stage == Stage::kChecking;
    if (checking) stop = true;
  };
  const auto found = EstimateSession(root_, options);
  EXPECT_TRUE(checking);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::kInterrupted);
}

TEST_F(FrameDoubts, AWrongDirectionIsToldAndNothingIsChanged) {
  ChangeRecords([](std::vector<rig::FrameRecord>& frames) {
    for (rig::FrameRecord& frame : frames) frame.X_WT = frame.X_WT.Inverse();
  });
  // What is fitted may be an estimate or none: the words are the same.
  const auto found = EstimateSession(root_);
  std::string words;
  if (!found)
    words = found.error().text;
  else if (const Note* note = NoteOf(*found, "poses-doubtful"))
    words = note->text;
  EXPECT_NE(words.find("With the angles reversed the residual falls from"), std::string::npos)
      << words;
  EXPECT_NE(words.find("is the table's direction wrong?"), std::string::npos);
  EXPECT_NE(words.find("The poses were left as they are."), std::string::npos);
}

TEST_F(FrameDoubts, ARefusalSaysWhichChangeWouldShowTheTarget) {
  ChangeRecords([](std::vector<rig::FrameRecord>& frames) {
    for (rig::FrameRecord& frame : frames) frame.X_WC = frame.X_WC.Inverse();
  });
  const auto found = EstimateSession(root_);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::kNoEstimate);
  EXPECT_NE(found.error().text.find("With the camera's poses inverted the target is seen"),
            std::string::npos)
      << found.error().text;
}

TEST_F(FrameDoubts, TheCheckListsEveryFrameAndWhatWasTried) {
  Blacken(2);
  const auto check = CheckModel(root_, nullptr);
  ASSERT_TRUE(check);
  ASSERT_EQ(check->frames.size(), 12u);
  EXPECT_EQ(check->frames[2].file, "frames/002.png");
  EXPECT_EQ(OddViews(check->found), std::vector<std::size_t>{2});
  EXPECT_FALSE(check->found.tried.empty());
  EXPECT_FALSE(check->found.change);
}

}  // namespace
}  // namespace turnlight::estimator::from_session
