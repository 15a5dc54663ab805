#include "rig/sim/gige/address_lock.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace turnlight::rig::sim::gige {
namespace {

constexpr std::uint16_t kControlPort = 3956;  // of GigE Vision

// A socket's name that is in no folder begins with a zero.
socklen_t NameOf(const std::string& address, sockaddr_un& name) {
  const std::string text = "turnlight-gige-" + address;
  name.sun_family = AF_UNIX;
  std::copy(text.begin(), text.end(), name.sun_path + 1);
  return static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
}

// " by process 123", if that can be learnt.
std::string Holder(const sockaddr_un& name, socklen_t size) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  ucred peer{};
  socklen_t peer_size = sizeof peer;
  const bool known = fd >= 0 &&
                     ::connect(fd, reinterpret_cast<const sockaddr*>(&name), size) == 0 &&
                     ::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &peer_size) == 0;
  if (fd >= 0) ::close(fd);
  return known ? " by process " + std::to_string(peer.pid) : "";
}

}  // namespace

Result<AddressLock> AddressLock::Take(const std::string& address) {
  sockaddr_un name{};
  const socklen_t size = NameOf(address, name);
  AddressLock lock(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const bool taken = lock.fd_ < 0 ||
                     ::bind(lock.fd_, reinterpret_cast<const sockaddr*>(&name), size) != 0 ||
                     ::listen(lock.fd_, 8) != 0;
  if (taken)
    return InputError(address + ":3956: taken" + Holder(name, size) +
                      ", a simulated camera; allowed is an address with no camera on it");
  const auto free = IsFree(address);
  if (!free) return Forward(free);
  if (!*free)
    return InputError(address +
                      ":3956: taken by another camera, allowed is an address with none on it");
  return lock;
}

AddressLock::~AddressLock() {
  if (fd_ >= 0) ::close(fd_);
}

AddressLock::AddressLock(AddressLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Result<bool> IsFree(const std::string& address) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(kControlPort);
  ::inet_pton(AF_INET, address.c_str(), &at.sin_addr);
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool bound = fd >= 0 && ::bind(fd, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0;
  const int error = errno;
  if (fd >= 0) ::close(fd);
  if (bound) return true;
  if (error == EADDRINUSE) return false;
  return InputError(address + ":3956: " + std::strerror(error) +
                    ", allowed is an address of this machine");
}

}  // namespace turnlight::rig::sim::gige
