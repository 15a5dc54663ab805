#include "app/doctor/computer_checks.h"

#include <fcntl.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <string>
#include <system_error>

#include "base/file.h"
#include "base/format.h"
#include "base/random.h"
#include "base/stopwatch.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTrialBytes = std::size_t{32} << 20;
constexpr int kTrialParts = 8;         // each synced, as pictures are
constexpr double kDiskShare = 0.5;     // of the time of a frame that the disk may take
constexpr double kRoomForMore = 2.0;   // times what the plan needs
constexpr double kMostDrift = 500e-6;  // what a clock is disciplined by at most
constexpr double kClockTrialS = 0.2;

std::optional<DiskNeed> NeedOf(const Patient& patient) {
  if (!patient.devices.camera || !patient.devices.table) return std::nullopt;
  const auto estimate =
      rig::EstimatePlan(patient.config.plan, patient.devices.table->kinematics,
                        patient.devices.camera->format, patient.devices.camera->readout_s);
  return DiskNeed{static_cast<double>(estimate.bytes_per_frame),
                  estimate.seconds / static_cast<double>(estimate.frames),
                  static_cast<double>(estimate.bytes)};
}

// Where runs will be: the folder, or the nearest above it that is there.
fs::path FolderThatIsThere(const fs::path& folder) {
  std::error_code error;
  fs::path there = fs::absolute(folder, error);
  while (!fs::is_directory(there, error) && there.has_relative_path()) there = there.parent_path();
  return there;
}

// Bytes per second, each part synced to the disk. Bytes that no file system makes smaller.
Result<double> MeasureDisk(const fs::path& folder) {
  std::string name = (folder / ".turnlight-doctor-XXXXXX").string();
  const int file = SystemFileOps().MakeTemporary(name.data());
  if (file < 0) return SystemError(folder.string() + ": " + std::generic_category().message(errno));
  SystemFileOps().Unlink(name.c_str());
  const RandomStream random(1, 0);
  std::string part(kTrialBytes / kTrialParts, '\0');
  for (std::size_t i = 0; i + 8 <= part.size(); i += 8) {
    const auto bits = static_cast<std::uint64_t>(random.Uniform(i) * 0x1p64);
    part.replace(i, 8, reinterpret_cast<const char*>(&bits), 8);
  }
  const Stopwatch stopwatch;
  bool good = true;
  for (int i = 0; good && i < kTrialParts; ++i)
    good = WriteAll(file, part) && SystemFileOps().Sync(file) == 0;
  const int error = errno;
  const double seconds = stopwatch.Seconds();
  SystemFileOps().Close(file);
  if (!good) return SystemError(folder.string() + ": " + std::generic_category().message(error));
  return static_cast<double>(kTrialBytes) / seconds;
}

double ReadClock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

Check JudgeDiskSpeed(double bytes_per_s, const std::optional<DiskNeed>& need) {
  const std::string figure = Format("%.3g MB/s, synced", 1e-6 * bytes_per_s);
  if (!need) return Fine(figure);
  const double seconds = need->bytes_per_frame / bytes_per_s;
  const std::string all =
      figure + Format(": %.2g s for a frame of at most %.3g MB, of which one comes in %.2g s",
                      seconds, 1e-6 * need->bytes_per_frame, need->seconds_per_frame);
  if (seconds <= kDiskShare * need->seconds_per_frame) return Fine(all);
  const std::string advice = "write to a faster disk: turnlight run ... --out DIR";
  return seconds <= need->seconds_per_frame ? Warning(all, advice)
                                            : Warning(all + ": the table will wait for it", advice);
}

Check JudgeFreeSpace(double free_bytes, const std::optional<DiskNeed>& need) {
  const std::string figure = Format("%.4g GB free", 1e-9 * free_bytes);
  if (!need) return Fine(figure);
  const std::string all = figure + Format(", the plan needs at most %.3g GB", 1e-9 * need->bytes);
  const std::string advice = "make room, or write to another disk: turnlight run ... --out DIR";
  if (free_bytes < need->bytes) return Failed(all, advice);
  return free_bytes < kRoomForMore * need->bytes ? Warning(all, advice) : Fine(all);
}

Check JudgeTimeOfDay(bool synchronised, double error_s) {
  if (synchronised) return Fine(Format("synchronised, to within %.2g s", error_s));
  return Warning("not synchronised; it is a label only, nothing is timed by it",
                 "sudo timedatectl set-ntp true");
}

Check CheckDiskSpeed(Patient& patient) {
  const auto speed = MeasureDisk(FolderThatIsThere(patient.options.out));
  if (!speed) return Failed(speed.error().text, "name a folder that you may write to: --out DIR");
  return JudgeDiskSpeed(*speed, NeedOf(patient));
}

Check CheckFreeSpace(Patient& patient) {
  const fs::path folder = FolderThatIsThere(patient.options.out);
  const auto bytes = SystemFileOps().FreeBytes(folder.c_str());
  if (bytes < 0) return Skipped(folder.string() + " does not say how much space is free");
  return JudgeFreeSpace(static_cast<double>(bytes), NeedOf(patient));
}

Check CheckSteadyClock(Patient&) {
  const double begun = ReadClock(CLOCK_MONOTONIC), raw_begun = ReadClock(CLOCK_MONOTONIC_RAW);
  double last = begun, back = 0.0;
  while (last - begun < kClockTrialS) {
    const double now = ReadClock(CLOCK_MONOTONIC);
    back = std::max(back, last - now);
    last = now;
  }
  const double raw = ReadClock(CLOCK_MONOTONIC_RAW) - raw_begun;
  const double drift = (last - begun) / raw - 1.0;
  const std::string figure =
      Format("CLOCK_MONOTONIC goes %.3g ppm beside the raw oscillator", 1e6 * drift);
  if (back > 0.0)
    return Failed(Format("CLOCK_MONOTONIC went back by %.3g s", back),
                  "another clock source: cat "
                  "/sys/devices/system/clocksource/clocksource0/available_clocksource");
  // The two readings are not at the same instant.
  const double unsure = 1e-4 / kClockTrialS;
  if (std::abs(drift) <= kMostDrift + unsure) return Fine(figure + ", never back");
  return Warning(figure, "let the time synchronisation settle, then look again");
}

Check CheckTimeOfDay(Patient&) {
  timex state{};
  const int answer = adjtimex(&state);
  return JudgeTimeOfDay(answer >= 0 && answer != TIME_ERROR && !(state.status & STA_UNSYNC),
                        1e-6 * static_cast<double>(state.maxerror));
}

}  // namespace turnlight::app
