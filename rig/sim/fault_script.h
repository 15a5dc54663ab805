// What goes wrong with the simulated devices, and when: an explicit list, a seeded draw, or both.
//
// YAML (every key is optional unless said):
//   list:
//     - {at: {keyframe: 3}, fault: lost_steps, deg: 2.0}     # at keyframe 3 of the capture's plan
//     - {at: {angle_deg: 120}, fault: stall, times: 2}       # whenever 120 degrees is commanded
//     - {at: {time_s: 12.5}, device: camera, fault: unplugged, ms: 300}   # from then on
//     - {fault: never_homes}                                 # the first occasion
//   random: {seed: 5, share: 0.2, faults: [dropped_frame, lost_steps]}
// `fault` is required; `times` (1 by default) is on how many occasions it strikes, then it is
// spent. `random` strikes each keyframe with probability `share`, once, with one of `faults`
// (default: all that a capture survives by itself). An occasion is: of table faults a MoveTo to
// that angle, of never_homes a Home, of camera faults a Trigger while that angle is commanded; of
// unplugged any call. A keyframe is known by its angle, so a repetition or a resumed capture counts
// the same.
//
// Which row of reference/faults ("faults a capture rig meets") each fault stands for:
//   lost_steps {deg: 1}      stalled motor, lost steps: the shaft ends short by so much; an encoder
//                            sees it, open loop does not
//   stall                    the shaft stops half-way. Encoder: noticed, kUnhomed. Open loop: not
//   late_arrival {ms: 400}   frame from the wrong angle: hangs half-way, reported as moving
//   wrong_position {deg: 1}  wrong position reported: stands right, reports wrong until it moves
//   alarm                    alarm flag in a move: stops half-way, kFault until homed
//   reset                    unexpected banner: stops half-way, kUnhomed, banner in the text
//   never_homes              homing never ends
//   unplugged {ms: 500}      USB unplug (device: camera or table, required): every call fails for
//   so
//                            long, then until Open. Table: unhomed. Camera: settings are lost
//   stale_frame {ms: 500}    stale frame: one exposed so long before the trigger comes first
//   duplicate_frame          duplicate frame: the previous frame comes again first, same id
//   dropped_frame            packet loss: exposed and counted, never delivered
//   incomplete_frame         partial frame: complete is false, the lower half is missing
//   blurred {deg: 0.5}       moved in exposure: the table creeps while the shutter is open
//   trigger_ignored          trigger ignored: no exposure, the id does not advance
//   untriggered_frame        frame untriggered: one more frame follows the answer
//   exposure_drift {share: 0.05}  exposure drift, auto left on: longer by that share, read back so
//   gain_drift {db: 0.5}     gain drift, read back so
//   flicker {share: 0.05}    flicker: brighter by that share, and nothing tells
//   lamp_off                 lamp off: ambient light only
//   saturated                saturation: every pixel at the saturation
//   all_black                all black: every pixel at the black level
//   control_lost             control lost: triggers are accepted, no frame comes, until Open
// Of simulated controllers on a serial line only (rig/sim/stage); mocks have no line and refuse
// them. An occasion is a MoveTo to that angle for limit and displaced, a Home for stuck_switch, any
// time for silent, and for the others a message of the kind named, while that angle is commanded:
//   serial_garbage {bytes: 40}  serial garbage: so many random bytes come before a message
//   split_line {ms: 20}      split lines: a message comes byte by byte, so far apart
//   nul_bytes                NUL: three of them inside a message
//   long_line {bytes: 4096}  over-long line: so many characters without an end before a message
//   dropped_reply            dropped `ok`: the answer to a command does not come
//   duplicate_reply          duplicate `ok`: it comes twice
//   late_reply {ms: 400}     late `ok`: it comes so much later, what was said since comes before
//   lost_status              swallowed status reply
//   altered_status           altered status reply: one of its characters is another one
//   silent {ms: 1500}        the controller hangs: nothing is answered for so long, then all of it
//   limit                    alarm in a move: a limit switch stops it half-way
//   stuck_switch             homing fails: its switch does not clear
//   displaced {deg: 0.5}     moved by hand, 50 ms after it arrived; only an encoder sees it
// Their unplugged is a hang-up of the line; the port comes back under another name. A controller
// rounds what it is commanded, so an angle of the script fits within its resolution.
//
// Wrong steps per revolution, direction and backlash are no events: MockTurntableConfig has them.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/device.h"

namespace turnlight::rig::sim {

enum class FaultKind {
  kLostSteps,
  kStall,
  kLateArrival,
  kWrongPosition,
  kAlarm,
  kReset,
  kNeverHomes,
  kUnplugged,
  kStaleFrame,
  kDuplicateFrame,
  kDroppedFrame,
  kIncompleteFrame,
  kBlurred,
  kTriggerIgnored,
  kUntriggeredFrame,
  kExposureDrift,
  kGainDrift,
  kFlicker,
  kLampOff,
  kSaturated,
  kAllBlack,
  kControlLost,
  kSerialGarbage,
  kSplitLine,
  kNulBytes,
  kLongLine,
  kDroppedReply,
  kDuplicateReply,
  kLateReply,
  kLostStatus,
  kAlteredStatus,
  kSilent,
  kLimit,
  kStuckSwitch,
  kDisplaced,
};

enum class FaultDevice { kTable, kCamera };

// The words of the YAML.
std::string FaultWord(FaultKind kind);
std::string FaultWord(FaultDevice device);

struct FaultEntry {
  FaultKind kind = FaultKind::kLostSteps;
  FaultDevice device = FaultDevice::kTable;
  std::optional<double> angle_deg;  // only while this angle is commanded
  std::optional<DeviceTime> from;   // not before
  double amount = 0.0;              // in the unit of the kind: deg, ms, bytes, share or dB
  int times = 1;                    // 1..1000000
};

// An entry with the kind's usual device (the table for kUnplugged) and amount, at any occasion.
FaultEntry MakeFault(FaultKind kind);

// The angles of the keyframes: start + k * step, as the capture commands them.
struct KeyframeAngles {
  double start_deg = 0.0;
  double step_deg = 10.0;
  int count = 36;
};

// Whether the devices are mocks or are spoken to on their real protocols: those have more faults.
enum class FaultWorld { kMocks, kRealProtocols };

// The entries of a script, `random` drawn. Messages name file, line, key and what is allowed.
Result<std::vector<FaultEntry>> ReadFaultScript(StrictObject object, const KeyframeAngles& angles,
                                                FaultWorld world = FaultWorld::kMocks);

struct FiredFault {
  FaultEntry entry;
  DeviceTime time{};
  double commanded_deg = 0.0;
};

// The script as it is played; shared by the devices. Safe to call from several threads.
class FaultScript {
 public:
  FaultScript() = default;
  explicit FaultScript(std::vector<FaultEntry> entries);

  // The table rounds what it is commanded to this much: an entry's angle fits within half of it.
  void SetResolution(double deg);
  // Whether a fault of this kind strikes this device now; each strike is counted. Several entries
  // that fit strike one after the other, on one occasion each, in the order of the script.
  std::optional<FaultEntry> Strike(FaultKind kind, FaultDevice device, double commanded_deg,
                                   DeviceTime now);
  // Everything that has struck, in order.
  std::vector<FiredFault> Fired() const;
  // Strikes that are still to come.
  int Remaining() const;

 private:
  mutable std::mutex mutex_;
  std::vector<FaultEntry> entries_;  // times counts down
  std::vector<FiredFault> fired_;
  double resolution_deg_ = 1e-6;
};

}  // namespace turnlight::rig::sim
