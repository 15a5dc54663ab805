// A pseudo-terminal in raw mode, seen from the controller's side, and the fixed name that a host
// finds it by. Needs no privileges.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.h"

namespace turnlight::rig::sim::stage {

class PseudoTerminal {
 public:
  // Fails (kSystem) if the system has none left. not_name: it gets another name than this one, as
  // a device that is plugged in again does.
  static Result<PseudoTerminal> Open(const std::string& not_name = "");
  ~PseudoTerminal();  // hangs up: whoever has it open reads end of file or EIO
  PseudoTerminal(PseudoTerminal&& other) noexcept;
  PseudoTerminal& operator=(PseudoTerminal&& other) noexcept;

  const std::string& name() const { return name_; }  // "/dev/pts/3"
  // Whether anyone has it open.
  bool HasClient() const;
  // At most so many bytes that have come; never waits.
  std::string Read(std::size_t most);
  // How many were taken; never waits.
  std::size_t Write(std::string_view bytes);
  // What was written and not yet read by a client is lost.
  void DiscardOutput();
  // Waits until there is something to read, or so long.
  void WaitForInput(int milliseconds) const;

 private:
  PseudoTerminal(int master, std::string name) : master_(master), name_(std::move(name)) {}

  int master_ = -1;
  std::string name_;
};

// Whether the path is free or a link that a simulator may have left: a symbolic link to a
// pseudo-terminal. Otherwise fails (kInput) and names what it is.
Status CheckPortLink(const std::filesystem::path& link);
// Lets the link point there, in one step; makes its folder. Fails as CheckPortLink, or kSystem.
Status PointPortLink(const std::filesystem::path& link, const std::string& target);
// Removes it if it still points there.
void RemovePortLink(const std::filesystem::path& link, const std::string& target);

}  // namespace turnlight::rig::sim::stage
