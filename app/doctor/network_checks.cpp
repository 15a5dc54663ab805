#include "app/doctor/network_checks.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>
#include <system_error>

#include "base/format.h"
#include "rig/aravis/aravis_camera.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr char kNotGige[] = "the camera is not of GigE Vision";
constexpr char kNotUsb[] = "the camera is not of USB3 Vision";
constexpr long kJumboMtu = 9000;
constexpr long kUsbMemoryNeededMb = 200;  // a dozen pictures of a few megapixels
constexpr long kDefaultSocketBufferKb = 4000;
constexpr int kHeaders = 28;  // bytes of IP and UDP
constexpr std::uint16_t kGvcpPort = 3956;

bool IsAravis(const Patient& patient) {
  return TextOf(patient.config.camera, "driver") == "aravis";
}

std::string AddressOf(const Patient& patient) {
  if (patient.found) return patient.found->protocol == "USB3Vision" ? "" : patient.found->address;
  const std::string id = TextOf(patient.config.camera, "id");
  in_addr parsed{};
  return IsAravis(patient) && inet_pton(AF_INET, id.c_str(), &parsed) == 1 ? id : "";
}

bool IsUsb(const Patient& patient) {
  return IsAravis(patient) && (!patient.found || patient.found->protocol == "USB3Vision") &&
         AddressOf(patient).empty();
}

std::optional<long> NumberIn(const fs::path& file) {
  std::ifstream in(file);
  long number = 0;
  return in >> number ? std::optional(number) : std::nullopt;
}

std::string WordIn(const fs::path& file) {
  std::string word;
  std::ifstream(file) >> word;
  return word;
}

// Of the address that this computer would send from.
std::optional<in_addr> SenderTo(const in_addr& to) {
  const int handle = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (handle < 0) return std::nullopt;
  sockaddr_in peer{}, own{};
  peer.sin_family = AF_INET;
  peer.sin_addr = to;
  peer.sin_port = htons(kGvcpPort);
  socklen_t size = sizeof own;
  // Sends nothing: it only picks the route.
  const bool found = connect(handle, reinterpret_cast<const sockaddr*>(&peer), sizeof peer) == 0 &&
                     getsockname(handle, reinterpret_cast<sockaddr*>(&own), &size) == 0;
  close(handle);
  return found ? std::optional(own.sin_addr) : std::nullopt;
}

int PacketSizeOf(const Patient& patient) {
  if (!patient.camera) return 0;
  const auto* camera =
      dynamic_cast<const rig::aravis::AravisCamera*>(patient.devices.camera->camera.get());
  return camera ? camera->Report().packet_size : 0;
}

}  // namespace

std::string InterfaceTo(const std::string& address) {
  in_addr to{};
  if (inet_pton(AF_INET, address.c_str(), &to) != 1) return "";
  const auto own = SenderTo(to);
  ifaddrs* all = nullptr;
  if (!own || getifaddrs(&all) != 0) return "";
  std::string name;
  for (const ifaddrs* one = all; one && name.empty(); one = one->ifa_next) {
    if (!one->ifa_addr || one->ifa_addr->sa_family != AF_INET) continue;
    const auto* here = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
    if (here->sin_addr.s_addr == own->s_addr) name = one->ifa_name;
  }
  freeifaddrs(all);
  // Any address of 127.0.0.0/8 is on the loopback.
  return name.empty() && (ntohl(to.s_addr) >> 24) == 127 ? "lo" : name;
}

std::vector<UsbCamera> FindUsbCameras(const fs::path& sys, const fs::path& dev) {
  std::vector<UsbCamera> cameras;
  std::error_code error;
  for (const auto& interface : fs::directory_iterator(sys / "bus/usb/devices", error)) {
    // "Miscellaneous", "USB3 Vision".
    if (WordIn(interface.path() / "bInterfaceClass") != "ef" ||
        WordIn(interface.path() / "bInterfaceSubClass") != "05" ||
        WordIn(interface.path() / "bInterfaceProtocol") != "00")
      continue;
    const std::string name = interface.path().filename();  // 1-2:1.0 is of the device 1-2
    const fs::path device = interface.path().parent_path() / name.substr(0, name.find(':'));
    const auto bus = NumberIn(device / "busnum"), number = NumberIn(device / "devnum");
    if (!bus || !number) continue;
    UsbCamera camera;
    camera.node = (dev / Format("bus/usb/%03ld/%03ld", *bus, *number)).string();
    camera.vendor = WordIn(device / "idVendor");
    camera.allowed = access(camera.node.c_str(), R_OK | W_OK) == 0;
    cameras.push_back(camera);
  }
  return cameras;
}

