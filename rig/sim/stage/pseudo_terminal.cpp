#include "rig/sim/stage/pseudo_terminal.h"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

namespace turnlight::rig::sim::stage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTerminals = "/dev/pts/";

std::string ErrnoText() { return std::strerror(errno); }

int PollOnce(int fd, short events, int milliseconds) {
  pollfd entry{fd, events, 0};
  return poll(&entry, 1, milliseconds) < 0 ? 0 : entry.revents;
}

// Without a name if it could not be made; errno says why.
std::pair<int, std::string> MakeTerminal() {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (master < 0) return {-1, ""};
  std::array<char, 64> name{};
  termios mode{};
  bool good = grantpt(master) == 0 && unlockpt(master) == 0 &&
              ptsname_r(master, name.data(), name.size()) == 0 && tcgetattr(master, &mode) == 0;
  if (good) {
    cfmakeraw(&mode);
    good = tcsetattr(master, TCSANOW, &mode) == 0;
  }
  // Only after it was open once does the system say that nobody has it open.
  const int slave = good ? open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;
  if (slave >= 0) {
    close(slave);
    return {master, name.data()};
  }
  close(master);
  return {-1, ""};
}

bool PointsTo(const fs::path& link, const std::string& target) {
  std::error_code error;
  return fs::read_symlink(link, error) == fs::path(target) && !error;
}

}  // namespace

Result<PseudoTerminal> PseudoTerminal::Open(const std::string& not_name) {
  auto made = MakeTerminal();
  if (made.first >= 0 && made.second == not_name) {  // the next one has another name, as this stays
    const int unwanted = made.first;
    made = MakeTerminal();
    close(unwanted);
  }
  if (made.first < 0) return SystemError("no pseudo-terminal: " + ErrnoText());
  return PseudoTerminal(made.first, made.second);
}

PseudoTerminal::~PseudoTerminal() {
  if (master_ >= 0) close(master_);
}

PseudoTerminal::PseudoTerminal(PseudoTerminal&& other) noexcept
    : master_(std::exchange(other.master_, -1)), name_(std::move(other.name_)) {}

PseudoTerminal& PseudoTerminal::operator=(PseudoTerminal&& other) noexcept {
  std::swap(master_, other.master_);
  std::swap(name_, other.name_);
  return *this;
}

bool PseudoTerminal::HasClient() const { return (PollOnce(master_, POLLIN, 0) & POLLHUP) == 0; }

std::string PseudoTerminal::Read(std::size_t most) {
  std::string bytes(most, '\0');
  const ssize_t count = read(master_, bytes.data(), most);
  bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return bytes;
}

std::size_t PseudoTerminal::Write(std::string_view bytes) {
  const ssize_t count = write(master_, bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

// What the other end holds can only be thrown away there.
void PseudoTerminal::DiscardOutput() {
  const int slave = open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (slave < 0) return;
  tcflush(slave, TCIFLUSH);
  close(slave);
}

void PseudoTerminal::WaitForInput(int milliseconds) const {
  PollOnce(master_, POLLIN, milliseconds);
}

Status CheckPortLink(const fs::path& link) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(link, error);
  if (!fs::exists(status)) return {};
  const bool ours =
      fs::is_symlink(status) && fs::read_symlink(link, error).string().rfind(kTerminals, 0) == 0;
  if (ours) return {};
  return InputError(link.string() +
                    ": there is something else under this name, allowed is a free name or a link "
                    "to a pseudo-terminal");
}

Status PointPortLink(const fs::path& link, const std::string& target) {
  std::error_code error;
  if (link.has_parent_path()) fs::create_directories(link.parent_path(), error);
  if (Status status = CheckPortLink(link); !status) return status;
  const fs::path temporary = link.string() + "." + std::to_string(getpid());
  fs::remove(temporary, error);
  fs::create_symlink(target, temporary, error);
  if (!error) fs::rename(temporary, link, error);
  if (error) return SystemError(link.string() + ": " + error.message());
  return {};
}

void RemovePortLink(const fs::path& link, const std::string& target) {
  std::error_code error;
  if (PointsTo(link, target)) fs::remove(link, error);
}

}  // namespace turnlight::rig::sim::stage
