#include "app/doctor/port_checks.h"

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <system_error>

#include "rig/serial/serial_link.h"

namespace turnlight::app {
namespace {

constexpr char kNoPort[] = "the table is on no serial port";
constexpr char kStablePrefix[] = "/dev/serial/by-id/";

std::string UserName() {
  const passwd* user = getpwuid(geteuid());
  return user ? user->pw_name : std::to_string(geteuid());
}

// Fails as FindPort does. Empty: the table is on no serial port.
Result<std::string> PortOf(const Patient& patient) {
  const std::string path = TextOf(patient.config.table, "port");
  const std::string serial = TextOf(patient.config.table, "usb_serial");
  if (path.empty() && serial.empty()) return std::string();
  return rig::serial::FindPort({path, serial});
}

std::optional<rig::serial::PortInfo> InfoOfPort(const std::string& path) {
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  if (error) return std::nullopt;
  for (const rig::serial::PortInfo& info : rig::serial::FindPorts())
    if (info.path == real) return info;
  return std::nullopt;
}

PortAccess AccessOf(const std::string& path) {
  PortAccess access{path, false, false, false, "", UserName()};
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return access;
  access.there = true;
  access.allowed = ::access(path.c_str(), R_OK | W_OK) == 0;
  access.group_may = (info.st_mode & 060) == 060;
  const group* owner = getgrgid(info.st_gid);
  access.group = owner ? owner->gr_name : std::to_string(info.st_gid);
  return access;
}

// A rule that names the port and says who may open it.
std::string PortRule(const rig::serial::PortInfo& info) {
  const std::size_t colon = info.usb_ids.find(':');
  return "SUBSYSTEM==\"tty\", ATTRS{idVendor}==\"" + info.usb_ids.substr(0, colon) +
         "\", ATTRS{idProduct}==\"" + info.usb_ids.substr(colon + 1) + "\", " +
         (info.usb_serial.empty() ? "" : "ATTRS{serial}==\"" + info.usb_serial + "\", ") +
         "SYMLINK+=\"turntable\", GROUP=\"dialout\", MODE=\"0660\"";
}

}  // namespace

Check JudgePortAccess(const PortAccess& access) {
  if (!access.there)
    return Failed(access.path + " is not there",
                  "switch the controller on and plug it in; turnlight devices lists the ports");
  if (access.allowed) return Fine(access.path + ", yours to read and write");
  std::error_code error;
  const std::filesystem::path device = std::filesystem::weakly_canonical(access.path, error);
  if (device.string().starts_with("/dev/pts/"))
    return Failed(access.path + ": it is another user's pseudo-terminal",
                  "run the simulated controller as " + access.user);
  if (!access.group_may || access.group == "root")
    return Failed(access.path + ": " + access.user + " may not open it, nor may a group",
                  "add to /etc/udev/rules.d/60-turnlight.rules: SUBSYSTEM==\"tty\", KERNEL==\"" +
                      device.filename().string() +
                      "\", GROUP=\"dialout\", MODE=\"0660\"; then sudo udevadm control --reload "
                      "&& sudo udevadm trigger, and sudo usermod -aG dialout " +
                      access.user + ", and log in anew");
  return Failed(access.path + ": only the group " + access.group + " may open it, and " +
                    access.user + " is not in it",
                "sudo usermod -aG " + access.group + " " + access.user + ", then log in anew");
}

Check JudgePortName(const std::string& named, const std::optional<rig::serial::PortInfo>& info) {
  if (named.starts_with(kStablePrefix)) return Fine(named + " stays the same");
  if (!info || info->usb_ids.empty())
    return Skipped(named + " is no USB adapter: its name does not change with the plugs");
  if (!info->stable_path.empty())
    return Warning(named + " may be another device after it is plugged in again",
                   "put into the config, under rig/table: port: " + info->stable_path);
  return Warning(
      named +
          " may be another device after it is plugged in again, and udev gives it no other name",
      "add to /etc/udev/rules.d/60-turnlight.rules: " + PortRule(*info) +
          "; then sudo udevadm control --reload && sudo udevadm trigger, and put into "
          "the config port: /dev/turntable");
}

Check CheckPortAccess(Patient& patient) {
  if (!patient.config.table) return Skipped(kNoTable);
  const auto path = PortOf(patient);
  if (!path) return Failed(path.error().text, "plug it in; turnlight devices lists the ports");
  return path->empty() ? Skipped(kNoPort) : JudgePortAccess(AccessOf(*path));
}

Check CheckPortHolder(Patient& patient) {
  if (!patient.config.table) return Skipped(kNoTable);
  const auto path = PortOf(patient);
  if (!path || path->empty()) return Skipped(kNoPort);
  std::error_code error;
  if (!std::filesystem::exists(*path, error)) return Skipped(*path + " is not there");
  // A simulator opens the other end of a pseudo-terminal, and may hold this one besides.
  const std::string holders = rig::serial::HoldersOf(*path);
  if (holders.empty()) return Fine("free");
  return Warning("open in " + holders,
                 "end that program, unless it is the simulator of a simulated controller, which "
                 "holds the port by right");
}

Check CheckPortName(Patient& patient) {
  if (!patient.config.table) return Skipped(kNoTable);
  if (const std::string serial = TextOf(patient.config.table, "usb_serial"); !serial.empty())
    return Fine("found by the USB serial number " + serial);
  const std::string path = TextOf(patient.config.table, "port");
  return path.empty() ? Skipped(kNoPort) : JudgePortName(path, InfoOfPort(path));
}

}  // namespace turnlight::app
