#include "rig/sim/stage/stage_simulator.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <type_traits>
#include <utility>

namespace turnlight::rig::sim::stage {
namespace {

constexpr std::size_t kMaxOutput = 65536;
constexpr std::size_t kChunk = 4096;
constexpr double kBitsPerByte = 10.0;
constexpr int kTickMs = 1;
constexpr auto kIdleTick = std::chrono::milliseconds(2);
// Of the commanded angle, as the hosts' commands and GRBL's reports have three decimals.
constexpr double kDecimalsDeg = 1e-3;

std::unique_ptr<StageFirmware> MakeFirmware(const StageConfig& config,
                                            const std::shared_ptr<MockTurntable>& table) {
  return std::visit(
      [&](const auto& own) -> std::unique_ptr<StageFirmware> {
        using Own = std::decay_t<decltype(own)>;
        if constexpr (std::is_same_v<Own, GrblConfig>)
          return std::make_unique<GrblFirmware>(own, table);
        else if constexpr (std::is_same_v<Own, ZaberConfig>)
          return std::make_unique<ZaberFirmware>(own, table);
        else
          return std::make_unique<Smc100Firmware>(own, table);
      },
      config.firmware);
}

bool IsFedByUsb(const StageConfig& config) {
  return std::holds_alternative<GrblConfig>(config.firmware);
}

}  // namespace

StageSimulator::StageSimulator(const StageConfig& config, std::shared_ptr<FaultScript> faults,
                               SimulatorEpoch epoch, LockFile lock)
    : config_(config),
      faults_(std::move(faults)),
      epoch_(epoch),
      lock_(std::move(lock)),
      table_(std::make_shared<MockTurntable>(config.table, faults_)),
      firmware_(MakeFirmware(config, table_)),
      line_(faults_, table_) {}

Result<std::unique_ptr<StageSimulator>> StageSimulator::Start(const StageConfig& config,
                                                              std::shared_ptr<FaultScript> faults,
                                                              SimulatorEpoch epoch) {
  std::error_code error;
  if (config.link.has_parent_path())
    std::filesystem::create_directories(config.link.parent_path(), error);
  if (error) return SystemError(config.link.parent_path().string() + ": " + error.message());
  auto lock = LockFile::Take(config.link.string() + ".lock",
                             config.link.string() + ": another simulator has this port");
  if (!lock) return Forward(lock);
  if (faults) faults->SetResolution(std::max(kDecimalsDeg, 1.0 / config.table.steps_per_deg));
  std::unique_ptr<StageSimulator> simulator(
      new StageSimulator(config, std::move(faults), epoch, std::move(*lock)));
  const DeviceTime now = simulator->Now();
  if (Status status = simulator->Plug(now); !status) return Forward(status);
  simulator->firmware_->PowerOn(now);
  simulator->thread_ = std::thread([raw = simulator.get()] { raw->Run(); });
  return simulator;
}

StageSimulator::~StageSimulator() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (terminal_) RemovePortLink(config_.link, terminal_->name());
}

std::string StageSimulator::port() const {
  const std::lock_guard lock(mutex_);
  return port_;
}

DeviceTime StageSimulator::Now() const { return std::chrono::steady_clock::now() - epoch_; }

Status StageSimulator::Plug(DeviceTime now) {
  auto terminal = PseudoTerminal::Open(last_name_);
  if (!terminal) return Forward(terminal);
  if (Status status = PointPortLink(config_.link, terminal->name()); !status) return status;
  terminal_ = std::move(*terminal);
  last_name_ = terminal_->name();
  has_client_ = false;
  input_free_ = output_free_ = now;
  const std::lock_guard lock(mutex_);
  port_ = terminal_->name();
  return {};
}

void StageSimulator::Unplug(DeviceTime now, double for_ms) {
  {
    const std::lock_guard lock(mutex_);
    port_.clear();  // before the host can see it
  }
  RemovePortLink(config_.link, terminal_->name());
  terminal_.reset();
  output_.clear();
  line_.Clear();
  if (IsFedByUsb(config_)) table_->Cut(now);
  plugged_at_ = now + DeviceTime(static_cast<std::int64_t>(for_ms * 1e6));
}

