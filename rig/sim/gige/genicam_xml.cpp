#include "rig/sim/gige/genicam_xml.h"

#include <utility>
#include <vector>

#include "base/format.h"
#include "rig/sim/gige/pixel_format.h"
#include "rig/sim/gige/registers.h"

namespace turnlight::rig::sim::gige {
namespace {

constexpr char kHead[] =
    R"(<?xml version="1.0" encoding="utf-8"?>
<RegisterDescription ModelName="SimulatedGigE" VendorName="turnlight"
  ToolTip="A simulated camera" StandardNameSpace="GEV" SchemaMajorVersion="1" SchemaMinorVersion="1"
  SchemaSubMinorVersion="0" MajorVersion="1" MinorVersion="0" SubMinorVersion="0"
  ProductGuid="6e1a1a5c-7f0e-4f6c-9a57-2f4b54c1d0a1"
  VersionGuid="0c2f6f1e-3b0b-4f53-8a53-7d9f5e8c42b7"
  xmlns="http://www.genicam.org/GenApi/Version_1_1"
  xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
  xsi:schemaLocation="http://www.genicam.org/GenApi/Version_1_1 http://www.genicam.org/GenApi/GenApiSchema_Version_1_1.xsd">
)";

using Words = std::vector<std::string>;

std::string Node(const std::string& kind, const std::string& name, const std::string& inside) {
  return "<" + kind + " Name=\"" + name + "\" NameSpace=\"Standard\">" + inside + "</" + kind +
         ">\n";
}

std::string Tag(const std::string& tag, const std::string& text) {
  return "<" + tag + ">" + text + "</" + tag + ">";
}

std::string Address(Register address, int bytes, const std::string& access) {
  return Tag("Address", Format("0x%X", static_cast<unsigned>(address))) +
         Tag("Length", std::to_string(bytes)) + Tag("AccessMode", access) + Tag("pPort", "Device") +
         Tag("Cachable", "NoCache");
}

// An unsigned number of 4 or 8 bytes.
std::string IntReg(const std::string& name, Register address, const std::string& access = "RW",
                   int bytes = 4) {
  return Node(
      "IntReg", name,
      Address(address, bytes, access) + Tag("Sign", "Unsigned") + Tag("Endianess", "BigEndian"));
}

std::string StringReg(const std::string& name, Register address, int bytes,
                      const std::string& access = "RO") {
  return Node("StringReg", name, Address(address, bytes, access));
}

// An Integer on a register of its own; range: the tags Min, Max, Inc or pMax.
std::string Integer(const std::string& name, Register address, const std::string& range,
                    const std::string& access = "RW") {
  return Node("Integer", name, Tag("pValue", name + "Register") + range) +
         IntReg(name + "Register", address, access);
}

std::string Fixed(const std::string& name, int value) {
  const std::string text = std::to_string(value);
  return Node("Integer", name, Tag("Value", text) + Tag("Min", text) + Tag("Max", text));
}

// A Float on a register of whole numbers; to_register is of FROM, from_register of TO.
std::string Float(const std::string& name, Register address, const std::string& to_register,
                  const std::string& from_register, const std::string& unit,
                  std::pair<const char*, const char*> range, const std::string& access = "RW") {
  return Node("Float", name,
              Tag("pValue", name + "Converter") + Tag("Min", range.first) +
                  Tag("Max", range.second) + Tag("Unit", unit)) +
         Node("Converter", name + "Converter",
              Tag("FormulaTo", to_register) + Tag("FormulaFrom", from_register) +
                  Tag("pValue", name + "Register") + Tag("Slope", "Increasing")) +
         IntReg(name + "Register", address, access);
}

std::string Command(const std::string& name, Register address, int value) {
  return Node("Command", name,
              Tag("pValue", name + "Register") + Tag("CommandValue", std::to_string(value))) +
         IntReg(name + "Register", address);
}

std::string Entry(const std::string& name, std::uint32_t value) {
  return Node("EnumEntry", name, Tag("Value", Format("0x%X", value)));
}

// Its words have the values 0, 1, ...
std::string Enumeration(const std::string& name, Register address, const Words& words) {
  std::string entries;
  std::uint32_t value = 0;
  for (const std::string& word : words) entries += Entry(word, value++);
  return Node("Enumeration", name, entries + Tag("pValue", name + "Register")) +
         IntReg(name + "Register", address);
}

std::string Category(const std::string& name, const Words& features) {
  std::string inside;
  for (const std::string& feature : features) inside += Tag("pFeature", feature);
  return Node("Category", name, inside);
}

std::string DeviceControl() {
  return Category("DeviceControl",
                  {"DeviceVendorName", "DeviceModelName", "DeviceVersion", "DeviceSerialNumber",
                   "DeviceUserID", "DeviceTemperature", "TimestampLatch", "TimestampLatchValue"}) +
         StringReg("DeviceVendorName", Register::kManufacturerName, 32) +
         StringReg("DeviceModelName", Register::kModelName, 32) +
         StringReg("DeviceVersion", Register::kDeviceVersion, 32) +
         StringReg("DeviceSerialNumber", Register::kSerialNumber, 16) +
         StringReg("DeviceUserID", Register::kUserName, 16, "RW") +
         Float("DeviceTemperature", Register::kTemperatureTenths, "FROM*10.0", "TO/10.0", "C",
               {"-40", "120"}, "RO") +
         Command("TimestampLatch", Register::kTimestampLatch, 1) +
         Node("Integer", "TimestampLatchValue", Tag("pValue", "TimestampLatchValueRegister")) +
         IntReg("TimestampLatchValueRegister", Register::kTimestampHigh, "RO", 8);
}

std::string ImageFormatControl() {
  std::string formats;
  for (const PixelFormat& format : PixelFormats()) formats += Entry(format.name, format.code);
  const auto up_to = [](const std::string& maximum) {
    return Tag("pMax", maximum) + Tag("Inc", "2");
  };
  const auto rest = [](const std::string& name, const std::string& of, const std::string& less) {
    return Node("IntSwissKnife", name,
                "<pVariable Name=\"A\">" + of + "</pVariable><pVariable Name=\"B\">" + less +
                    "</pVariable>" + Tag("Formula", "A-B"));
  };
  return Category("ImageFormatControl",
                  {"SensorWidth", "SensorHeight", "Width", "Height", "OffsetX", "OffsetY",
                   "BinningHorizontal", "BinningVertical", "PixelFormat"}) +
         Integer("SensorWidth", Register::kSensorWidth, "", "RO") +
         Integer("SensorHeight", Register::kSensorHeight, "", "RO") +
         rest("WidthMax", "SensorWidthRegister", "OffsetXRegister") +
         rest("HeightMax", "SensorHeightRegister", "OffsetYRegister") +
         rest("OffsetXMax", "SensorWidthRegister", "WidthRegister") +
         rest("OffsetYMax", "SensorHeightRegister", "HeightRegister") +
         Integer("Width", Register::kWidth, Tag("Min", "2") + up_to("WidthMax")) +
         Integer("Height", Register::kHeight, Tag("Min", "2") + up_to("HeightMax")) +
         Integer("OffsetX", Register::kOffsetX, Tag("Min", "0") + up_to("OffsetXMax")) +
         Integer("OffsetY", Register::kOffsetY, Tag("Min", "0") + up_to("OffsetYMax")) +
         Fixed("BinningHorizontal", 1) + Fixed("BinningVertical", 1) +
         Node("Enumeration", "PixelFormat", formats + Tag("pValue", "PixelFormatRegister")) +
         IntReg("PixelFormatRegister", Register::kPixelFormat);
}

std::string AcquisitionControl() {
  return Category("AcquisitionControl",
                  {"AcquisitionMode", "AcquisitionStart", "AcquisitionStop", "AcquisitionFrameRate",
                   "ExposureAuto", "ExposureTime", "TriggerSelector", "TriggerMode",
                   "TriggerSource", "TriggerActivation", "TriggerSoftware"}) +
         // Aravis' fake keeps 1 for it.
         Node("Enumeration", "AcquisitionMode",
              Entry("Continuous", 1) + Tag("pValue", "AcquisitionModeRegister")) +
         IntReg("AcquisitionModeRegister", Register::kAcquisitionMode) +
         Node("Command", "AcquisitionStart",
              Tag("pValue", "AcquisitionRegister") + Tag("CommandValue", "1")) +
         Node("Command", "AcquisitionStop",
              Tag("pValue", "AcquisitionRegister") + Tag("CommandValue", "0")) +
         IntReg("AcquisitionRegister", Register::kAcquisition) +
         Float("AcquisitionFrameRate", Register::kFramePeriodUs, "TRUNC(1000000.0/FROM+0.5)",
               "1000000.0/TO", "Hz", {"0.1", "100"}) +
         Enumeration("ExposureAuto", Register::kExposureAuto, {"Off"}) +
         Float("ExposureTime", Register::kExposureUs, "TRUNC(FROM+0.5)", "TO*1.0", "us",
               {"10", "10000000"}) +
         Enumeration("TriggerSelector", Register::kTriggerSelector, {"FrameStart"}) +
         Enumeration("TriggerMode", Register::kTriggerMode, {"Off", "On"}) +
         Enumeration("TriggerSource", Register::kTriggerSource, {"Software"}) +
         Enumeration("TriggerActivation", Register::kTriggerActivation, {"RisingEdge"}) +
         Command("TriggerSoftware", Register::kTriggerSoftware, 1);
}

std::string AnalogControl() {
  return Category("AnalogControl", {"GainAuto", "Gain", "BlackLevel"}) +
         Enumeration("GainAuto", Register::kGainAuto, {"Off"}) +
         Float("Gain", Register::kGainTenthsDb, "TRUNC(FROM*10.0+0.5)", "TO/10.0", "dB",
               {"0", "24"}) +
         Float("BlackLevel", Register::kBlackLevelDn, "TRUNC(FROM+0.5)", "TO*1.0", "DN",
               {"0", "127"});
}

std::string PayloadSize() {
  std::string bits = "8";
  for (const PixelFormat& format : PixelFormats())
    bits = Format("(F=0x%X)?%u:(%s)", format.code, format.code >> 16 & 0xFF, bits.c_str());
  return Node("IntSwissKnife", "PayloadSizeFormula",
              "<pVariable Name=\"W\">WidthRegister</pVariable>"
              "<pVariable Name=\"H\">HeightRegister</pVariable>"
              "<pVariable Name=\"F\">PixelFormatRegister</pVariable>" +
                  Tag("Formula", "W*H*(" + bits + ")/8")) +
         Node("Integer", "PayloadSize", Tag("pValue", "PayloadSizeFormula"));
}

std::string TransportLayerControl() {
  return Category("TransportLayerControl",
                  {"PayloadSize", "TLParamsLocked", "GevSCPSPacketSize", "GevSCPD", "GevSCDA",
                   "GevSCPHostPort", "GevHeartbeatTimeout", "GevTimestampTickFrequency"}) +
         PayloadSize() +
         Integer("TLParamsLocked", Register::kParametersLocked, Tag("Min", "0") + Tag("Max", "1")) +
         Node("Integer", "GevSCPSPacketSize",
              Tag("pValue", "GevSCPSPacketSizeRegister") + Tag("Min", "576") + Tag("Max", "9000")) +
         Node("MaskedIntReg", "GevSCPSPacketSizeRegister",
              Address(Register::kStreamPacketSize, 4, "RW") + Tag("LSB", "31") + Tag("MSB", "16") +
                  Tag("Sign", "Unsigned") + Tag("Endianess", "BigEndian")) +
         Integer("GevSCPD", Register::kStreamPacketDelay, "") +
         Integer("GevSCDA", Register::kStreamAddress, "") +
         Integer("GevSCPHostPort", Register::kStreamPort, "") +
         Integer("GevHeartbeatTimeout", Register::kHeartbeatTimeoutMs, Tag("Min", "500")) +
         Node("Integer", "GevTimestampTickFrequency",
              Tag("pValue", "GevTimestampTickFrequencyRegister")) +
         IntReg("GevTimestampTickFrequencyRegister", Register::kTickFrequencyHigh, "RO", 8);
}

}  // namespace

std::string GenicamXml() {
  return kHead +
         Category("Root", {"DeviceControl", "ImageFormatControl", "AcquisitionControl",
                           "AnalogControl", "TransportLayerControl"}) +
         DeviceControl() + ImageFormatControl() + AcquisitionControl() + AnalogControl() +
         TransportLayerControl() + "<Port Name=\"Device\" NameSpace=\"Standard\"></Port>\n" +
         "</RegisterDescription>\n";
}

}  // namespace turnlight::rig::sim::gige
