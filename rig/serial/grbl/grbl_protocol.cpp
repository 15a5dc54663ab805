#include "rig/serial/grbl/grbl_protocol.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::serial::grbl {
namespace {

using std::chrono::milliseconds;

// A bootloader takes up to two seconds before the banner comes.
constexpr DeviceTime kBannerPatience = milliseconds(2500);
constexpr DeviceTime kLinePatience = milliseconds(1500);
constexpr DeviceTime kResetPatience = milliseconds(800);
constexpr int kResetAttempts = 4;
constexpr DeviceTime kQueryMoving = milliseconds(1000);
constexpr DeviceTime kQueryPatience = milliseconds(700);
constexpr int kMaxMissed = 3;
constexpr std::size_t kMaxBadLines = 10;  // in a row
constexpr char kSoftReset = '\x18';

}  // namespace

void GrblProtocol::Connect() {
  GrblProtocol fresh(options_);
  // Where its zero is only a person knows: it is not taken a second time.
  fresh.here_taken_ = here_taken_;
  *this = std::move(fresh);
  phase_ = Phase::kBanner;
  line_deadline_ = now_ + kBannerPatience;
}

void GrblProtocol::Receive(std::string_view bytes) {
  if (phase_ == Phase::kOff) return;
  for (const std::string& line : lines_.Take(bytes)) {
    if (phase_ == Phase::kOff) return;
    OnLine(line);
  }
  OnBad(lines_.TakeBad());
  Continue();
}

// What waited for the line before it.
void GrblProtocol::Continue() {
  if (phase_ != Phase::kReady || sent_ != Sent::kNothing || task_ == Task::kHalting) return;
  if (std::exchange(pending_home_, false)) return BeginHoming();
  if (pending_move_ && task_ != Task::kHoming)
    BeginMove(*std::exchange(pending_move_, std::nullopt));
}

void GrblProtocol::OnBad(std::size_t count) {
  if (phase_ == Phase::kOff) return;
  bad_lines_ += count;
  if (bad_lines_ < kMaxBadLines) return;
  Fail(Format("%zu lines in a row are no words of a GRBL: is the baud rate right, the cable good?",
              bad_lines_),
       false);
}

void GrblProtocol::OnLine(const std::string& line) {
  const auto error = ParseError(line);
  const auto alarm = ParseAlarm(line);
  const auto banner = ParseBanner(line);
  const auto status = ParseStatus(line);
  if (line != "ok" && !error && !alarm && !banner && !status && line.front() != '[' &&
      line.front() != '$' && line.front() != '>') {
    if (strange_.size() < 3) strange_.push_back(line.substr(0, 60));
    return OnBad(1);
  }
  bad_lines_ = 0;
  if (line == "ok") return OnOk();
  if (error) return OnError(*error);
  if (alarm) return OnAlarm(*alarm);
  if (banner) return OnBanner(*banner);
  if (status) return OnStatus(*status);
  OnPush(line);
}

// Lines that answer nothing by themselves.
void GrblProtocol::OnPush(const std::string& line) {
  if (const auto version = ParseVersion(line)) version_ = *version;
  if (line.substr(0, 5) == "[OPT:") options_text_ = line.substr(5, line.size() - 6);
  if (const auto startup = ParseStartupLine(line)) {
    if (MovesAnAxis(startup->block)) refused_startup_ = line;
  } else if (const auto setting = ParseSetting(line)) {
    settings_[setting->number] = setting->value;
  }
  if (const auto offset = ParseOffset(line); offset && sent_ == Sent::kOffsets)
    offset_in_use_ = offset_in_use_ || std::any_of(offset->begin(), offset->end(),
                                                   [](double value) { return value != 0.0; });
  // A long report takes as long as it takes.
  if (line_deadline_ && (sent_ == Sent::kSettings || sent_ == Sent::kInfo))
    line_deadline_ = now_ + kLinePatience;
}

void GrblProtocol::Pass(DeviceTime elapsed) {
  now_ += elapsed;
  if (phase_ == Phase::kOff) return;
  if (line_deadline_ && now_ >= *line_deadline_) {
    line_deadline_.reset();
    OnLineDeadline();
  }
  if (phase_ == Phase::kOff) return;
  if (query_sent_ && now_ - *query_sent_ >= kQueryPatience) OnQueryUnanswered();
  if (phase_ == Phase::kReady && next_query_ && now_ >= *next_query_) Query();
  Continue();
}

DeviceTime GrblProtocol::Until() const {
  DeviceTime until = std::chrono::seconds(1);
  const auto sooner = [&](DeviceTime at) {
    until = std::clamp<DeviceTime>(at - now_, milliseconds(1), until);
  };
  if (phase_ == Phase::kOff) return until;
  if (line_deadline_) sooner(*line_deadline_);
  if (query_sent_) sooner(*query_sent_ + kQueryPatience);
  if (next_query_) sooner(*next_query_);
  return until;
}