void StageSimulator::Run() {
  while (!stop_) Step();
}

void StageSimulator::Step() {
  const DeviceTime now = Now();
  if (!terminal_) {
    if (!IsFedByUsb(config_)) firmware_->Pass(now);
    // A port that could not be made is tried again: the host sees it as still unplugged.
    if (now >= plugged_at_ && Plug(now) && IsFedByUsb(config_)) firmware_->PowerOn(now);
    std::this_thread::sleep_for(kIdleTick);
    return;
  }
  if (faults_)
    if (const auto fault = faults_->Strike(FaultKind::kUnplugged, FaultDevice::kTable,
                                           table_->CommandedAngleDeg(now), now))
      return Unplug(now, fault->amount);
  if (line_.IsSilent(now)) {
    std::this_thread::sleep_for(kIdleTick);
    return;
  }
  WatchClient(now);
  ReadInput(now);
  firmware_->Pass(now);
  for (const FirmwareMessage& message : firmware_->TakeMessages())
    if (has_client_) line_.Send(message, now);
  WriteOutput(now);
  if (has_client_ && input_free_ <= now)
    terminal_->WaitForInput(kTickMs);
  else
    std::this_thread::sleep_for(kIdleTick / 2);
}

void StageSimulator::WatchClient(DeviceTime now) {
  const bool has_client = terminal_->HasClient();
  if (has_client == has_client_) return;
  has_client_ = has_client;
  if (has_client && config_.reset_on_open) firmware_->PowerOn(now);
  if (has_client) return;
  output_.clear();
  line_.Clear();
  terminal_->DiscardOutput();
}

std::size_t StageSimulator::Budget(DeviceTime& from, DeviceTime now) const {
  if (config_.baud == 0) return kChunk;
  const double byte_ns = 1e9 * kBitsPerByte / config_.baud;
  // The line does not save up what it could have carried while it was idle.
  from = std::max(from, now - std::chrono::milliseconds(5));
  const auto waited = static_cast<double>((now - from).count());
  return waited < 0.0 ? 0 : std::min(kChunk, static_cast<std::size_t>(waited / byte_ns) + 1);
}

void StageSimulator::ReadInput(DeviceTime now) {
  const std::size_t most = Budget(input_free_, now);
  if (most == 0) return;
  const std::string bytes = terminal_->Read(most);
  if (bytes.empty()) {
    input_free_ = now;
    return;
  }
  if (config_.baud > 0)
    input_free_ += DeviceTime(static_cast<std::int64_t>(static_cast<double>(bytes.size()) * 1e9 *
                                                        kBitsPerByte / config_.baud));
  firmware_->Receive(bytes, now);
}

void StageSimulator::WriteOutput(DeviceTime now) {
  const bool idle = output_.empty();
  output_ += line_.Take(now);
  if (output_.size() > kMaxOutput) output_.resize(kMaxOutput);
  if (output_.empty()) return;
  if (idle) output_free_ = std::max(output_free_, now);
  const std::size_t most = Budget(output_free_, now);
  if (most == 0) return;
  const std::size_t count = terminal_->Write(std::string_view(output_).substr(0, most));
  output_.erase(0, count);
  if (config_.baud > 0)
    output_free_ += DeviceTime(
        static_cast<std::int64_t>(static_cast<double>(count) * 1e9 * kBitsPerByte / config_.baud));
}

Result<std::unique_ptr<StageSimulator>> StartStage(StrictObject object, SimulatedWorld& world,
                                                   SimulatorEpoch epoch) {
  auto config = ReadStageConfig(std::move(object), world.config.table);
  if (!config) return Forward(config);
  auto simulator = StageSimulator::Start(*config, world.faults, epoch);
  if (simulator) world.table = (*simulator)->table();
  return simulator;
}

}  // namespace turnlight::rig::sim::stage
