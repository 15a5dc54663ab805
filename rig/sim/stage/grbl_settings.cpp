#include "rig/sim/stage/grbl_settings.h"

#include <cmath>

#include "base/format.h"

namespace turnlight::rig::sim::stage {
namespace {

constexpr int kFirstAxisSetting = 100;

// Listed with three decimals, the others as whole numbers.
bool IsReal(int number) {
  return number == 11 || number == 12 || number == 24 || number == 25 || number == 27 ||
         (number >= kFirstAxisSetting && number < 140);
}

}  // namespace

GrblSettings::GrblSettings(const MockTurntableConfig& table, const std::string& axes, int axis,
                           const std::map<int, double>& overrides)
    : axis_(axis) {
  values_ = {{0, 10},
             {1, 255},
             {2, 0},
             {3, 0},
             {4, 0},
             {5, 0},
             {6, 0},
             {10, 1},
             {11, 0.01},
             {12, 0.002},
             {13, 0},
             {20, 0},
             {21, 0},
             {22, 0},
             {23, 0},
             {24, 0.2 * 60.0 * table.home_speed_deg_s},
             {25, 60.0 * table.home_speed_deg_s},
             {26, 250},
             {27, 1},
             {30, 1000},
             {31, 0},
             {32, 0}};
  for (int i = 0; i < static_cast<int>(axes.size()); ++i) {
    const bool turns = i == axis;
    values_[100 + i] = turns ? table.steps_per_deg : 250.0;
    values_[110 + i] = turns ? 60.0 * table.max_speed_deg_s : 500.0;
    values_[120 + i] = turns ? table.acceleration_deg_s2 : 10.0;
    values_[130 + i] = turns ? 360.0 : 200.0;
  }
  if (axes.size() > 3) values_[376] = 1;  // grblHAL: the first axis after XYZ is a rotary one
  for (const auto& [number, value] : overrides) values_[number] = value;
}

std::string GrblSettings::Listing() const {
  std::string text;
  for (const auto& [number, value] : values_)
    text += IsReal(number) ? Format("$%d=%.3f\r\n", number, value)
                           : Format("$%d=%.0f\r\n", number, value);
  return text;
}

std::optional<GrblError> GrblSettings::Store(double number, double value) {
  if (number < 0.0 || number > 999.0 || !Has(static_cast<int>(number)))
    return GrblError::kInvalidStatement;
  const int which = static_cast<int>(number);
  if (value < 0.0) return GrblError::kNegativeValue;
  // What a division would not survive.
  if (which >= kFirstAxisSetting && which < 130 && value == 0.0) return GrblError::kNegativeValue;
  if (which == 20 && value != 0.0 && !IsSet(22)) return GrblError::kSoftLimitsNeedHoming;
  if (which == 22 && value == 0.0) values_[20] = 0.0;
  values_[which] = IsReal(which) ? value : std::floor(value);
  return std::nullopt;
}

}  // namespace turnlight::rig::sim::stage
