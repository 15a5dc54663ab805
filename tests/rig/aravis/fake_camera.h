// Aravis' own simulated GigE Vision camera, on the real protocol, with pictures, a description
// (GenICam XML) and a clock that a test chooses.
//
// Its port is fixed, so that every process has an address of its own: 127.x.y.z by its process
// number, which getifaddrs tells Aravis is the loopback interface's.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rig/aravis/gobject.h"

namespace turnlight::rig::aravis {

// "127.x.y.z", of this process.
std::string TestAddress();

// A description, of pieces. Registers from 0x8000 on are memory and nothing else.
struct Description {
  // Names of features; empty: there is none.
  std::string exposure = "ExposureTime";  // a float, or with ExposureTimeRaw a whole number
  std::string gain = "Gain";              // a float in dB over 0..24, or with GainRaw 0..10
  std::string trigger_command = "TriggerSoftware";
  std::vector<std::string> trigger_sources{"Line0", "Software"};
  std::vector<std::string> trigger_selectors{"FrameStart"};
  bool trigger_mode = true;
  bool trigger_works = true;          // false: the command is acknowledged and nothing happens
  bool trigger_mode_works = true;     // false: On is read back, and the camera runs on
  std::vector<std::string> autos;     // enumerations Off, Continuous; beginning with Continuous
  std::vector<std::string> switches;  // booleans, beginning true
  std::string stuck;                  // one of autos that knows no Off
  std::string latch, latch_value;     // the value is that of register 0x8100, 64 bits
  std::string tick_frequency;         // feature; its value is 0x8110
  std::string black_level, temperature;
  std::string extra;  // XML
};
std::string Xml(const Description& description);

class FakeCamera {
 public:
  // Fills a picture of width * height pixels; called by the camera's thread, exposure and gain as
  // their registers are.
  struct Picture {
    std::uint8_t* data;
    std::size_t bytes;
    int width, height;
    unsigned exposure_us, gain;
    ArvBuffer* buffer;  // its stamp and id may be changed
  };
  using Fill = std::function<void(const Picture&)>;

  // description: XML, or empty for Aravis' own.
  explicit FakeCamera(const std::string& xml, Fill fill = nullptr,
                      const std::string& serial = "TEST1");
  ~FakeCamera();

  void LosePackets(double share);
  void Write(std::uint32_t address, std::uint32_t value);
  std::uint32_t Read(std::uint32_t address) const;
  // The value of a latch: 64 bits, high word first.
  void WriteClock(std::int64_t ticks);

 private:
  static void OnFill(ArvBuffer* buffer, void* self, guint32 exposure_us, guint32 gain,
                     ArvPixelFormat format);

  std::string xml_path_;
  Owned<ArvGvFakeCamera> camera_;
  Fill fill_;
};

// The same in a process of its own, that can be killed. Pictures are Aravis' own pattern.
class CameraProcess {
 public:
  explicit CameraProcess(const std::string& serial);
  ~CameraProcess();
  void Kill();
  void Freeze();
  void Thaw();

 private:
  pid_t pid_ = -1;
};

}  // namespace turnlight::rig::aravis
