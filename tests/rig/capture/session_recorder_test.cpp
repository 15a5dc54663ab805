// Proves: what a capture writes reads back as a session; it is refused where it must be; damage is
// found on a resume, told by angle, and repaired to the same bytes; one writer at a time; verify
// tells of unfinished captures. Crashes and failing disks: recorder_faults_test.cpp.
#include "rig/capture/session_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "base/sha256.h"
#include "tests/rig/capture/capture_fixture.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;
namespace fs = std::filesystem;

class SessionRecorderTest : public CaptureFixture {
 protected:
  fs::path root() const { return folder_.path() / "s"; }
  void Put(const std::string& name, const std::string& bytes) {
    std::ofstream(root() / name, std::ios::binary) << bytes;
  }
  std::string Get(const std::string& name) { return ReadFile(root() / name).value_or(""); }
  std::string ResumeError() {
    const auto recorder = SessionRecorder::Resume(root(), setup_, Run());
    EXPECT_FALSE(recorder);
    return recorder ? "" : recorder.error().text;
  }
  // Starts and adds the first frames.
  SessionRecorder StartWith(std::size_t frames) {
    auto recorder = SessionRecorder::Start(root(), setup_, Run());
    EXPECT_TRUE(recorder) << recorder.error().text;
    for (std::size_t i = 0; i < frames; ++i) EXPECT_TRUE(recorder->Add(keyframes_[i]));
    return std::move(*recorder);
  }
};

TEST_F(SessionRecorderTest, FinishedCaptureIsASession) {
  const Status status = Capture(root(), SystemFileOps());
  ASSERT_TRUE(status) << status.error().text;
  std::vector<std::string> names;
  for (const auto& [name, bytes] : Contents(root())) names.push_back(name);
  EXPECT_THAT(names, ElementsAre("camera.cameramodel", "frames/000.exr", "frames/000.validity.png",
                                 "frames/001.exr", "frames/001.validity.png", "frames/002.exr",
                                 "frames/002.validity.png", "frames/closure.exr",
                                 "frames/closure.validity.png", "journal.jsonl", "provenance.jsonl",
                                 "session.json", "target.obj"));
  const auto session = ReadSession(root());
  ASSERT_TRUE(session) << session.error().text;
  ASSERT_EQ(session->frames.size(), 3u);
  EXPECT_EQ(session->radiometry.white, 1.0);
  EXPECT_EQ(session->radiometry.SaturationDn(), 4.0);
  for (std::size_t i = 0; i < 3; ++i) {
    const FrameRecord& frame = session->frames[i];
    EXPECT_EQ(frame.angle_deg, 10.0 * static_cast<double>(i));
    EXPECT_EQ(frame.angle_measured_deg, 10.0 * static_cast<double>(i) + 0.01);
    EXPECT_EQ(frame.exposure.exposure_us, 8000.0);
    EXPECT_EQ(frame.X_WT.rotation, keyframes_[i].X_WT.rotation);
    EXPECT_EQ(frame.X_WC.translation, keyframes_[i].X_WC.translation);
    const auto images = ReadFrameImages(*session, i);
    ASSERT_TRUE(images) << images.error().text;
    EXPECT_TRUE(SamePixels(images->image, keyframes_[i].image));
    EXPECT_TRUE(SamePixels(images->mask, keyframes_[i].validity));
  }
  EXPECT_TRUE(ReadTarget(*session));
  const auto report = VerifySession(root());
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, IsEmpty());
  EXPECT_EQ(report->content_sha256.size(), 64u);
}

TEST_F(SessionRecorderTest, OneExposureIsStoredAsItCame) {
  setup_.plan.exposures_us = {8000.0};
  setup_.plan.count = 1001;
  setup_.plan.step_deg = 0.2;
  auto recorder = StartWith(0);
  RecordedKeyframe keyframe = keyframes_[0];
  keyframe.image = Pattern(CV_16UC3);
  keyframe.validity = cv::Mat1b();
  keyframe.index = 7;
  ASSERT_TRUE(recorder.Add(keyframe));
  EXPECT_TRUE(SamePixels(ReadImage(root() / "frames/0007.png").value(), keyframe.image));
  EXPECT_EQ(recorder.entries().at(7).frame.angle_deg, 1.4);
  EXPECT_FALSE(recorder.entries().at(7).frame.validity);
}

