// The `$` settings of a simulated GRBL: what they are at first, how they are listed and stored.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "rig/sim/mock_config.h"
#include "rig/sim/stage/gcode.h"

namespace turnlight::rig::sim::stage {

// Index of the turning axis in axes, "XYZ" or "XYZA".
class GrblSettings {
 public:
  // Of the table: $100, $110, $120 and the homing speed follow from it. overrides: by number, of
  // those that there are.
  GrblSettings(const MockTurntableConfig& table, const std::string& axes, int axis,
               const std::map<int, double>& overrides);

  bool Has(int number) const { return values_.contains(number); }
  double Value(int number) const { return values_.at(number); }
  bool IsSet(int number) const { return Value(number) != 0.0; }

  double steps_per_deg() const { return Value(100 + axis_); }
  double max_rate() const { return Value(110 + axis_); }      // deg/min
  double acceleration() const { return Value(120 + axis_); }  // deg/s^2
  double travel() const { return Value(130 + axis_); }        // deg

  // "$0=10\r\n$1=255\r\n" and so on.
  std::string Listing() const;
  // As `$n=value`; none: stored.
  std::optional<GrblError> Store(double number, double value);

 private:
  int axis_;
  std::map<int, double> values_;
};

}  // namespace turnlight::rig::sim::stage
