// Commands and requests: what is sent, when, and what a silence means. The answers are in
// zaber_answers.cpp.
#include "rig/serial/zaber/zaber_protocol.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::serial::zaber {
namespace {

// A device's own lines have 80 characters, unless it is set to longer ones.
constexpr std::size_t kLongestLine = 256;
// A device answers within milliseconds; a USB hub, a chain and a busy machine add to it.
constexpr DeviceTime kReplyWait = std::chrono::milliseconds(500);
constexpr std::size_t kTries = 4;
// Twice a command and its reply at 115200 baud, and some rest for the device.
constexpr DeviceTime kPollPeriod = std::chrono::milliseconds(20);
constexpr DeviceTime kPollGap = std::chrono::milliseconds(2);
// Above it a double holds no whole numbers, and no device counts so far.
constexpr double kFarthest = 1e15;

}  // namespace

ZaberProtocol::ZaberProtocol(const ZaberOptions& options)
    : LineProtocol(kLongestLine), options_(options) {}

void ZaberProtocol::Begin() {
  goal_ = Goal::kIdentify;
  setting_ = 0;
  other_name_ = ids_seen_ = busy_ = reference_missing_ = referenced_ = must_home_ = false;
  sent_ = deferred_ = clear_first_ = taken_ = sent_again_ = was_busy_ = own_interrupt_ = false;
  values_.clear();
  noted_.clear();
  fault_.clear();
  command_ids_.clear();
  other_device_.reset();
  partial_.reset();
  astray_since_.reset();
  Send(Ask::kHello, 0, "");
}

void ZaberProtocol::Home() {
  if (over() || goal_ == Goal::kIdentify) return;
  fault_.clear();
  StartCommand(Goal::kHome, true);
}

void ZaberProtocol::MoveTo(double position_deg) {
  if (over() || goal_ == Goal::kIdentify) return;
  if (must_home_) {
    SetFault(TableMotion::kUnhomed, fault_.empty() ? "home it first" : fault_, busy_);
    return;
  }
  const double target = std::round(position_deg * microsteps_per_deg_);
  const bool disturbed = !fault_.empty();
  fault_.clear();
  if (!(std::abs(target) <= kFarthest)) {
    SetFault(TableMotion::kFault, NumberText(position_deg) + " degrees are no position", busy_);
    return;
  }
  target_ = static_cast<long long>(target);
  StartCommand(Goal::kMove, disturbed);
}

void ZaberProtocol::Halt() {
  if (over() || goal_ == Goal::kIdentify) return;
  goal_ = Goal::kStop;
  own_interrupt_ = true;
  deferred_ = false;
  Send(Ask::kStop, options_.axis, "stop");
}

void ZaberProtocol::StartCommand(Goal goal, bool clear) {
  own_interrupt_ = own_interrupt_ || goal_ != Goal::kRest || busy_;
  goal_ = goal;
  sent_ = taken_ = sent_again_ = was_busy_ = false;
  astray_since_.reset();
  command_ids_.clear();
  clear_first_ = clear;
  // Without ids the answer that is due would be taken for this command's.
  deferred_ = request_ && !ids_seen_;
  if (!deferred_) SendCommand();
}

void ZaberProtocol::SendCommand() {
  if (std::exchange(clear_first_, false)) return Send(Ask::kClear, options_.axis, "warnings clear");
  sent_ = true;
  if (goal_ == Goal::kHome) {
    Send(Ask::kHome, options_.axis, "home");
  } else {
    Send(Ask::kMove, options_.axis, Format("move abs %lld", target_));
  }
  command_ids_ = request_->ids;
}

void ZaberProtocol::SendCommandAgain() {
  const std::string name = goal_ == Goal::kHome ? "home" : "move abs";
  if (std::exchange(sent_again_, true)) {
    SetFault(TableMotion::kFault, "'" + name + "' was sent twice and not answered", busy_);
    return ReportFault(position_asked_);
  }
  Note("'" + name + "' was not answered and the axis does not stand at its end: sent again");
  SendCommand();
}

void ZaberProtocol::Send(Ask ask, int axis, std::string text) {
  request_ = Request{ask, axis, std::move(text), {}, now()};
  Transmit();
}

void ZaberProtocol::Transmit() {
  const int id = std::exchange(next_id_, (next_id_ + 1) % 100);
  request_->ids.push_back(id);
  Write(FormatCommand(options_.device, request_->axis, id, request_->text));
  WakeIn(kReplyWait);
}

void ZaberProtocol::Poll() {
  if (goal_ == Goal::kRest) {
    Send(Ask::kPosition, options_.axis, "get pos");  // its reply has state and flag as well
  } else {
    Send(Ask::kStatus, options_.axis, "");
  }
}

void ZaberProtocol::PollLater(DeviceTime asked) {
  if (!request_) WakeIn(std::max(kPollPeriod - (now() - asked), kPollGap));
}

void ZaberProtocol::HandleTime() {
  if (request_) return HandleSilence();
  if (goal_ != Goal::kIdentify) Poll();
}

void ZaberProtocol::HandleSilence() {
  partial_.reset();
  const Ask ask = request_->ask;
  if (std::exchange(deferred_, false)) {
    request_.reset();
    return SendCommand();
  }
  if (ask == Ask::kMove || ask == Ask::kHome) {
    Note("no reply to '" + request_->text + "' yet: the state is asked for");
    return Send(Ask::kStatus, options_.axis, "");
  }
  const std::string who = Format("Zaber device %d", options_.device);
  if (ask == Ask::kHello && request_->ids.size() > 1 && !last_bad_line().empty())
    return Fail("what answers is no Zaber device that speaks ASCII: " + last_bad_line(), true);
  if (request_->ids.size() < kTries) return Transmit();
  const double silence_s = std::chrono::duration<double>(now() - request_->asked).count();
  if (ask == Ask::kHello && other_device_)
    return Fail(Format("%s does not answer, device %d does: see the key device", who.c_str(),
                       *other_device_),
                true);
  Fail(Format("%s does not answer to '%s' for %.1f s", who.c_str(), request_->text.c_str(),
              silence_s),
       false);
}

bool ZaberProtocol::Answers(const Message& reply) const {
  // A device with one axis may name itself as a whole.
  if (reply.axis != request_->axis && reply.axis != 0) return false;
  if (!reply.id) return !ids_seen_;
  return std::find(request_->ids.begin(), request_->ids.end(), *reply.id) != request_->ids.end();
}

}  // namespace turnlight::rig::serial::zaber