TEST_F(SessionRecorderTest, ProvenanceTellsWhoWhatAndWhen) {
  keyframes_[1].provenance.attempts = 2;
  keyframes_[1].provenance.rejected = {"arrived 0.3 deg off"};
  keyframes_[1].provenance.counters = {{{"frame_id", 17}}, {{"frame_id", 18}}};
  keyframes_[1].provenance.readings = {{"DeviceTemperature", 41.5}};
  keyframes_[1].provenance.exposure_begin = std::chrono::milliseconds(1500);
  { StartWith(2); }
  ASSERT_TRUE(Capture(root()));
  std::vector<nlohmann::json> lines;
  std::istringstream in(Get(kProvenanceFile));
  for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(lines.size(), 6u);  // run, 0, 1, run, 2, closure
  EXPECT_EQ(lines[0]["program_version"], "1.2.3");
  EXPECT_EQ(lines[0]["program_commit"], "abcdef");
  EXPECT_EQ(lines[0]["config"], setup_.config_text);
  EXPECT_EQ(lines[0]["config_sha256"], Sha256Hex(setup_.config_text));
  EXPECT_EQ(lines[0]["camera_device"], "Maker, C, 77");
  EXPECT_EQ(lines[0]["table_device"], "Maker, T, 5");
  EXPECT_EQ(lines[0]["settings"]["packet_size"], "9000");
  EXPECT_EQ(lines[0]["camera_model_sha256"], Sha256Hex(Get("camera.cameramodel")));
  EXPECT_EQ(lines[0]["mesh_sha256"], Sha256Hex(Get("target.obj")));
  EXPECT_EQ(lines[2]["attempts"], 2);
  EXPECT_EQ(lines[2]["rejected"][0], "arrived 0.3 deg off");
  EXPECT_EQ(lines[2]["counters"][0]["frame_id"], 17);
  EXPECT_EQ(lines[2]["counters"][1]["frame_id"], 18);
  EXPECT_EQ(lines[2]["readings"]["DeviceTemperature"], 41.5);
  EXPECT_EQ(lines[2]["exposure_begin_s"], 1.5);
  EXPECT_EQ(lines[2]["angle_deg"], 10.0);
  EXPECT_EQ(lines[2]["angle_measured_deg"], 10.01);
  EXPECT_EQ(lines[3]["kind"], "run");
  EXPECT_EQ(lines[3]["frames_kept"], 2);
  EXPECT_EQ(lines[5]["angle_deg"], 360.0);
}

TEST_F(SessionRecorderTest, TornProvenanceCostsOneLine) {
  { StartWith(1); }
  std::ofstream(root() / kProvenanceFile, std::ios::app) << "{\"kind\":\"keyfr";
  ASSERT_TRUE(Capture(root()));
  std::istringstream in(Get(kProvenanceFile));
  std::size_t good = 0;
  std::size_t torn = 0;
  for (std::string line; std::getline(in, line);) ++(nlohmann::json::accept(line) ? good : torn);
  EXPECT_EQ(good, 6u);  // run, 0, run, 1, 2, closure
  EXPECT_EQ(torn, 1u);
}

TEST_F(SessionRecorderTest, OrderAndRetakesLeaveNoTrace) {
  ASSERT_TRUE(Capture(folder_.path() / "straight"));
  {
    auto recorder = SessionRecorder::Start(root(), setup_, Run());
    ASSERT_TRUE(recorder);
    for (const std::size_t i : {3u, 1u, 0u, 2u}) ASSERT_TRUE(recorder->Add(keyframes_[i]));
    ASSERT_TRUE(recorder->Finish());
    EXPECT_FALSE(recorder->Finish());
    EXPECT_FALSE(recorder->Add(keyframes_[0]));
  }
  EXPECT_EQ(Contents(root()), Contents(folder_.path() / "straight"));
  // A finished session resumes to nothing, and stays as it is.
  auto recorder = SessionRecorder::Resume(root(), setup_, Run());
  ASSERT_TRUE(recorder) << recorder.error().text;
  EXPECT_THAT(recorder->Missing(), IsEmpty());
  ASSERT_TRUE(recorder->Finish());
  EXPECT_EQ(Contents(root()), Contents(folder_.path() / "straight"));
}