std::string GrblProtocol::TakeOutput() { return std::exchange(output_, {}); }
std::vector<StageEvent> GrblProtocol::TakeEvents() { return std::exchange(events_, {}); }

void GrblProtocol::Send(Sent what, const std::string& line, DeviceTime patience) {
  sent_ = what;
  line_deadline_ = now_ + patience;
  output_ += line + "\n";
}

// One at a time: the firmware answers two that come together once.
void GrblProtocol::Query() {
  next_query_.reset();
  if (query_sent_) {
    query_again_ = true;
    return;
  }
  output_ += '?';
  query_sent_ = asked_at_ = now_;
  missed_ = 0;
}

void GrblProtocol::ForgetQueries() {
  query_sent_.reset();
  query_again_ = false;
  missed_ = 0;
}

void GrblProtocol::OnQueryUnanswered() {
  if (sent_ == Sent::kHome || reset_expected_) {  // not answered then
    ForgetQueries();
    next_query_ = now_ + kQueryMoving;
    return;
  }
  if (++missed_ >= kMaxMissed)
    return Fail(Format("the controller does not answer: %d status queries in a row", missed_),
                false);
  output_ += '?';
  query_sent_ = now_;  // asked_at_ stays: a late answer is one to the first
}

void GrblProtocol::OnLineDeadline() {
  if (phase_ == Phase::kBanner) {
    // A board without a reset on opening has no banner to tell.
    if (!reset_expected_) return Resync();
    // A critical alarm is deaf while it is told.
    if (++attempts_ < kResetAttempts) {
      output_ += kSoftReset;
      line_deadline_ = now_ + kResetPatience;
      return;
    }
    reset_expected_ = false;
    return Fail("the controller did not come back from a reset", false);
  }
  if (phase_ == Phase::kResync) return Resync();
  if (phase_ == Phase::kIdentify) return OnNoIdentity();
  if (task_ == Task::kHalting)  // It does not come to rest: a reset in motion loses the position.
    return SoftReset(false);
  const Sent was = std::exchange(sent_, Sent::kNothing);
  if (was == Sent::kMove) {
    ok_missing_ = true;
    Query();
  } else if (was == Sent::kHome) {
    unhomed_ = "homing did not end";
    EndTask("homing did not end");
  } else if (was == Sent::kUnlock || was == Sent::kLamp) {
    Note("a command without an answer");
    if (task_ == Task::kHoming) EndTask("the controller did not answer to $X");
  }
}

void GrblProtocol::Fail(std::string text, bool for_good) {
  phase_ = Phase::kOff;
  task_ = Task::kNone;
  sent_ = Sent::kNothing;
  line_deadline_.reset();
  next_query_.reset();
  ForgetQueries();
  events_.push_back(StageFailed{std::move(text), for_good});
}

void GrblProtocol::OnBanner(const Banner& banner) {
  banner_ = banner;
  ForgetQueries();
  const bool expected = std::exchange(reset_expected_, false);
  if (phase_ == Phase::kBanner || phase_ == Phase::kResync || phase_ == Phase::kIdentify) {
    if (!identified_) {
      if (!expected) unhomed_ = "the controller has just started: home it";
      attempts_ = 0;
      return Resync();
    }
    phase_ = Phase::kReady;
    return AfterReset();
  }
  if (expected) return AfterReset();
  sent_ = Sent::kNothing;
  line_deadline_.reset();
  unhomed_ =
      "the controller restarted by itself: \"" + banner.firmware + " " + banner.version + "\"";
  alarm_ = -1;
  pending_move_.reset();
  pending_home_ = false;
  EndTask("");
  LightLamp();
  Query();
}

// Of Halt, and before a homing.
void GrblProtocol::SoftReset(bool position_kept) {
  output_ += kSoftReset;
  reset_expected_ = true;
  sent_ = Sent::kNothing;
  ForgetQueries();
  next_query_.reset();
  phase_ = Phase::kBanner;
  attempts_ = 0;
  line_deadline_ = now_ + kResetPatience;
  if (!position_kept && unhomed_.empty()) unhomed_ = "it was reset in motion";
}

void GrblProtocol::AfterReset() {
  line_deadline_.reset();
  sent_ = Sent::kNothing;
  alarm_ = -1;
  if (std::exchange(home_after_reset_, false)) return BeginHoming();
  task_ = Task::kNone;
  LightLamp();
  Query();
}

void GrblProtocol::LightLamp() {
  if (!options_.lamp_power) return;
  const double full = SettingNumber(settings_, 30).value_or(1000.0);
  Send(Sent::kLamp, Format("M3 S%.0f", *options_.lamp_power * full), kLinePatience);
}

void GrblProtocol::Leave() {
  if (options_.lamp_power && identified_) output_ += "M5\n";
}

int GrblProtocol::AxisIndex() const {
  return static_cast<int>(std::string_view("XYZABC").find(options_.axis));
}

double GrblProtocol::StepDeg() const {
  return 1.0 / SettingNumber(settings_, 100 + AxisIndex()).value_or(1.0);
}

}  // namespace turnlight::rig::serial::grbl
