// Proves: what is plugged in is told with lines that a config takes, by the name that stays; that
// there is nothing is told with what to check; the JSON says the same. Does not prove: that devices
// are found; the drivers' tests do.
#include "app/device_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

DeviceList SomeDevices() {
  DeviceList list;
  list.table_drivers = {"grbl", "zaber"};
  list.ports.push_back(
      {{"/dev/ttyUSB0", "/dev/serial/by-id/usb-FTDI_A1", "FT232R", "A1", "0403:6001"},
       "picocom (process 7)"});
  list.ports.push_back({{"/dev/ttyUSB1", "", "CH340", "", "1a86:7523"}, ""});
  list.cameras.push_back({"Maker-Model-\"7\"", "Maker", "Model", "7", "10.0.0.2", "GigEVision"});
  return list;
}

TEST(DeviceList, LinesForAConfig) {
  const std::string text = DeviceListText(SomeDevices());
  EXPECT_THAT(
      text, AllOf(HasSubstr("table: {driver: grbl, port: /dev/serial/by-id/usb-FTDI_A1}"),
                  HasSubstr("held by picocom (process 7)"), HasSubstr("A1"),
                  HasSubstr("table: {driver: grbl, port: /dev/ttyUSB1}"), HasSubstr("grbl, zaber"),
                  HasSubstr("id: \"Maker-Model-\\\"7\\\"\""), HasSubstr("at 10.0.0.2")));
  rig::serial::PortInfo by_serial{"/dev/ttyUSB0", "", "", "A1", "0403:6001"};
  EXPECT_EQ(ConfigLine(by_serial, "grbl"), "table: {driver: grbl, usb_serial: \"A1\"}");
}

TEST(DeviceList, NothingIsToldWithWhatToCheck) {
  DeviceList list;
  EXPECT_THAT(DeviceListText(list),
              AllOf(HasSubstr("is the controller switched on"), HasSubstr("UDP port 3956")));
  list.problems = {"the search did not end"};
  EXPECT_THAT(DeviceListText(list), HasSubstr("the search did not end"));
}

TEST(DeviceList, Json) {
  DeviceList list = SomeDevices();
  list.cameras[0].vendor = "M\xfcller";  // no UTF-8
  const auto json = nlohmann::json::parse(DeviceListJson(list));
  EXPECT_EQ(json["ports"][0]["stable_path"], "/dev/serial/by-id/usb-FTDI_A1");
  EXPECT_EQ(json["ports"][0]["held_by"], "picocom (process 7)");
  EXPECT_EQ(json["cameras"][0]["protocol"], "GigEVision");
  EXPECT_TRUE(json["problems"].empty());
}

}  // namespace
}  // namespace turnlight::app
