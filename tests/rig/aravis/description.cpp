#include <cstdio>

#include "fake_camera.h"
#include "rig/aravis/pixel_format.h"

namespace turnlight::rig::aravis {
namespace {

std::string Hex(unsigned value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%x", value);
  return text;
}

std::string Register(const std::string& name, unsigned address, int length = 4,
                     const char* access = "RW") {
  return "<IntReg Name=\"" + name + "\"><Address>" + Hex(address) + "</Address><Length>" +
         std::to_string(length) + "</Length><AccessMode>" + access +
         "</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess>"
         "</IntReg>\n";
}

std::string Whole(const std::string& name, unsigned address, const std::string& min,
                  const std::string& max, const char* unit = "") {
  return "<Integer Name=\"" + name + "\"><pValue>" + name + "Reg</pValue><Min>" + min +
         "</Min><Max>" + max + "</Max>" + (*unit ? "<Unit>" + std::string(unit) + "</Unit>" : "") +
         "</Integer>\n" + Register(name + "Reg", address);
}

// A float over a register with whole numbers.
std::string Real(const std::string& name, unsigned address, const std::string& min,
                 const std::string& max, const char* unit) {
  return "<Float Name=\"" + name + "\"><pValue>" + name + "Conv</pValue><Min>" + min +
         "</Min><Max>" + max + "</Max><Unit>" + unit + "</Unit></Float>\n<Converter Name=\"" +
         name + "Conv\"><FormulaTo>FROM</FormulaTo><FormulaFrom>TO</FormulaFrom><pValue>" + name +
         "Reg</pValue></Converter>\n" + Register(name + "Reg", address);
}

struct Entry {
  std::string word;
  unsigned value;
};
std::string Choice(const std::string& name, unsigned address, const std::vector<Entry>& entries) {
  std::string xml = "<Enumeration Name=\"" + name + "\">";
  for (const Entry& entry : entries)
    xml += "<EnumEntry Name=\"" + entry.word + "\"><Value>" + std::to_string(entry.value) +
           "</Value></EnumEntry>";
  return xml + "<pValue>" + name + "Reg</pValue></Enumeration>\n" + Register(name + "Reg", address);
}

std::string Command(const std::string& name, unsigned address, int value = 1) {
  return "<Command Name=\"" + name + "\"><pValue>" + name + "Reg</pValue><CommandValue>" +
         std::to_string(value) + "</CommandValue></Command>\n" +
         Register(name + "Reg", address, 4, "WO");
}

std::string Text(const std::string& name, unsigned address, int length) {
  return "<StringReg Name=\"" + name + "\"><Address>" + Hex(address) + "</Address><Length>" +
         std::to_string(length) +
         "</Length><AccessMode>RO</AccessMode><pPort>Device</pPort>"
         "</StringReg>\n";
}

std::string Device() {
  return Text("DeviceVendorName", 0x48, 32) + Text("DeviceModelName", 0x68, 32) +
         Text("DeviceSerialNumber", 0xd8, 16);
}

std::string Pictures() {
  std::vector<Entry> formats;
  for (const std::string& name : PixelFormatNames())
    formats.push_back({name, FindPixelFormat(name)->code});
  return Choice("PixelFormat", ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, formats) +
         Whole("Width", ARV_FAKE_CAMERA_REGISTER_WIDTH, "8", "640") +
         Whole("Height", ARV_FAKE_CAMERA_REGISTER_HEIGHT, "8", "480") +
         Whole("OffsetX", ARV_FAKE_CAMERA_REGISTER_X_OFFSET, "0", "632") +
         Whole("OffsetY", ARV_FAKE_CAMERA_REGISTER_Y_OFFSET, "0", "472") +
         Whole("BinningHorizontal", ARV_FAKE_CAMERA_REGISTER_BINNING_HORIZONTAL, "1", "4") +
         Whole("BinningVertical", ARV_FAKE_CAMERA_REGISTER_BINNING_VERTICAL, "1", "4") +
         "<IntSwissKnife Name=\"PayloadSize\"><pVariable Name=\"W\">Width</pVariable>"
         "<pVariable Name=\"H\">Height</pVariable><pVariable Name=\"F\">PixelFormat</pVariable>"
         "<Formula>W * H * ((F &gt;&gt; 16) &amp; 255) / 8</Formula></IntSwissKnife>\n"
         "<Integer Name=\"TLParamsLocked\"><Value>0</Value><Min>0</Min><Max>1</Max></Integer>\n";
}

std::string Trigger(const Description& d) {
  std::string xml;
  std::vector<Entry> entries;
  for (const std::string& word : d.trigger_selectors)
    entries.push_back({word, static_cast<unsigned>(entries.size())});
  if (!entries.empty()) xml += Choice("TriggerSelector", 0x8020, entries);
  if (!d.trigger_mode) return xml;
  xml +=
      Choice("TriggerMode", d.trigger_mode_works ? ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE : 0x8024,
             {{"Off", 0}, {"On", 1}});
  entries.clear();
  for (const std::string& word : d.trigger_sources)
    entries.push_back({word, word == "Software" ? 1u : 0u});
  xml += Choice("TriggerSource", ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOURCE, entries);
  if (!d.trigger_command.empty())
    xml += Command(d.trigger_command,
                   d.trigger_works ? ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOFTWARE : 0x8028);
  return xml;
}

std::string Exposure(const Description& d) {
  std::string xml;
  if (d.exposure == "ExposureTimeRaw") {
    xml += Whole(d.exposure, ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US, "10", "1000000");
  } else if (!d.exposure.empty()) {
    xml += Real(d.exposure, ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US, "10.0", "1000000.0", "us");
  }
  if (d.gain == "GainRaw") {
    xml += Whole(d.gain, ARV_FAKE_CAMERA_REGISTER_GAIN_RAW, "0", "10");
  } else if (!d.gain.empty()) {
    xml += Real(d.gain, ARV_FAKE_CAMERA_REGISTER_GAIN_RAW, "0.0", "24.0", "dB");
  }
  return xml;
}

std::string Clock(const Description& d) {
  std::string xml;
  if (!d.latch.empty()) xml += Command(d.latch, 0x8108);
  if (!d.latch_value.empty())
    xml += "<Integer Name=\"" + d.latch_value + "\"><pValue>LatchReg</pValue></Integer>\n" +
           Register("LatchReg", 0x8100, 8, "RO");
  if (!d.tick_frequency.empty()) xml += Whole(d.tick_frequency, 0x8110, "0", "4294967295");
  return xml;
}

}  // namespace

std::string Xml(const Description& d) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<RegisterDescription ModelName=\"Test\" "
      "VendorName=\"turnlight\" StandardNameSpace=\"None\" SchemaMajorVersion=\"1\" "
      "SchemaMinorVersion=\"1\" SchemaSubMinorVersion=\"0\" MajorVersion=\"1\" MinorVersion=\"0\" "
      "SubMinorVersion=\"0\" ToolTip=\"\" ProductGuid=\"0\" VersionGuid=\"0\" "
      "xmlns=\"http://www.genicam.org/GenApi/Version_1_1\">\n";
  xml += Device() + Pictures() + Trigger(d) + Exposure(d) + Clock(d);
  xml += Choice("AcquisitionMode", ARV_FAKE_CAMERA_REGISTER_ACQUISITION_MODE, {{"Continuous", 1}});
  xml += Command("AcquisitionStart", ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 1);
  xml += Command("AcquisitionStop", ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 0);
  unsigned address = 0x8200;
  for (const std::string& name : d.autos) {
    std::vector<Entry> entries{{"Continuous", 1}, {"Once", 2}};
    if (name != d.stuck) entries.push_back({"Off", 0});
    xml += Choice(name, name == d.stuck ? 0x8000 : address, entries);
    address += 4;
  }
  for (const std::string& name : d.switches) {
    xml += "<Boolean Name=\"" + name + "\"><pValue>" + name +
           "Reg</pValue><OnValue>1</OnValue><OffValue>0</OffValue></Boolean>\n" +
           Register(name + "Reg", address);
    address += 4;
  }
  if (!d.black_level.empty()) xml += Whole(d.black_level, 0x8030, "0", "255");
  if (!d.temperature.empty()) xml += Real(d.temperature, 0x8034, "-100.0", "200.0", "C");
  return xml + d.extra + "<Port Name=\"Device\"></Port>\n</RegisterDescription>\n";
}

}  // namespace turnlight::rig::aravis
