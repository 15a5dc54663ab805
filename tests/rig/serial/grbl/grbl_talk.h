// A person at the other end of the line: says what a GRBL says, sees what it is told, and lets time
// pass. What is said can be cut into pieces of any length.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig/serial/grbl/grbl_protocol.h"

namespace turnlight::rig::serial::grbl {

// What a real board says when it is asked for its settings.
inline constexpr char kSettings[] =
    "$0=10\r\n$1=255\r\n$2=0\r\n$3=0\r\n$4=0\r\n$5=0\r\n$6=0\r\n$10=1\r\n$11=0.010\r\n$12=0.002\r\n"
    "$13=0\r\n$20=0\r\n$21=0\r\n$22=1\r\n$23=0\r\n$24=25.000\r\n$25=500.000\r\n$26=250\r\n"
    "$27=1.000\r\n$30=1000\r\n$31=0\r\n$32=0\r\n$100=88.889\r\n$101=250.000\r\n$102=250.000\r\n"
    "$110=3600.000\r\n$111=500.000\r\n$112=500.000\r\n$120=500.000\r\n$121=10.000\r\n"
    "$122=10.000\r\n$130=360.000\r\n$131=200.000\r\n$132=200.000\r\nok\r\n";
inline constexpr char kInfo[] = "[VER:1.1h.20190825:]\r\n[OPT:V,15,128]\r\nok\r\n";
inline constexpr char kStartup[] = "$N0=\r\n$N1=\r\nok\r\n";
inline constexpr char kOffsets[] =
    "[G54:0.000,0.000,0.000]\r\n[G55:0.000,0.000,0.000]\r\n[G28:0.000,0.000,0.000]\r\n"
    "[G92:0.000,0.000,0.000]\r\n[TLO:0.000]\r\n[PRB:0.000,0.000,0.000:0]\r\nok\r\n";
inline constexpr char kBannerText[] = "\r\nGrbl 1.1h ['$' for help]\r\n";

class Talk {
 public:
  explicit Talk(GrblOptions options = {}, std::size_t piece = 1000)
      : protocol(options), piece_(piece) {
    protocol.Connect();
  }

  // The controller says so.
  void Says(const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size(); at += piece_)
      protocol.Receive(bytes.substr(at, piece_));
    Collect();
  }
  // In steps that the protocol asks for.
  void Passes(int ms) {
    for (DeviceTime left = std::chrono::milliseconds(ms); left > DeviceTime(0);) {
      const DeviceTime step = std::min(left, protocol.Until());
      protocol.Pass(step);
      left -= step;
      Collect();
    }
  }
  // Since the last call.
  std::string Heard() {
    Collect();
    return std::exchange(heard_, {});
  }

  // From the banner to the first report.
  void Identifies(const std::string& settings = kSettings,
                  const std::string& status =
                      "<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>\r\n") {
    Passes(2600);
    Says("ok\r\n");
    Says(kInfo);
    Says(settings);
    Says(kStartup);
    Says(kOffsets);
    Says(status);
    Heard();
  }

  // The last of its kind so far, and none after it is taken.
  std::optional<StageReport> LastReport() { return std::exchange(report_, std::nullopt); }
  std::optional<StageFailed> failed;
  std::optional<StageIdentified> identified;
  std::vector<std::string> notes;
  GrblProtocol protocol;

 private:
  void Collect() {
    heard_ += protocol.TakeOutput();
    for (const StageEvent& event : protocol.TakeEvents()) {
      if (const auto* report = std::get_if<StageReport>(&event)) report_ = *report;
      if (const auto* note = std::get_if<StageNote>(&event)) notes.push_back(note->text);
      if (const auto* fail = std::get_if<StageFailed>(&event)) failed = *fail;
      if (const auto* who = std::get_if<StageIdentified>(&event)) identified = *who;
    }
  }

  std::size_t piece_;
  std::string heard_;
  std::optional<StageReport> report_;
};

}  // namespace turnlight::rig::serial::grbl
