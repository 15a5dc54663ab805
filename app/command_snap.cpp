#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/command.h"
#include "app/device_commands.h"
#include "app/device_config.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/motion_words.h"
#include "app/one_picture.h"
#include "app/picture_report.h"
#include "base/format.h"
#include "rig/capture/capture_setup.h"
#include "rig/session/image_file.h"

namespace turnlight::app {
namespace {

constexpr double kMaxSnapPatienceS = 3600.0;

struct SnapWords {
  std::string first, second;
  SnapArguments arguments;
};

void SayOfCamera(const std::string& text) { std::cerr << text << std::endl; }

// A picture's file is a PNG; what is no file of that ending is the config.
bool IsPictureName(const std::string& word) {
  const std::filesystem::path path(word);
  return path.extension() == ".png";
}

// A calibration that is not there yet is no reason to take no picture.
std::optional<rig::RigCalibration> CalibrationIfThere(const DeviceConfig& config) {
  auto read = ReadCalibrationOf(config);
  if (read) return std::move(*read);
  SayOfCamera("note: levels are of the pictures' whole range: " + read.error().text);
  return std::nullopt;
}

std::string SettingsText(const rig::CameraSettings& asked, const rig::CameraSettings& actual) {
  return Format(
      "exposure %.6g us asked, %.6g us read back; gain %.4g dB asked, %.4g dB read back\n",
      asked.exposure_us, actual.exposure_us, asked.gain_db, actual.gain_db);
}

std::string ReadingsText(rig::Camera& camera) {
  std::string text;
  for (const rig::DeviceReading& reading : camera.Readings())
    text += "  " + reading.name + " " + NumberText(reading.value, 6) + "\n";
  return text.empty() ? text : "the camera measures\n" + text;
}

Result<Shot> Snap(const SnapArguments& arguments, const DeviceConfig& config, Devices& devices) {
  const DeviceClock clock;
  const auto identity = devices.camera->camera->Open(clock.Now());
  if (!identity) return Forward(identity);
  SayOfCamera(NameOfCamera(config) + ": " + rig::Describe(*identity) +
              "; one picture, nothing moves");
  Shooting shooting{devices.camera->camera.get(), &clock, &InterruptFlag()};
  shooting.settings = {arguments.exposure_us.value_or(config.plan.exposures_us.front()),
                       arguments.gain_db.value_or(config.plan.gain_db)};
  shooting.patience = FromSeconds(arguments.timeout_s.value_or(config.plan.frame_timeout_s));
  shooting.attempts = 1 + static_cast<int>(config.plan.retries);
  shooting.note = [](const std::string& note) { SayOfCamera("note: " + note); };
  for (const std::string& note : shooting.camera->TakeNotes()) shooting.note(note);
  auto shot = TakePicture(shooting);
  if (!shot) return shot;
  if (shot->frame.image.depth() != CV_8U && shot->frame.image.depth() != CV_16U)
    return DeviceError("the pictures are floats, which a PNG does not hold");
  if (const Status written = rig::WriteImage(arguments.out, shot->frame.image); !written)
    return Forward(written);
  std::cout << arguments.out << ": " << PictureKind(shot->frame.image, devices.camera->bayer)
            << "\n"
            << SettingsText(shooting.settings, shot->frame.actual);
  return shot;
}

}  // namespace

int RunSnap(const SnapArguments& arguments, const Drivers& drivers) {
  const auto config = ReadDeviceConfig(arguments.config);
  if (!config) return Fail(config.error());
  auto devices = MakeDevices(*config, {.camera = true}, drivers);
  if (!devices) return Fail(devices.error());
  const auto calibration = CalibrationIfThere(*config);
  const auto shot = Snap(arguments, *config, *devices);
  if (!shot) return FailAtDevice(shot.error(), arguments.config);
  const calib::Radiometry levels = LevelsOf(*devices, calibration);
  std::cout << LevelsText(shot->frame.image, levels, devices->camera->bayer)
            << ReadingsText(*devices->camera->camera)
            << AdviceText(shot->frame.image, levels, shot->frame.actual.exposure_us) << std::flush;
  return kDone;
}

void AddSnap(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "snap",
      "Take one picture by the camera's trigger and show its levels; nothing moves. The config "
      "needs no more than rig: {camera: {driver: ...}}; exposure and gain are those of its section "
      "capture. A Bayer picture is written raw, as the mosaic",
      "turnlight snap my_rig.yaml picture.png");
  auto words = std::make_shared<SnapWords>();
  command->add_option("CONFIG", words->first, "A config with rig/camera");
  command->add_option("OUT.png", words->second, "The picture; may stand before the config");
  SnapArguments& arguments = words->arguments;
  command
      ->add_option("--config", arguments.config, "The config, if it is not among the other words")
      ->type_name("CONFIG");
  const auto number = [&](const char* name, std::optional<double> SnapArguments::*to, double min,
                          double max, const char* unit, const char* text) {
    command
        ->add_option_function<double>(
            name, [words, to](const double& value) { words->arguments.*to = value; }, text)
        ->type_name(unit)
        ->check(CLI::Range(min, max));
  };
  number("--exposure", &SnapArguments::exposure_us, 0.1, 1e8, "US", "Instead of the config's");
  number("--gain", &SnapArguments::gain_db, -40.0, 80.0, "DB", "Instead of the config's");
  number("--timeout", &SnapArguments::timeout_s, 0.1, kMaxSnapPatienceS, "SECONDS",
         "How long to wait for the picture, besides the exposure; else by the config");
  command->callback([words, &action] {
    action = [words] {
      const auto split = SplitWords({words->first, words->second}, words->arguments.config,
                                    "a picture's file, OUT.png", IsPictureName);
      if (!split) return Fail(split.error());
      words->arguments.config = split->config;
      words->arguments.out = split->other;
      return RunSnap(words->arguments, BuiltInDrivers());
    };
  });
}

}  // namespace turnlight::app