TEST_F(SessionRecorderTest, FinishNamesWhatIsMissingAndGoesOn) {
  auto recorder = StartWith(2);
  const Status status = recorder.Finish();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kIncomplete);
  EXPECT_THAT(status.error().text,
              AllOf(HasSubstr("frame 2 (20.0 deg)"), HasSubstr("closure frame (360.0 deg)"),
                    Not(HasSubstr("frame 1"))));
  EXPECT_FALSE(fs::exists(root() / "session.json"));
  EXPECT_TRUE(recorder.Add(keyframes_[2]));
  EXPECT_TRUE(recorder.Add(keyframes_[3]));
  EXPECT_TRUE(recorder.Finish());
}

TEST_F(SessionRecorderTest, BadKeyframesAreRefusedAndNothingIsWritten) {
  auto recorder = StartWith(1);
  const auto before = Contents(root());
  const auto refuse = [&](const std::function<void(RecordedKeyframe&)>& spoil) {
    RecordedKeyframe keyframe = keyframes_[1];
    spoil(keyframe);
    const Status status = recorder.Add(keyframe);
    EXPECT_FALSE(status);
    return status ? "" : status.error().text;
  };
  EXPECT_THAT(refuse([](auto& k) { k.index = 0; }), HasSubstr("frame 0: not wanted"));
  EXPECT_THAT(refuse([](auto& k) { k.index = 4; }), HasSubstr("frame 4: not wanted"));
  EXPECT_THAT(refuse([](auto& k) { k.image = Pattern(CV_16UC3); }),
              AllOf(HasSubstr("frame 1 (10.0 deg)"), HasSubstr("CV_16UC3"), HasSubstr("CV_32FC3")));
  EXPECT_THAT(refuse([](auto& k) { k.image = k.image.rowRange(0, 5); }), HasSubstr("16 x 5"));
  EXPECT_THAT(refuse([](auto& k) { k.validity = cv::Mat1b(kHeight, kWidth, std::uint8_t{0}); }),
              HasSubstr("leaves no pixel"));
  EXPECT_THAT(refuse([](auto& k) { k.exposure.exposure_us = 0.0; }), HasSubstr("exposure"));
  EXPECT_THAT(refuse([](auto& k) { k.exposure.exposure_us.reset(); }), HasSubstr("exposure"));
  EXPECT_THAT(refuse([](auto& k) { k.angle_measured_deg = std::nan(""); }), HasSubstr("angle"));
  EXPECT_THAT(refuse([](auto& k) { k.X_WT.rotation(2, 2) = -1.0; }), HasSubstr("X_WT"));
  EXPECT_EQ(Contents(root()), before);
  EXPECT_TRUE(recorder.Add(keyframes_[1]));
}

TEST_F(SessionRecorderTest, SetupsThatMakeNoSessionAreRefused) {
  const auto refuse = [&](const std::function<void(CaptureSetup&)>& spoil) {
    CaptureSetup setup = setup_;
    spoil(setup);
    const auto recorder = SessionRecorder::Start(root(), setup, Run());
    EXPECT_FALSE(recorder);
    EXPECT_FALSE(fs::exists(root()));
    return recorder ? "" : recorder.error().text;
  };
  EXPECT_THAT(refuse([](auto& s) { s.plan.count = 0; }), HasSubstr("count: 0"));
  EXPECT_THAT(refuse([](auto& s) { s.format.size.width = 99; }),
              AllOf(HasSubstr("99 x 12"), HasSubstr("16 x 12")));
  EXPECT_THAT(refuse([](auto& s) { s.format.channels = 4; }), HasSubstr("4 channels"));
  EXPECT_THAT(refuse([](auto& s) { s.bayer = "RGGB"; }), HasSubstr("mosaic"));
  EXPECT_THAT(refuse([](auto& s) { s.radiometry.encoding = calib::Encoding::kSrgb; }),
              HasSubstr("linear"));
  EXPECT_THAT(refuse([](auto& s) {
                s.target = MeshCopy{MeshFormat::kPly, "ply, it says"};
              }),
              HasSubstr("target.ply"));
}

