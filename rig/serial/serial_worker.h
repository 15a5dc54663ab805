// The thread of a SerialTurntable: it owns port and protocol, and talks. What others may know of it
// is guarded by its mutex.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "rig/caller_clock.h"
#include "rig/serial/serial_turntable.h"

namespace turnlight::rig::serial {

class SerialTurntable::Worker {
 public:
  using Clock = std::chrono::steady_clock;

  Worker(SerialTurntableOptions options, std::unique_ptr<StageProtocol> protocol);
  ~Worker();

  Result<DeviceIdentity> Open();
  Status Home();
  Status MoveTo(double angle_deg);
  Status Halt();
  // now: the caller's clock at this instant.
  Result<TableState> State(DeviceTime now);
  std::vector<std::string> TakeNotes();
  std::optional<StageTraits> traits() const;
  std::string port_in_use() const;

 private:
  enum class Link { kConnecting, kReady, kLost, kRefused };
  enum class Kind { kHome, kMove, kHalt };
  // What a caller asked for; moves in positions of the controller.
  struct Wish {
    Kind kind;
    std::vector<double> legs_deg;
    int turns = 0;
  };

  void Run();
  void Connect();
  void Converse();
  void Serve(Wish wish);
  void ServeWishes();
  bool Flush();
  void Wait();
  void TakeIn();
  void OnEvents();
  void OnIdentified(const StageIdentified& event);
  void OnReport(const StageReport& report);
  void Lose(std::string why, bool for_good);
  void SayGoodbye();
  void Ask(Wish wish);
  bool Quitting() const;
  std::optional<Travel> TravelOf() const;

  const SerialTurntableOptions options_;

  // Of the thread alone.
  std::unique_ptr<StageProtocol> protocol_;
  std::unique_ptr<SerialLink> link_;
  std::optional<std::string> usb_serial_;
  std::string output_;
  Clock::time_point output_moved_{};  // when the port last took something
  Clock::time_point passed_{};        // until when the protocol knows of time
  std::vector<double> legs_left_;
  bool homing_ = false;
  std::string lost_why_;  // the first reason since it was last there

  int wake_ = -1;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Link state_ = Link::kConnecting;
  std::string error_;  // why it is lost or refused
  std::optional<StageIdentified> identified_;
  std::deque<Wish> wishes_;
  std::uint64_t wished_ = 0;  // wishes so far
  std::uint64_t served_ = 0;  // those that the protocol was told
  std::optional<StageReport> report_;
  std::uint64_t report_of_ = 0;  // served_ when it came
  Clock::time_point report_time_{};
  std::string must_home_;  // why the position is not to be trusted, whatever the controller says
  int turns_ = 0;
  double last_angle_deg_ = 0.0;  // commanded
  std::vector<std::string> notes_;
  std::string port_in_use_;
  bool halting_ = false;
  CallerClock clock_;
  bool quit_ = false;
  std::thread thread_;  // the last, so that all else is there
};

}  // namespace turnlight::rig::serial
