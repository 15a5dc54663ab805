// The first byte chooses the options; the rest is a GRBL's words in pieces, commands and the
// passing of time. Whatever comes: the next wait is above 0 and bounded, so is what is said, and
// the first arrival that is reported for a move is one at its target.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "rig/serial/grbl/grbl_protocol.h"

namespace turnlight::rig::serial {
namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

// A byte below 32 that is no end of a line is an instruction, all others are what the controller
// says.
class StageFuzz {
 public:
  explicit StageFuzz(StageProtocol& protocol) : protocol_(protocol) { protocol_.Connect(); }

  void Run(std::string_view bytes) {
    std::string piece;
    for (const char byte : bytes) {
      const bool said = static_cast<unsigned char>(byte) >= 32 || byte == '\r' || byte == '\n';
      if (said) {
        piece += byte;
        continue;
      }
      Receive(piece);
      piece.clear();
      Obey(byte);
    }
    Receive(piece);
    protocol_.Leave();
    Look();
  }

 private:
  static constexpr double kTargetDeg = 10.0;

  void Receive(const std::string& bytes) {
    protocol_.Receive(bytes);
    Look();
  }
  void Obey(char instruction) {
    switch (instruction) {
      case 1:
        if (identified_) protocol_.Home();
        moving_ = false;
        break;
      case 2:
        if (!identified_) break;
        protocol_.MoveTo(kTargetDeg);
        protocol_.TakeEvents();  // of before
        moving_ = true;
        break;
      case 3:
        if (identified_) protocol_.Halt();
        moving_ = false;
        break;
      case 4:
        protocol_.Connect();
        identified_ = moving_ = false;
        break;
      case 5:
      case 6:
      case 7:
        for (int i = 0; i < 1 << (2 * (instruction - 5)); ++i) {
          protocol_.Pass(protocol_.Until());
          Look();
        }
        return;
      default:
        protocol_.Pass(std::chrono::milliseconds(instruction));
    }
    Look();
  }
  void Look() {
    Require(protocol_.Until() > DeviceTime(0));
    Require(protocol_.Until() <= std::chrono::minutes(1));
    Require(protocol_.TakeOutput().size() < 4096);
    const auto events = protocol_.TakeEvents();
    Require(events.size() < 100'000);
    for (const StageEvent& event : events) {
      if (std::holds_alternative<StageIdentified>(event)) identified_ = true;
      if (const auto* failed = std::get_if<StageFailed>(&event)) Require(!failed->text.empty());
      const auto* report = std::get_if<StageReport>(&event);
      if (!report) continue;
      // The first Idle after a move is one at its target.
      if (moving_ && report->motion == TableMotion::kIdle)
        Require(std::abs(report->position_deg - kTargetDeg) < 0.1);
      moving_ = moving_ && report->motion == TableMotion::kMoving;
      Require(report->age >= DeviceTime(0));
      const bool bad =
          report->motion == TableMotion::kFault || report->motion == TableMotion::kUnhomed;
      Require(bad == !report->fault.empty());
    }
  }

  StageProtocol& protocol_;
  bool identified_ = false;
  bool moving_ = false;
};

}  // namespace
}  // namespace turnlight::rig::serial

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace serial = turnlight::rig::serial;
  if (size == 0) return 0;
  serial::grbl::GrblOptions options;
  if (data[0] & 1) options.home = serial::grbl::Homing::kHere;
  if (data[0] & 2) options.lamp_power = 1.0;
  if (data[0] & 4) options.axis = 'A';
  serial::grbl::GrblProtocol protocol(options);
  serial::StageFuzz(protocol).Run({reinterpret_cast<const char*>(data) + 1, size - 1});
  return 0;
}