TEST_F(SessionRecorderTest, FoldersInUseAreRefused) {
  {
    auto recorder = StartWith(1);
    const auto second = SessionRecorder::Start(root(), setup_, Run());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kInput);
    EXPECT_THAT(
        second.error().text,
        AllOf(HasSubstr(root().string()), HasSubstr("another capture writes here"),
              HasSubstr("process " + std::to_string(::getpid()) + " ("), HasSubstr("since 20")));
    EXPECT_THAT(ResumeError(), HasSubstr("process " + std::to_string(::getpid())));
    EXPECT_TRUE(recorder.Add(keyframes_[1]));  // the holder is not disturbed
  }
  const auto begun = SessionRecorder::Start(root(), setup_, Run());
  ASSERT_FALSE(begun);
  EXPECT_THAT(begun.error().text, HasSubstr("begun already"));
  ASSERT_TRUE(Capture(root()));
  const auto finished = SessionRecorder::Start(root(), setup_, Run());
  ASSERT_FALSE(finished);
  EXPECT_THAT(finished.error().text, HasSubstr("holds a session already"));
}

TEST_F(SessionRecorderTest, DeadHolderIsNoHolder) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto recorder = SessionRecorder::Start(root(), setup_, Run());
    ::_exit(recorder ? 0 : 1);
  }
  int state = 0;
  ASSERT_EQ(::waitpid(child, &state, 0), child);
  ASSERT_EQ(state, 0);
  EXPECT_TRUE(fs::exists(root() / "capture.lock"));
  EXPECT_TRUE(SessionRecorder::Resume(root(), setup_, Run()));
  EXPECT_FALSE(fs::exists(root() / "capture.lock"));
}

TEST_F(SessionRecorderTest, ResumeWantsTheSameCapture) {
  EXPECT_THAT(ResumeError(), HasSubstr("no capture was begun"));
  EXPECT_FALSE(fs::exists(root()));
  { StartWith(1); }
  const CaptureSetup setup = setup_;
  setup_.camera_identity = Describe({"Maker", "C", "78"});
  EXPECT_THAT(ResumeError(),
              AllOf(HasSubstr("the camera \"Maker, C, 77\""), HasSubstr("\"Maker, C, 78\"")));
  setup_ = setup;
  setup_.table_identity = Describe({"Maker", "T2", "5"});
  EXPECT_THAT(ResumeError(), HasSubstr("the turntable \"Maker, T, 5\""));
  setup_ = setup;
  setup_.config_text += " ";
  EXPECT_THAT(ResumeError(), HasSubstr("config (SHA-256)"));
  setup_ = setup;
  setup_.camera = calib::CameraModel::Pinhole(kWidth, kHeight, 20.5, 20.0, 7.5, 5.5);
  EXPECT_THAT(ResumeError(), HasSubstr("camera model (SHA-256)"));
  setup_ = setup;
  setup_.target = calib::SphereShape{1.0};
  EXPECT_THAT(ResumeError(), AllOf(HasSubstr("mesh (SHA-256)"), HasSubstr("now it is \"none\"")));
  setup_ = setup;
  setup_.plan.count = 4;
  EXPECT_THAT(ResumeError(), HasSubstr("another plan"));
  setup_ = setup;
  setup_.target = MeshCopy{MeshFormat::kObj, "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n"};
  EXPECT_THAT(ResumeError(), HasSubstr("mesh (SHA-256)"));
}

