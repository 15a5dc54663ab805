// Plays a device to a stage's protocol: the input says what arrives, how it is split, what is
// commanded and how time passes. An arrival that nothing has proven, output or events without
// bound, and a wait of no length are failures.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "rig/serial/stage_protocol.h"

namespace turnlight {

class StageFuzzer {
 public:
  // The answer of a device to a line that was sent, as it would be or as choice has it otherwise.
  using Answer = std::string (*)(const std::string& sent, double target_deg, std::uint8_t choice);

  StageFuzzer(rig::serial::StageProtocol& protocol, Answer answer)
      : protocol_(protocol), answer_(answer) {}

  void Run(std::string_view input) {
    protocol_.Connect();
    Take(0);
    while (!input.empty()) {
      const auto operation = Next(input);
      Step(operation, input);
      Require(protocol_.Until() > rig::DeviceTime::zero());
    }
  }

 private:
  static constexpr std::size_t kPerLine = 256;  // bytes sent at most for a line that came

  static void Require(bool condition) {
    if (!condition) std::abort();
  }

  static std::uint8_t Next(std::string_view& input) {
    if (input.empty()) return 0;
    const auto byte = static_cast<std::uint8_t>(input.front());
    input.remove_prefix(1);
    return byte;
  }

  void Step(std::uint8_t operation, std::string_view& input) {
    switch (operation % 8) {
      case 0:
        Command(Next(input));
        break;
      case 1:
        protocol_.Pass(std::chrono::milliseconds(Next(input) * 4));
        Take(1);
        break;
      case 2:
        protocol_.Pass(protocol_.Until());
        Take(1);
        break;
      case 3: {
        const std::string_view chunk = input.substr(0, Next(input));
        input.remove_prefix(chunk.size());
        Receive(std::string(chunk));
        break;
      }
      default: {
        // Whole, or in two parts.
        const std::string reply = answer_(last_line_, target_deg_, Next(input)) + "\r\n";
        const std::size_t cut = operation / 8 % (reply.size() + 1);
        Receive(reply.substr(0, cut));
        Receive(reply.substr(cut));
      }
    }
  }

  void Command(std::uint8_t choice) {
    waiting_ = false;
    if (choice % 4 == 0) {
      protocol_.Home();
    } else if (choice % 4 == 1) {
      protocol_.Halt();
    } else if (choice == 255) {
      protocol_.Connect();
      identified_ = false;
    } else {
      target_deg_ = choice - 128.0;
      waiting_ = identified_;
      protocol_.MoveTo(target_deg_);
    }
    Take(1);
  }

  void Receive(const std::string& bytes) {
    protocol_.Pass(rig::DeviceTime::zero());
    Take(1);
    protocol_.Receive(bytes);
    Take(1 + bytes.size() / 2);
  }

  void Take(std::size_t lines) {
    const std::string output = protocol_.TakeOutput();
    Require(output.size() <= kPerLine * (lines + 1));
    if (const std::size_t end = output.rfind('\n'); end != output.npos) {
      const std::size_t before = output.rfind('\n', end == 0 ? 0 : end - 1);
      last_line_ = output.substr(before == output.npos || before == end ? 0 : before + 1);
    }
    const auto events = protocol_.TakeEvents();
    Require(events.size() <= 8 * (lines + 1));
    for (const auto& event : events) Check(event);
  }

  void Check(const rig::serial::StageEvent& event) {
    Require(!over_ || !identified_);
    if (const auto* report = std::get_if<rig::serial::StageReport>(&event)) {
      Require(identified_ && std::isfinite(report->position_deg));
      Require(report->age >= rig::DeviceTime::zero());
      const bool sound =
          report->motion == rig::TableMotion::kIdle || report->motion == rig::TableMotion::kMoving;
      Require(sound == report->fault.empty());
      if (report->motion != rig::TableMotion::kIdle) return;
      if (waiting_) Require(std::abs(report->position_deg - target_deg_) < 0.03);
      waiting_ = false;
    } else if (std::holds_alternative<rig::serial::StageIdentified>(event)) {
      Require(!identified_);
      identified_ = true;
      over_ = false;
    } else if (std::holds_alternative<rig::serial::StageFailed>(event)) {
      over_ = true;
      waiting_ = false;
    }
  }

  rig::serial::StageProtocol& protocol_;
  const Answer answer_;
  std::string last_line_;
  double target_deg_ = 0.0;
  bool identified_ = false, over_ = false;
  bool waiting_ = false;  // for the proof of the last move
};

}  // namespace turnlight
