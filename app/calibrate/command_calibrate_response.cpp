#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/calibrate/calibrate_commands.h"
#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "base/file.h"
#include "calib/calibrate/response/response.h"
#include "calib/calibrate/response/response_pictures.h"
#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"
#include "rig/session/raw_capture.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace response = calib::calibrate::response;

struct ResponseArguments {
  std::string list;
  std::string out;
  std::string update;     // a rig's calibration; empty: none
  std::vector<int> card;  // x, y, width, height; empty: none
};

Status WriteResponse(const response::Response& found, const fs::path& out) {
  Status status = MakeDirectory(out);
  const auto write = [&](const char* name, const cv::Mat3b& page) {
    if (status) status = rig::WriteImage(out / name, page);
  };
  write("linearity.png", response::DrawLinearity(found.curve));
  if (found.transfer)
    write("photon_transfer.png", response::DrawPhotonTransfer(*found.transfer, found.planes));
  if (found.flat) write("flat_field.png", response::DrawFlatField(*found.flat, found.size));
  if (status) status = WriteFileAtomic(out / "response.json", response::PrintResponse(found));
  return status;
}

Result<response::ResponseList> ReadList(const ResponseArguments& arguments) {
  std::optional<cv::Rect> card;
  if (!arguments.card.empty())
    card = cv::Rect(arguments.card[0], arguments.card[1], arguments.card[2], arguments.card[3]);
  if (rig::IsRawCapture(arguments.list)) {
    const auto capture = rig::ReadRawCapture(arguments.list);
    if (!capture) return Forward(capture);
    return response::ListOfCapture(*capture, card);
  }
  auto list = response::ReadResponseList(arguments.list);
  if (list && card) {
    if (!list->grey_card)
      return InputError("--card: " + list->source +
                        " has no grey_card, allowed is a list with one");
    list->grey_card->rectangle = *card;
  }
  return list;
}

Result<response::Response> Calibrate(const ResponseArguments& arguments) {
  const auto list = ReadList(arguments);
  if (!list) return Forward(list);
  std::optional<Progress> progress;
  std::size_t told = 0;
  return response::CalibrateResponse(*list, [&](std::size_t done, std::size_t total) {
    if (!progress) progress.emplace("reading", total);
    for (; told < done; ++told) progress->Step();
    return !Interrupted();
  });
}

int RunCalibrateResponse(const ResponseArguments& arguments) {
  // What is to be updated is read first: an error there should not come after minutes.
  std::optional<rig::RigCalibration> calibration;
  if (!arguments.update.empty()) {
    auto read = rig::ReadRigCalibration(arguments.update);
    if (!read) return Fail(read.error());
    calibration = std::move(*read);
  }
  const auto found = Calibrate(arguments);
  if (!found) return Fail(found.error());
  if (calibration)
    if (const Status status = response::ApplyResponse(*found, *calibration); !status)
      return Fail(status.error());
  if (const Status status = WriteResponse(*found, arguments.out); !status)
    return Fail(status.error());
  if (calibration)
    if (const Status status = rig::WriteRigCalibration(*calibration, arguments.update); !status)
      return Fail(status.error());
  for (const std::string& line : found->words) std::cout << line << "\n";
  std::cout << "written: " << (fs::path(arguments.out) / "response.json").string();
  if (calibration) std::cout << ", and " << arguments.update;
  std::cout << std::endl;
  return kDone;
}

}  // namespace

void AddCalibrateResponse(CLI::App& calibrate, Action& action) {
  CLI::App* command = AddCommand(
      calibrate, "response",
      "What a camera's digital numbers mean: linearity, black level, saturation, noise (photon "
      "transfer), vignetting and white balance, each with its sigma, from an exposure series of a "
      "still scene, dark and flat frames and a grey card. LIST is a raw capture with frames of "
      "kinds "
      "flat (at several exposures), dark and grey, or response.yaml or its folder: series: "
      "[{exposure_us, images}], dark, flat, grey_card: {images, rectangle}",
      "turnlight calibrate response pictures/response.yaml --update rig-calibration.json --out "
      "response");
  auto arguments = std::make_shared<ResponseArguments>();
  command->add_option("LIST", arguments->list, "The list of pictures, or the folder that holds it")
      ->required();
  AddOut(*command, arguments->out, "Where response.json and the charts go");
  command
      ->add_option("--update", arguments->update,
                   "A rig's calibration to put the radiometry and the noise into, in place")
      ->type_name("FILE");
  command
      ->add_option("--card", arguments->card, "Where the grey card is: X,Y,WIDTH,HEIGHT in pixels")
      ->delimiter(',')
      ->expected(4)
      ->check(CLI::Range(0, 65535))
      ->type_name("RECTANGLE");
  command->callback(
      [arguments, &action] { action = [arguments] { return RunCalibrateResponse(*arguments); }; });
}

}  // namespace turnlight::app
