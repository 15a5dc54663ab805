// A controller of twenty lines on a pseudo-terminal, for tests of ports and threads: it speaks
// enough GRBL to be homed and moved, and jumps instead of moving.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

namespace turnlight::rig::serial {

class TinyController {
 public:
  // name: of the board, as $I tells it.
  explicit TinyController(std::string name = "");
  ~TinyController();
  TinyController(const TinyController&) = delete;
  TinyController& operator=(const TinyController&) = delete;

  std::string path() const { return path_; }
  // Hangs: takes bytes and says nothing.
  void Mute() { mute_ = true; }
  // Every line and real-time byte that came, in order, one a line.
  std::string Heard() const;
  // The other end closes: what a cable does that is pulled.
  void Unplug();

 private:
  void Run();
  void Say(const std::string& text);
  void OnLine(const std::string& line);

  const std::string name_;
  std::string path_;
  int master_ = -1;
  std::atomic<bool> mute_{false}, stop_{false};
  double position_ = 0.0;
  mutable std::mutex mutex_;
  std::string heard_;
  std::thread thread_;
};

}  // namespace turnlight::rig::serial
