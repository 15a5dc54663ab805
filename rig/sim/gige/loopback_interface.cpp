#include "rig/sim/gige/loopback_interface.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <cstdlib>
#include <cstring>

namespace turnlight::rig::sim::gige {
namespace {

thread_local in_addr_t shown_address = 0;  // network order; 0: the system's list

constexpr in_addr_t kFirst = 0x7F000000, kMask = 0xFF000000;

// One allocation, as glibc's lists are: freeifaddrs frees the first entry.
struct OneInterface {
  ifaddrs entry;
  sockaddr_in address, mask;
  char name[4];
};
static_assert(offsetof(OneInterface, entry) == 0);

sockaddr_in SocketAddress(in_addr_t address) {
  sockaddr_in socket_address{};
  socket_address.sin_family = AF_INET;
  socket_address.sin_addr.s_addr = address;
  return socket_address;
}

int ListLoopback(in_addr_t address, ifaddrs** list) {
  auto* one = static_cast<OneInterface*>(std::calloc(1, sizeof(OneInterface)));
  if (!one) return -1;
  one->address = SocketAddress(address);
  one->mask = SocketAddress(htonl(kMask));
  std::memcpy(one->name, "lo", 3);
  one->entry.ifa_name = one->name;
  one->entry.ifa_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK;
  one->entry.ifa_addr = reinterpret_cast<sockaddr*>(&one->address);
  one->entry.ifa_netmask = reinterpret_cast<sockaddr*>(&one->mask);
  one->entry.ifa_broadaddr = reinterpret_cast<sockaddr*>(&one->address);
  *list = &one->entry;
  return 0;
}

int ListSystems(ifaddrs** list) {
  using Function = int (*)(ifaddrs**);
  static const auto kSystems = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "getifaddrs"));
  return kSystems ? kSystems(list) : -1;
}

}  // namespace

LoopbackInterface::LoopbackInterface(const std::string& address) {
  in_addr parsed{};
  if (::inet_pton(AF_INET, address.c_str(), &parsed) == 1 &&
      (ntohl(parsed.s_addr) & kMask) == kFirst)
    shown_address = parsed.s_addr;
}

LoopbackInterface::~LoopbackInterface() { shown_address = 0; }

}  // namespace turnlight::rig::sim::gige

// NOLINTNEXTLINE: the system's name
extern "C" int getifaddrs(ifaddrs** list) noexcept {
  using namespace turnlight::rig::sim::gige;  // NOLINT: the system knows no namespaces
  return shown_address ? ListLoopback(shown_address, list) : ListSystems(list);
}
