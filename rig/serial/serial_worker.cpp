#include "rig/serial/serial_worker.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::serial {
namespace {

using std::chrono::milliseconds;

constexpr auto kReconnectEvery = milliseconds(250);
constexpr auto kWriteDeadline = milliseconds(2000);
constexpr auto kHaltAtExit = milliseconds(3000);
constexpr auto kGoodbye = milliseconds(300);
constexpr std::size_t kMaxNotes = 100;

int PollTimeout(DeviceTime until) {
  return static_cast<int>(
      std::clamp<std::int64_t>(std::chrono::ceil<milliseconds>(until).count(), 0, 1000));
}

}  // namespace

SerialTurntable::Worker::Worker(SerialTurntableOptions options,
                                std::unique_ptr<StageProtocol> protocol)
    : options_(std::move(options)),
      protocol_(std::move(protocol)),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      thread_([this] { Run(); }) {}

SerialTurntable::Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  eventfd_write(wake_, 1);
  thread_.join();
  close(wake_);
}

bool SerialTurntable::Worker::Quitting() const {
  const std::lock_guard lock(mutex_);
  return quit_;
}

void SerialTurntable::Worker::Run() {
  while (!Quitting()) {
    if (!link_) Connect();
    if (link_)
      Converse();
    else
      Wait();
    const std::lock_guard lock(mutex_);
    if (state_ == Link::kRefused) break;
  }
  SayGoodbye();
}

void SerialTurntable::Worker::Connect() {
  const auto path = usb_serial_ ? FindPort({"", *usb_serial_}) : FindPort(options_.port);
  if (!path) return Lose(path.error().text, false);
  auto link = OpenSerialLink(*path, options_.line);
  if (!link) return Lose(link.error().text, false);
  link_ = std::move(*link);
  if (!usb_serial_) usb_serial_ = UsbSerialOf(*path);
  output_.clear();
  output_moved_ = passed_ = Clock::now();
  protocol_->Connect();
  const std::lock_guard lock(mutex_);
  port_in_use_ = *path + " by " + link_->Backend();
}

void SerialTurntable::Worker::Converse() {
  ServeWishes();
  output_ += protocol_->TakeOutput();
  OnEvents();
  if (!link_) return;
  if (!Flush()) return Lose("the port is gone: unplugged, or its other end closed", false);
  if (Clock::now() - output_moved_ > kWriteDeadline)
    return Lose("the port takes no more bytes: flow control, or a controller that hangs", false);
  Wait();
  TakeIn();
  OnEvents();
}

void SerialTurntable::Worker::ServeWishes() {
  while (true) {
    std::optional<Wish> wish;
    {
      const std::lock_guard lock(mutex_);
      if (state_ != Link::kReady || wishes_.empty()) return;
      wish = std::move(wishes_.front());
      wishes_.pop_front();
      ++served_;
    }
    Serve(std::move(*wish));
  }
}

void SerialTurntable::Worker::Serve(Wish wish) {
  legs_left_.clear();
  homing_ = wish.kind == Kind::kHome;
  if (wish.kind == Kind::kHome) return protocol_->Home();
  if (wish.kind == Kind::kHalt) return protocol_->Halt();
  legs_left_.assign(wish.legs_deg.begin() + 1, wish.legs_deg.end());
  protocol_->MoveTo(wish.legs_deg.front());
  const std::lock_guard lock(mutex_);
  if (turns_ != wish.turns)
    notes_.push_back(Format("the stage unwinds by %d turn(s), as its travel ends",
                            std::abs(turns_ - wish.turns)));
  turns_ = wish.turns;
}

// False if the port is gone.
bool SerialTurntable::Worker::Flush() {
  if (output_.empty()) {
    output_moved_ = Clock::now();
    return true;
  }
  const auto written = link_->Write(output_);
  if (!written) return false;
  if (*written > 0) output_moved_ = Clock::now();
  output_.erase(0, *written);
  return true;
}

void SerialTurntable::Worker::Wait() {
  pollfd files[2] = {{wake_, POLLIN, 0}, {-1, 0, 0}};
  int timeout = static_cast<int>(milliseconds(kReconnectEvery).count());
  if (link_) {
    files[1] = {link_->handle(), static_cast<short>(output_.empty() ? POLLIN : POLLIN | POLLOUT),
                0};
    timeout = PollTimeout(protocol_->Until());
  }
  poll(files, link_ ? 2 : 1, timeout);
  eventfd_t ignored = 0;
  eventfd_read(wake_, &ignored);
}

