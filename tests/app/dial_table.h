// A table driver as docs/hardware.md adds one: a turntable "dial" on a serial port, whose language
// is made up for this. A request is a line, and so is its answer, which begins with "=", or "!" if
// it is refused, and the request's word:
//
//   ID          =ID DIAL 2 SN17
//   AT          =AT READY 12.50        or MOVING, LOST (no reference), FAULT 12.50 in words
//   GO 120.00   =GO                    it has begun to move; !GO and why not
//   HOME, STOP  =HOME, =STOP           the same
#pragma once

#include <memory>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/driver.h"
#include "rig/serial/stage_protocol.h"

namespace turnlight::app {

std::unique_ptr<rig::serial::StageProtocol> MakeDialProtocol();
// Keys: those that all serial tables have.
Result<rig::TableDevice> MakeDialTable(StrictObject keys);

}  // namespace turnlight::app
