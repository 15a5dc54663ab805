// The registers of the simulated camera: those that Aravis' fake camera acts on, and our own in the
// part of its memory that it leaves alone. All are 32 bits, the high byte first.
//
// The fake's own trigger registers are not in the XML: a frame is sent when this process asks for
// it, after the exposure, and clients trigger by a register of ours.
#pragma once

#include <cstdint>

namespace turnlight::rig::sim::gige {

enum class Register : std::uint32_t {
  // The fake's.
  kWidth = 0x100,
  kHeight = 0x104,
  kGainTenthsDb = 0x110,
  kSensorHeight = 0x118,
  kSensorWidth = 0x11C,
  kExposureUs = 0x120,
  kAcquisition = 0x124,
  kPixelFormat = 0x128,
  kAcquisitionMode = 0x12C,
  kOffsetX = 0x130,
  kOffsetY = 0x134,
  kSendMode = 0x300,  // this and the next 1: by kSend
  kSendSource = 0x304,
  kSend = 0x30C,  // 1: the fake sends a frame and puts it back to 0
  // Ours.
  kTriggerMode = 0x8000,
  kTriggerSource = 0x8004,
  kTriggerActivation = 0x8008,
  kTriggerSelector = 0x800C,
  kTriggerSoftware = 0x8010,  // 1 until it has been seen
  kFramePeriodUs = 0x8014,    // of free running
  kBlackLevelDn = 0x8018,
  kTemperatureTenths = 0x801C,  // degrees Celsius
  kExposureAuto = 0x8020,
  kGainAuto = 0x8024,
  kTimestampLatch = 0x8028,
  kTimestampHigh = 0x8030,  // nanoseconds since 1970, refreshed about every half millisecond
  kTimestampLow = 0x8034,
  kParametersLocked = 0x8038,
  // GigE Vision's bootstrap registers.
  kMacHigh = 0x0008,
  kMacLow = 0x000C,
  kManufacturerName = 0x0048,  // 32 bytes
  kModelName = 0x0068,         // 32 bytes
  kDeviceVersion = 0x0088,     // 32 bytes
  kSerialNumber = 0x00D8,      // 16 bytes
  kUserName = 0x00E8,          // 16 bytes
  kHeartbeatTimeoutMs = 0x0938,
  kTickFrequencyHigh = 0x093C,
  kControlChannelPrivilege = 0x0A00,  // 0: no client is in control
  kStreamPort = 0x0D00,
  kStreamPacketSize = 0x0D04,  // in its lower half
  kStreamPacketDelay = 0x0D08,
  kStreamAddress = 0x0D18,
};

}  // namespace turnlight::rig::sim::gige
