#include "rig/aravis/aravis_config.h"

#include <cmath>

#include "base/format.h"

namespace turnlight::rig::aravis {
namespace {

constexpr double kMaxSide = 65536.0;

std::vector<int> WholeNumbers(StrictObject& keys, const char* key, std::size_t count, double min) {
  std::vector<int> numbers;
  const auto read = keys.OptionalNumbers(key, count, {.min = 0.0, .max = kMaxSide});
  if (!read) return numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const double number = (*read)[i];
    // Of a region the first two may be 0, the sides may not.
    const double least = count == 4 && i < 2 ? 0.0 : min;
    if (number != std::floor(number) || number < least) {
      keys.Refuse(key, "whole numbers of pixels, sides from 1 to 65536");
      return {};
    }
    numbers.push_back(static_cast<int>(number));
  }
  return numbers;
}

void ReadRegion(StrictObject& keys, AravisConfig& config) {
  const bool has_size = keys.Has("size"), has_roi = keys.Has("roi");
  if (has_size == has_roi) {
    keys.RefuseText("size", "give either size, [width, height], or roi, [x, y, width, height]");
    return;
  }
  const auto size = WholeNumbers(keys, "size", 2, 1.0);
  const auto roi = WholeNumbers(keys, "roi", 4, 1.0);
  if (size.size() == 2) config.size = {size[0], size[1]};
  if (roi.size() == 4) {
    config.offset = {roi[0], roi[1]};
    config.size = {roi[2], roi[3]};
  }
}

}  // namespace

Result<AravisConfig> ReadAravisConfig(StrictObject keys) {
  AravisConfig config;
  config.id = keys.String("id");
  if (config.id.empty() && keys.ok())
    keys.Refuse("id", "a camera's id, serial number or address, as `turnlight devices` lists them");
  const std::string format = keys.Choice("pixel_format", PixelFormatNames());
  config.format = FindPixelFormat(format).value_or(PixelFormat());
  ReadRegion(keys, config);
  const auto binning = WholeNumbers(keys, "binning", 2, 1.0);
  if (binning.size() == 2) config.binning = {binning[0], binning[1]};
  config.black_level = keys.OptionalNumber("black_level");
  config.gain_raw_step_db = keys.OptionalNumber("gain_raw_step_db", {.max = 10.0, .above = 0.0});
  config.readout_ms =
      keys.OptionalNumber("readout_ms", {.min = 0.0, .max = 10000.0}).value_or(config.readout_ms);
  if (const auto bytes = keys.OptionalInteger("packet_size", 576, 16000))
    config.packet_size = static_cast<int>(*bytes);
  config.packet_resend = keys.OptionalBoolean("packet_resend").value_or(config.packet_resend);
  config.packet_socket = keys.OptionalBoolean("packet_socket").value_or(config.packet_socket);
  config.socket_buffer_kb = static_cast<int>(
      keys.OptionalInteger("socket_buffer_kb", 64, 1000000).value_or(config.socket_buffer_kb));
  if (Status status = keys.Finish(); !status) return Forward(status);
  return config;
}

}  // namespace turnlight::rig::aravis