Check JudgeUsbAccess(const std::vector<UsbCamera>& cameras) {
  if (cameras.empty())
    return Failed("no USB3 Vision camera is plugged in", "plug it into a USB 3 port");
  for (const UsbCamera& camera : cameras)
    if (!camera.allowed)
      return Failed(camera.node + ": your user may not open it",
                    "add to /etc/udev/rules.d/60-turnlight.rules: SUBSYSTEM==\"usb\", "
                    "ATTR{idVendor}==\"" +
                        camera.vendor +
                        "\", GROUP=\"plugdev\", MODE=\"0660\"; then sudo udevadm control --reload "
                        "&& sudo udevadm trigger, and sudo usermod -aG plugdev $USER, and log in "
                        "anew");
  return Fine(cameras.front().node + ", yours to open");
}

Check JudgeSocketBuffer(std::optional<long> allowed_bytes, long needed_bytes) {
  if (!allowed_bytes) return Skipped("net.core.rmem_max cannot be read");
  const std::string figure = Format("net.core.rmem_max %ld bytes, %ld asked for by the driver",
                                    *allowed_bytes, needed_bytes);
  if (*allowed_bytes >= needed_bytes) return Fine(figure);
  const std::string line = Format("net.core.rmem_max=%ld", needed_bytes);
  return Warning(
      figure + ": packets get lost when the program is busy",
      "sudo sysctl -w " + line + "; and for good, " + line + " in /etc/sysctl.d/60-turnlight.conf");
}

Check JudgeMtu(const std::string& interface, long mtu, int packet_size) {
  std::string figure = interface + Format(" takes packets of %ld bytes", mtu);
  if (packet_size > 0) figure += Format(", the camera sends %d", packet_size);
  const std::string line = "sudo ip link set dev " + interface + " mtu 9000";
  if (packet_size > mtu + kHeaders)
    return Failed(figure, line + ", or a smaller packet_size under rig/camera");
  if (mtu >= kJumboMtu) return Fine(figure);
  return Warning(figure + ": six times as many packets as there need be",
                 line + ", if the network card and every switch to the camera can");
}

Check CheckCameraSeen(Patient& patient) {
  if (!patient.config.camera) return Skipped(kNoCamera);
  if (!IsAravis(patient)) return Skipped("the camera is not one of Aravis");
  const auto cameras = rig::aravis::FindCameras();
  if (!cameras) return Failed(cameras.error().text, "check the network and the USB ports");
  const std::string id = TextOf(patient.config.camera, "id");
  patient.found = rig::aravis::CameraOf(*cameras, id);
  if (patient.found)
    return Fine(patient.found->id + " by " + patient.found->protocol + " at " +
                patient.found->address);
  const std::string seen = rig::aravis::DescribeCameras(*cameras);
  return AddressOf(patient).empty()
             ? Failed(id + " was not seen; " + seen,
                      "check its cable, power and address; turnlight devices lists the cameras")
             : Warning(id + " did not answer the search; " + seen,
                       "an address may be reached all the same, if not: check cable and power");
}

Check CheckUsbAccess(Patient& patient) {
  if (!patient.config.camera) return Skipped(kNoCamera);
  return IsUsb(patient) ? JudgeUsbAccess(FindUsbCameras("/sys", "/dev")) : Skipped(kNotUsb);
}

Check CheckUsbMemory(Patient& patient) {
  if (!patient.config.camera) return Skipped(kNoCamera);
  if (!IsUsb(patient)) return Skipped(kNotUsb);
  const char* const file = "/sys/module/usbcore/parameters/usbfs_memory_mb";
  const auto memory = NumberIn(file);
  if (!memory) return Skipped(std::string(file) + " cannot be read");
  const std::string figure = Format("%ld MB for all USB devices", *memory);
  if (*memory == 0 || *memory >= kUsbMemoryNeededMb) return Fine(figure);
  return Warning(figure + Format(", %ld MB hold some pictures", kUsbMemoryNeededMb),
                 Format("echo %ld | sudo tee ", kUsbMemoryNeededMb) + file);
}

Check CheckSocketBuffer(Patient& patient) {
  if (!patient.config.camera) return Skipped(kNoCamera);
  if (AddressOf(patient).empty()) return Skipped(kNotGige);
  StrictObject keys = *patient.config.camera;
  const nlohmann::json& kb = keys.Raw("socket_buffer_kb");
  const long needed = 1000 * (kb.is_number_integer() ? kb.get<long>() : kDefaultSocketBufferKb);
  return JudgeSocketBuffer(NumberIn("/proc/sys/net/core/rmem_max"), needed);
}

Check CheckMtu(Patient& patient) {
  if (!patient.config.camera) return Skipped(kNoCamera);
  const std::string address = AddressOf(patient);
  if (address.empty()) return Skipped(kNotGige);
  const std::string interface = InterfaceTo(address);
  if (interface.empty())
    return Failed("no network interface leads to " + address,
                  "give this computer's port an address in the camera's network");
  const auto mtu = NumberIn(fs::path("/sys/class/net") / interface / "mtu");
  return mtu ? JudgeMtu(interface, *mtu, PacketSizeOf(patient))
             : Skipped(interface + " does not say how large packets may be");
}

}  // namespace turnlight::app
