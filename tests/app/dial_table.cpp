#include "tests/app/dial_table.h"

#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "base/format.h"
#include "rig/serial/line_protocol.h"
#include "rig/serial/serial_turntable.h"

namespace turnlight::app {
namespace {

using rig::TableMotion;

constexpr std::size_t kLongestLine = 80;
constexpr rig::DeviceTime kAnswerWithin = std::chrono::milliseconds(500);
constexpr rig::DeviceTime kPollEvery = std::chrono::milliseconds(50);
constexpr int kTimesSent = 2;  // all requests are absolute: one that is repeated does no harm
constexpr double kArrivedWithin = 0.02;  // degrees

class DialProtocol final : public rig::serial::LineProtocol {
 public:
  DialProtocol() : LineProtocol(kLongestLine) {}

  void Home() override { Command("HOME", 0.0); }
  void MoveTo(double position_deg) override {
    Command(Format("GO %.2f", position_deg), position_deg);
  }
  void Halt() override { Command("STOP", std::nullopt); }

 private:
  void Begin() override {
    target_deg_.reset();
    Send("ID");
  }
  // From here on it moves, until an answer to a question asked after the command proves otherwise.
  void Command(const std::string& request, std::optional<double> target_deg) {
    target_deg_ = target_deg;
    Send(request);
    Report(TableMotion::kMoving, position_deg_, "", now());
  }
  void Send(const std::string& request) {
    request_ = request;
    asked_ = now();
    sent_ = 1;
    Write(request + "\n");
    WakeIn(kAnswerWithin);
  }
  void HandleTime() override {
    if (request_.empty()) return Send("AT");
    if (++sent_ > kTimesSent) return Fail("the dial does not answer to " + request_, false);
    if (request_ != "AT") Note(request_ + " was sent again: it was not answered");
    Write(request_ + "\n");
    WakeIn(kAnswerWithin);
  }

  void HandleLine(const std::string& line) override {
    const std::size_t end = line.find(' ');
    const std::string word = line.substr(0, end);
    if (word.size() < 3 || (word[0] != '=' && word[0] != '!')) return BadLine(line);
    if (word.substr(1) != request_.substr(0, request_.find(' '))) return;  // of an earlier request
    const std::string rest = end == std::string::npos ? "" : line.substr(end + 1);
    if (word == "=AT") return Stands(line, rest);
    if (word == "=ID") return Identify(rest);
    if (word[0] == '!') {
      refusal_ = request_ + ": " + rest;
      Note("refused: " + refusal_);
    } else {
      refusal_.clear();
    }
    Send("AT");
  }
  void Identify(const std::string& answer) {
    const std::size_t serial = answer.rfind(" SN");
    if (!answer.starts_with("DIAL 2") || serial == std::string::npos)
      return Fail("it is '" + answer + "', allowed is DIAL 2", true);
    Tell({{"Example", answer.substr(0, serial), answer.substr(serial + 1)}, {}});
    Send("AT");
  }
  void Stands(const std::string& line, const std::string& answer) {
    std::istringstream words(answer);
    std::string state;
    double position_deg = 0.0;
    if (!(words >> state >> position_deg)) return BadLine(line);  // then it is asked again
    position_deg_ = position_deg;
    request_.clear();
    WakeIn(kPollEvery);
    const bool elsewhere = target_deg_ && std::abs(position_deg - *target_deg_) > kArrivedWithin;
    if (state == "MOVING") {
      Report(TableMotion::kMoving, position_deg, "", asked_);
    } else if (state == "LOST") {
      Report(TableMotion::kUnhomed, position_deg, "the dial has no reference: home it", asked_);
    } else if (state != "READY") {
      Report(TableMotion::kFault, position_deg, "the dial reports " + answer, asked_);
    } else if (!refusal_.empty() || elsewhere) {
      const std::string why = refusal_.empty() ? "it came to rest on the way" : refusal_;
      Report(TableMotion::kFault, position_deg, why, asked_);
    } else {
      Report(TableMotion::kIdle, position_deg, "", asked_);
    }
  }

  std::string request_;  // unanswered; empty: none
  rig::DeviceTime asked_{};
  int sent_ = 0;
  std::optional<double> target_deg_;
  double position_deg_ = 0.0;
  std::string refusal_;  // of the last command
};

}  // namespace

std::unique_ptr<rig::serial::StageProtocol> MakeDialProtocol() {
  return std::make_unique<DialProtocol>();
}

Result<rig::TableDevice> MakeDialTable(StrictObject keys) {
  rig::serial::SerialKeys read = rig::serial::ReadSerialKeys(keys, "dial", 9600);
  if (const Status status = keys.Finish(); !status) return Forward(status);
  auto table =
      std::make_shared<rig::serial::SerialTurntable>(std::move(read.options), MakeDialProtocol());
  return rig::TableDevice{std::move(table), read.kinematics, true};
}

}  // namespace turnlight::app
