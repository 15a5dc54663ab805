// What a Zaber device says, and what follows from it.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "rig/serial/zaber/zaber_protocol.h"

namespace turnlight::rig::serial::zaber {
namespace {

constexpr std::size_t kLongestReply = 1000;
// Well below what a capture allows (0.05 degrees), above an encoder's play.
constexpr double kArrivalToleranceDeg = 0.02;
// An axis that stands elsewhere for so long does not go on by itself.
constexpr DeviceTime kAstrayWait = std::chrono::milliseconds(500);

std::string FirstWord(std::string_view text) { return std::string(text.substr(0, text.find(' '))); }

}  // namespace

void ZaberProtocol::HandleLine(const std::string& spaced) {
  const std::string line = spaced.substr(std::min(spaced.find_first_not_of(' '), spaced.size()));
  if (line.empty() || line.front() == '/') return;  // an echo of what was sent
  auto message = ParseMessage(line);
  if (!message) return BadLine(line);
  if (message->device != options_.device) {
    other_device_ = message->device;
    return;
  }
  if (message->kind == MessageKind::kInfo) return HandleInfo(*message);
  if (message->kind == MessageKind::kAlert) {
    // It proves nothing, but the next poll may know more.
    if (!request_ && message->axis == options_.axis) WakeIn(DeviceTime::zero());
    return;
  }
  partial_.reset();
  if (message->continues) {
    partial_ = std::move(message);
  } else {
    HandleReply(*message);
  }
}

void ZaberProtocol::HandleInfo(const Message& info) {
  constexpr std::string_view kContinued = "cont";
  if (!partial_ || info.axis != partial_->axis || !info.data.starts_with(kContinued)) return;
  if (info.id && info.id != partial_->id) return;
  partial_->data += info.data.substr(kContinued.size());
  partial_->continues = info.continues;
  if (partial_->data.size() > kLongestReply) {
    partial_.reset();
    return BadLine(info.data);
  }
  if (info.continues) return;
  const Message reply = *std::exchange(partial_, std::nullopt);
  HandleReply(reply);
}

void ZaberProtocol::HandleReply(const Message& reply) {
  if (!request_ || !Answers(reply)) {
    // The late answer to the command under way.
    const bool late =
        reply.id && reply.axis == options_.axis &&
        std::find(command_ids_.begin(), command_ids_.end(), *reply.id) != command_ids_.end();
    if (late && !taken_ && (goal_ == Goal::kHome || goal_ == Goal::kMove)) {
      taken_ = !reply.rejected;
      command_ids_.clear();
    }
    return;
  }
  if (reply.rejected && reply.data == "BADCHECKSUM" && request_->ids.size() < 2) return Transmit();
  if (reply.id) ids_seen_ = true;
  const Request request = *std::exchange(request_, std::nullopt);
  if (request.axis != 0) busy_ = reply.busy;
  if (std::exchange(deferred_, false)) return SendCommand();
  HandleAnswer(request, reply);
  // Whatever was asked and not asked again: the polls go on.
  if (!over() && !request_) PollLater(request.asked);
}

void ZaberProtocol::HandleAnswer(const Request& request, const Message& reply) {
  switch (request.ask) {
    case Ask::kHello:
      return NextSetting();
    case Ask::kSetting:
      return HandleSetting(reply);
    case Ask::kStatus:
      return HandleStatus(request, reply);
    case Ask::kPosition:
      return HandlePosition(request, reply);
    case Ask::kWarnings:
      return HandleWarnings(reply);
    case Ask::kClear:
      return HandleCleared();
    case Ask::kHome:
    case Ask::kMove:
    case Ask::kStop:
      return HandleTaken(request, reply);
  }
}

void ZaberProtocol::HandleSetting(const Message& reply) {
  const Setting& setting = kSettings[setting_];
  if (!reply.rejected) {
    const std::string value = FirstWord(reply.data);
    if (!value.empty() && value != "NA") values_[std::string(setting.name)] = value;
  } else if (reply.data == "BADAXIS") {
    return Fail(Format("Zaber device %d has no axis %d (%s): see the key axis", options_.device,
                       options_.axis, RejectionInWords(reply.data).c_str()),
                true);
  } else if (!other_name_ && !setting.other_name.empty()) {
    other_name_ = true;
    return NextSetting();
  } else if (setting_ == 0) {
    return Fail(
        Format("Zaber device %d does not say what it is: '%s' is refused, %s", options_.device,
               std::string(setting.name).c_str(), RejectionInWords(reply.data).c_str()),
        true);
  } else {
    Note("the device does not tell '" + std::string(setting.name) +
         "': " + RejectionInWords(reply.data));
  }
  other_name_ = false;
  ++setting_;
  NextSetting();
}

void ZaberProtocol::NextSetting() {
  if (setting_ < kSettings.size()) {
    const Setting& setting = kSettings[setting_];
    const auto name = other_name_ ? setting.other_name : setting.name;
    return Send(Ask::kSetting, setting.of_device ? 0 : options_.axis, "get " + std::string(name));
  }
  const Result<ZaberStage> stage = IdentifyStage(values_, options_);
  if (!stage) return Fail(stage.error().text, true);
  microsteps_per_deg_ = stage->microsteps_per_deg;
  goal_ = Goal::kRest;
  own_interrupt_ = true;  // what disturbed the axis before is no matter of this capture
  Tell(stage->identified);
  Poll();
}

void ZaberProtocol::HandleTaken(const Request& request, const Message& reply) {
  if (reply.rejected) {
    SetFault(TableMotion::kFault,
             "'" + request.text + "' is refused: " + RejectionInWords(reply.data), reply.busy);
    return ReportFault(request.asked);
  }
  taken_ = true;
  was_busy_ = reply.busy;
  // What disturbed the axis before the command is over with it.
  if (MeaningOf(reply.flag) != FlagMeaning::kDisturbed && !Judge(reply.flag, reply.busy))
    return ReportFault(request.asked);
  if (!fault_.empty()) return ReportFault(request.asked);
  Report(TableMotion::kMoving, position_deg_, "", request.asked);
  if (!reply.busy) Poll();
}

void ZaberProtocol::HandleStatus(const Request& request, const Message& reply) {
  if (reply.rejected)
    SetFault(TableMotion::kFault, "no state: " + RejectionInWords(reply.data), reply.busy);
  else
    Judge(reply.flag, reply.busy);
  if (!fault_.empty()) {
    if (!reply.busy && goal_ == Goal::kStop) goal_ = Goal::kRest;
    return ReportFault(request.asked);
  }
  if (reply.busy) {
    was_busy_ = true;
    astray_since_.reset();
    return Report(TableMotion::kMoving, position_deg_, "", request.asked);
  }
  Send(Ask::kPosition, options_.axis, "get pos");
}

void ZaberProtocol::HandlePosition(const Request& request, const Message& reply) {
  reference_missing_ = false;
  const auto position = ParseNumber(FirstWord(reply.data));
  if (reply.rejected)
    SetFault(TableMotion::kFault, "no position: " + RejectionInWords(reply.data), reply.busy);
  else if (!position)
    return BadLine(reply.data);
  else
    Judge(reply.flag, reply.busy);
  if (position) position_deg_ = *position / microsteps_per_deg_;
  position_asked_ = request.asked;
  if (!fault_.empty()) return ReportFault(request.asked);
  if (reply.busy) return Report(TableMotion::kMoving, position_deg_, "", request.asked);
  // The reply shows one flag only: a notice may hide one that matters.
  if (MeaningOf(reply.flag) == FlagMeaning::kNotice)
    return Send(Ask::kWarnings, options_.axis, "warnings");
  if (MeaningOf(reply.flag) == FlagMeaning::kDisturbed)
    return Send(Ask::kClear, options_.axis, "warnings clear");
  Stands();
}

void ZaberProtocol::HandleWarnings(const Message& reply) {
  bool disturbed = false;
  if (reply.rejected)
    SetFault(TableMotion::kFault, "no flags: " + RejectionInWords(reply.data), reply.busy);
  else
    Judge(reply.flag, reply.busy);
  // "02 WV WR": how many, and which.
  for (std::size_t at = 0; at < reply.data.size() && fault_.empty();) {
    const std::string flag = FirstWord(std::string_view(reply.data).substr(at));
    at += flag.size() + 1;
    if (flag.empty() || ParseNumber(flag)) continue;
    disturbed = disturbed || MeaningOf(flag) == FlagMeaning::kDisturbed;
    Judge(flag, reply.busy);
  }
  if (!fault_.empty()) return ReportFault(position_asked_);
  if (reply.busy) return Report(TableMotion::kMoving, position_deg_, "", position_asked_);
  if (disturbed) return Send(Ask::kClear, options_.axis, "warnings clear");
  Stands();
}

void ZaberProtocol::HandleCleared() {
  if ((goal_ == Goal::kHome || goal_ == Goal::kMove) && !sent_) return SendCommand();
  own_interrupt_ = false;
  Poll();
}

// Idle, and no flag says otherwise.
void ZaberProtocol::Stands() {
  if ((goal_ == Goal::kHome || goal_ == Goal::kMove) && !sent_) return;
  const double off_deg = position_deg_ - static_cast<double>(target_) / microsteps_per_deg_;
  if (goal_ == Goal::kMove && std::abs(off_deg) > kArrivalToleranceDeg) {
    if (!taken_) return SendCommandAgain();
    if (!astray_since_) astray_since_ = now();
    if (now() - *astray_since_ < kAstrayWait)
      return Report(TableMotion::kMoving, position_deg_, "", position_asked_);
    SetFault(
        TableMotion::kFault,
        Format("stands at %.3f degrees instead of %.3f", position_deg_, position_deg_ - off_deg),
        false);
    return ReportFault(position_asked_);
  }
  if (goal_ == Goal::kHome) {
    if (!taken_ && !was_busy_) return SendCommandAgain();
    if (reference_missing_) {
      SetFault(TableMotion::kUnhomed, "the homing ended without a reference position", false);
      must_home_ = true;
      return ReportFault(position_asked_);
    }
    must_home_ = false;
  }
  goal_ = Goal::kRest;
  referenced_ = true;
  own_interrupt_ = false;
  Report(TableMotion::kIdle, position_deg_, "", position_asked_);
}

bool ZaberProtocol::Judge(std::string_view flag, bool busy) {
  const std::string words = FlagInWords(flag);
  switch (MeaningOf(flag)) {
    case FlagMeaning::kNone:
      return true;
    case FlagMeaning::kNotice:
      if (noted_.insert(words).second) Note("the device reports " + words);
      return true;
    case FlagMeaning::kDisturbed:
      if (own_interrupt_) return true;
      SetFault(TableMotion::kFault, words, busy);
      return false;
    case FlagMeaning::kUnhomed:
      reference_missing_ = true;
      if (goal_ == Goal::kHome) return true;
      SetFault(TableMotion::kUnhomed,
               words + (referenced_ ? "; the device was reset, or lost it" : "; home it first"),
               busy);
      must_home_ = true;
      return false;
    case FlagMeaning::kFault:
      SetFault(TableMotion::kFault, words, busy);
      must_home_ = true;
      return false;
  }
  return false;
}

void ZaberProtocol::SetFault(TableMotion motion, std::string text, bool busy) {
  fault_motion_ = motion;
  fault_ = std::move(text);
  if (!busy) {
    goal_ = Goal::kRest;
  } else if (goal_ == Goal::kHome || goal_ == Goal::kMove) {
    goal_ = Goal::kStop;
    own_interrupt_ = true;
    Send(Ask::kStop, options_.axis, "stop");
  }
}

void ZaberProtocol::ReportFault(DeviceTime asked) {
  Report(fault_motion_, position_deg_, fault_, asked);
}

}  // namespace turnlight::rig::serial::zaber