TEST_F(SessionRecorderTest, DamagedFilesAreTakenAgain) {
  ASSERT_TRUE(Capture(root()));
  const auto whole = Contents(root());
  for (const std::string name : {"frames/001.exr", "frames/001.validity.png"})
    for (const bool missing : {false, true}) {
      std::string bytes = Get(name);
      bytes[bytes.size() / 2] ^= 1;
      if (missing)
        fs::remove(root() / name);
      else
        Put(name, bytes);
      const auto verified = VerifySession(root());
      ASSERT_TRUE(verified);
      EXPECT_EQ(verified->problems.size(), 1u);
      EXPECT_THAT(verified->problems.front(),
                  AllOf(HasSubstr("frame 1 (10.0 deg)"), HasSubstr(name)));
      EXPECT_THAT(verified->lost_angles_deg, ElementsAre(10.0));
      {
        auto recorder = SessionRecorder::Resume(root(), setup_, Run());
        ASSERT_TRUE(recorder) << recorder.error().text;
        EXPECT_EQ(recorder->report().kept, 3u);
        ASSERT_EQ(recorder->report().dropped.size(), 1u);
        EXPECT_THAT(recorder->report().dropped[0],
                    AllOf(HasSubstr("frame 1 (10.0 deg)"), HasSubstr(name)));
        ASSERT_EQ(recorder->Missing().size(), 1u);
        EXPECT_EQ(recorder->Missing()[0].angle_deg, 10.0);
      }
      ASSERT_TRUE(Capture(root()));
      EXPECT_EQ(Contents(root()), whole);
    }
  // The copies of the start are made again.
  Put("camera.cameramodel", "{");
  Put("target.obj", "");
  ASSERT_TRUE(Capture(root()));
  EXPECT_EQ(Contents(root()), whole);
}

TEST_F(SessionRecorderTest, JournalTornAtEveryByteOfItsLastLine) {
  FaultyOps ops;  // does not wait for the disk
  ASSERT_TRUE(Capture(root(), ops));
  const auto whole = Contents(root());
  const std::string journal = whole.at(kJournalFile);
  const std::size_t line = journal.rfind('\n', journal.size() - 2) + 1;
  for (std::size_t size = line; size < journal.size(); ++size)
    for (const std::size_t zeros : {0u, 64u}) {
      Put(kJournalFile, journal.substr(0, size) + std::string(zeros, '\0'));
      fs::remove(root() / "session.json");
      {
        auto recorder = SessionRecorder::Resume(root(), setup_, Run(), ops);
        ASSERT_TRUE(recorder) << recorder.error().text;
        // With only its end of line missing, the line is whole.
        const bool lost = size + 1 < journal.size() || zeros > 0;
        ASSERT_EQ(recorder->report().kept, lost ? 3u : 4u) << size;
        EXPECT_EQ(recorder->report().dropped.size(), size == line && zeros == 0 ? 0u
                                                     : lost                     ? 1u
                                                                                : 0u);
        for (const PlannedFrame& planned : recorder->Missing())
          ASSERT_TRUE(recorder->Add(keyframes_[planned.index]));
        ASSERT_TRUE(recorder->Finish());
      }
      ASSERT_EQ(Contents(root()), whole) << size;
    }
}

TEST_F(SessionRecorderTest, EveryFlippedByteOfTheJournalIsSeen) {
  ASSERT_TRUE(Capture(root()));
  const std::string journal = Get(kJournalFile);
  const std::size_t second = journal.find('\n') + 1;
  for (std::size_t at = 0; at < journal.size(); at += 3) {
    std::string damaged = journal;
    damaged[at] ^= 4;
    Put(kJournalFile, damaged);
    const auto read = ReadJournal(root());
    if (at < second) {
      EXPECT_FALSE(read) << at;
    } else {
      ASSERT_TRUE(read) << at;
      EXPECT_FALSE(read->problems.empty()) << at;
      EXPECT_GE(read->entries.size(), 2u) << at;  // a flipped end of line costs two
    }
  }
}

TEST_F(SessionRecorderTest, VerifyListsTheAnglesOfAnUnfinishedCapture) {
  { StartWith(3); }
  const std::string name = "frames/001.exr";
  const std::string bytes = Get(name);
  Put(name, bytes.substr(0, 100));
  auto report = VerifySession(root());
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_THAT(report->lost_angles_deg, ElementsAre(10.0, 360.0));
  EXPECT_EQ(report->frames, 2u);
  EXPECT_TRUE(report->session_good);
  EXPECT_EQ(report->content_sha256, "");
  ASSERT_EQ(report->problems.size(), 2u);
  EXPECT_THAT(report->problems[0], AllOf(HasSubstr("frame 1 (10.0 deg)"), HasSubstr(name)));
  EXPECT_THAT(report->problems[1],
              AllOf(HasSubstr("not finished"), HasSubstr("2 of 3 frames are good"),
                    HasSubstr("frame 1 (10.0 deg), closure frame (360.0 deg)"),
                    HasSubstr("turnlight resume")));
  Put("camera.cameramodel", "{");
  EXPECT_FALSE(VerifySession(root())->session_good);
  Put(kJournalFile, "nonsense\n");
  report = VerifySession(root());
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().text, HasSubstr("journal.jsonl:1: torn or damaged"));
}

