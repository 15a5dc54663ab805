#include "app/table_motion.h"

#include <chrono>
#include <thread>

#include "base/format.h"
#include "nodes/frame_proof.h"

namespace turnlight::app {
namespace {

using std::chrono::milliseconds;

constexpr auto kPollEvery = milliseconds(20);
constexpr auto kHaltPatience = std::chrono::seconds(3);

Result<rig::TableState> Look(const TableMotion& motion) {
  auto state = motion.table->State(motion.clock->Now());
  for (const std::string& note : motion.table->TakeNotes()) motion.note(note);
  return state;
}

// Stops the motor and waits until it stands. Gives what became of that, to end a message with.
std::string HaltAndWait(const TableMotion& motion) {
  const rig::DeviceTime deadline = motion.clock->Now() + kHaltPatience;
  if (const Status halted = motion.table->Halt(motion.clock->Now()); !halted)
    return "and the motor could not be stopped: " + halted.error().text;
  while (motion.clock->Now() < deadline) {
    const auto state = Look(motion);
    if (!state) return "the motor was told to stop, then: " + state.error().text;
    if (state->motion != rig::TableMotion::kMoving)
      return Format("the motor was stopped, at %.3f degrees", state->angle_deg) +
             (state->fault.empty() ? "" : ": " + state->fault);
    std::this_thread::sleep_for(kPollEvery);
  }
  return "the motor was told to stop, and the table does not say that it stands";
}

}  // namespace

Result<rig::TableState> WaitUntilStill(const TableMotion& motion, rig::DeviceTime deadline) {
  const rig::DeviceTime begun = motion.clock->Now();
  while (true) {
    const auto state = Look(motion);
    if (!state) return Forward(state);
    if (state->motion != rig::TableMotion::kMoving) return *state;
    motion.watch(*state);
    if (StopRequested(motion.stop)) {
      motion.note(HaltAndWait(motion));
      return InterruptedError();
    }
    if (motion.clock->Now() >= deadline)
      return DeviceError(Format("the table still moves after %.3g s, at %.3f degrees; ",
                                ToSeconds(motion.clock->Now() - begun), state->angle_deg) +
                         HaltAndWait(motion));
    std::this_thread::sleep_for(kPollEvery);
  }
}

Result<rig::TableState> HomeTable(const TableMotion& motion, rig::DeviceTime patience) {
  const rig::DeviceTime now = motion.clock->Now();
  if (StopRequested(motion.stop)) return InterruptedError();
  if (const Status begun = motion.table->Home(now); !begun) return Forward(begun);
  const auto state = WaitUntilStill(motion, now + patience);
  if (!state) return Forward(state);
  if (state->motion == rig::TableMotion::kIdle) return *state;
  return DeviceError("homing failed: " + state->fault);
}

Result<rig::TableState> TurnTable(const TableMotion& motion, double angle_deg,
                                  rig::DeviceTime patience) {
  const rig::DeviceTime now = motion.clock->Now();
  if (StopRequested(motion.stop)) return InterruptedError();
  if (const Status begun = motion.table->MoveTo(angle_deg, now); !begun) return Forward(begun);
  const auto state = WaitUntilStill(motion, now + patience);
  if (!state) return Forward(state);
  if (const auto wrong = nodes::StandsAt(*state, angle_deg, motion.tolerance_deg))
    return DeviceError(*wrong);
  return *state;
}

}  // namespace turnlight::app