// Time first: what comes now came after it had passed.
void SerialTurntable::Worker::TakeIn() {
  const auto now = Clock::now();
  protocol_->Pass(now - passed_);
  passed_ = now;
  const auto bytes = link_->Read();
  if (!bytes) return Lose(bytes.error().text, false);
  if (!bytes->empty()) protocol_->Receive(*bytes);
}

void SerialTurntable::Worker::OnEvents() {
  for (const StageEvent& event : protocol_->TakeEvents()) {
    if (!link_) return;  // lost by the event before
    if (const auto* identified = std::get_if<StageIdentified>(&event)) OnIdentified(*identified);
    if (const auto* report = std::get_if<StageReport>(&event)) OnReport(*report);
    if (const auto* failed = std::get_if<StageFailed>(&event))
      return Lose(failed->text, failed->for_good);
    if (const auto* note = std::get_if<StageNote>(&event)) {
      const std::lock_guard lock(mutex_);
      if (notes_.size() < kMaxNotes) notes_.push_back(note->text);
    }
  }
}

void SerialTurntable::Worker::OnIdentified(const StageIdentified& event) {
  StageIdentified now = event;
  if (now.identity.serial.empty()) now.identity.serial = usb_serial_.value_or("");
  std::unique_lock lock(mutex_);
  if (identified_ && (identified_->identity.serial != now.identity.serial ||
                      identified_->identity.model != now.identity.model)) {
    const std::string was = identified_->identity.model + " " + identified_->identity.serial;
    lock.unlock();
    return Lose("another controller came back: " + now.identity.model + " " + now.identity.serial +
                    ", allowed is " + was,
                true);
  }
  if (identified_) must_home_ = "its port was lost and is back: home it";
  identified_ = std::move(now);
  report_.reset();
  wishes_.clear();
  served_ = wished_;
  turns_ = 0;
}

void SerialTurntable::Worker::OnReport(const StageReport& report) {
  if (report.motion == TableMotion::kIdle && !legs_left_.empty()) {
    protocol_->MoveTo(legs_left_.front());
    legs_left_.erase(legs_left_.begin());
    return;
  }
  if (report.motion != TableMotion::kMoving) legs_left_.clear();
  lost_why_.clear();
  const std::lock_guard lock(mutex_);
  if (homing_ && report.motion == TableMotion::kIdle) {
    must_home_.clear();
    turns_ = 0;
    last_angle_deg_ = (options_.reversed ? -1.0 : 1.0) * report.position_deg;
  }
  if (report.motion != TableMotion::kMoving) homing_ = halting_ = false;
  report_ = report;
  report_of_ = served_;
  report_time_ = passed_ - report.age;
  state_ = Link::kReady;
  changed_.notify_all();
}

void SerialTurntable::Worker::Lose(std::string why, bool for_good) {
  legs_left_.clear();
  const std::lock_guard lock(mutex_);
  if (link_) {
    why = port_in_use_.substr(0, port_in_use_.find(' ')) + ": " + why;
    lost_why_ = why;
  } else if (!lost_why_.empty()) {
    why = lost_why_ + "; it is not back yet: " + why;
  }
  link_.reset();
  state_ = for_good ? Link::kRefused : Link::kLost;
  error_ = std::move(why);
  report_.reset();
  wishes_.clear();
  served_ = wished_;
  halting_ = false;
  changed_.notify_all();
}

void SerialTurntable::Worker::SayGoodbye() {
  const auto halted_by = Clock::now() + kHaltAtExit;
  const auto halting = [this] {
    const std::lock_guard lock(mutex_);
    return halting_;
  };
  while (link_ && halting() && Clock::now() < halted_by) Converse();
  if (!link_) return;
  protocol_->Leave();
  output_ += protocol_->TakeOutput();
  const auto said_by = Clock::now() + kGoodbye;
  while (Flush() && !output_.empty() && Clock::now() < said_by)
    std::this_thread::sleep_for(milliseconds(5));
  link_.reset();
}

}  // namespace turnlight::rig::serial