TEST_F(SessionRecorderTest, DamagedClosureFrameIsARemark) {
  ASSERT_TRUE(Capture(root()));
  Put("frames/closure.exr", "x");
  const auto report = VerifySession(root());
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, IsEmpty());
  EXPECT_THAT(report->remarks, ElementsAre(HasSubstr("closure frame (360.0 deg)")));
}

TEST_F(SessionRecorderTest, SpaceIsCheckedBeforehand) {
  FaultyOps ops;
  ops.free_bytes = 1000;
  const auto refused = SessionRecorder::Start(root(), setup_, Run(), ops);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kSystem);
  EXPECT_THAT(
      refused.error().text,
      AllOf(HasSubstr("too little space for 4 frames"), HasSubstr("MB needed, 1000 bytes free"),
            HasSubstr("nothing was begun"), Not(HasSubstr("resume"))));
  EXPECT_FALSE(fs::exists(root()));
  ops.free_bytes = 1 << 30;
  auto recorder = SessionRecorder::Start(root(), setup_, Run(), ops);
  ASSERT_TRUE(recorder) << recorder.error().text;
  const auto before = Contents(root());
  ops.free_bytes = 1000;
  const Status full = recorder->Add(keyframes_[0]);
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().text, AllOf(HasSubstr("too little space for frame 0 (0.0 deg)"),
                                       HasSubstr("`turnlight resume` completes the capture")));
  EXPECT_EQ(Contents(root()), before);
  ops.free_bytes = 1 << 30;
  EXPECT_TRUE(recorder->Add(keyframes_[0]));
}

// A capture that goes on until the lights are known: extra frames are kept, it ends when it is told
// to, and session.json says why.
TEST_F(SessionRecorderTest, EndsWhereItIsToldTo) {
  setup_.plan.closure = false;
  setup_.plan.until = UntilDirections{0.05, 2};
  SessionRecorder recorder = StartWith(3);
  RecordedKeyframe extra = keyframes_[1];
  extra.index = 3;
  extra.angle_deg = 5.0;
  ASSERT_TRUE(recorder.Add(extra));
  EXPECT_EQ(recorder.entries().at(3).frame.angle_deg, 5.0);
  extra.index = 5;
  EXPECT_FALSE(recorder.Add(extra)) << "two extra ones are allowed";
  recorder.End({"reached", "All is known."});
  EXPECT_THAT(recorder.Missing(), IsEmpty());
  ASSERT_TRUE(recorder.Finish());
  EXPECT_EQ(nlohmann::json::parse(Get("session.json"))["x-ended"]["code"], "reached");
  EXPECT_EQ(ReadSession(root())->frames.size(), 4u);
  const auto again = SessionRecorder::Resume(root(), setup_, Run());
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(again->entries().size(), 4u);
  EXPECT_THAT(again->Missing(), IsEmpty());
}

TEST_F(SessionRecorderTest, EndsBeforeItsPlan) {
  setup_.plan.closure = false;
  setup_.plan.until = UntilDirections{0.05, 2};
  {
    SessionRecorder recorder = StartWith(2);
    EXPECT_EQ(recorder.Missing().size(), 1u);
    recorder.End({"early", "That is enough."});
    ASSERT_TRUE(recorder.Finish());
  }
  EXPECT_EQ(ReadSession(root())->frames.size(), 2u);
  EXPECT_THAT(SessionRecorder::Resume(root(), setup_, Run())->Missing(), IsEmpty());
}

}  // namespace
}  // namespace turnlight::rig
