#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/calibrate/board_options.h"
#include "app/calibrate/board_pictures.h"
#include "app/calibrate/calibrate_commands.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "base/file.h"
#include "base/format.h"
#include "calib/calibrate/lens/assess_lens.h"
#include "calib/calibrate/lens/calibrate_lens.h"
#include "calib/calibrate/lens/lens_json.h"
#include "calib/calibrate/lens/lens_model_name.h"
#include "calib/calibrate/lens/pictures.h"
#include "rig/session/image_file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace board = calib::calibrate::board;
namespace lens = calib::calibrate::lens;

struct IntrinsicsArguments {
  std::vector<std::string> pictures;
  board::BoardWords board;
  std::string lens_model = "OPENCV8", out;
  std::optional<double> distance_mm;
  bool flat = false;
};

// mrcal reads it, and its tools but those that need what the fit was made of.
std::string ModelFile(const lens::LensCalibration& calibration) {
  return "# Calibrated by turnlight; its uncertainty is in intrinsics.json. It has no\n"
         "# optimization_inputs: mrcal's tools that need them need a calibration by mrcal's "
         "own.\n" +
         calibration.camera().ToString();
}

Status WriteAll(const board::Board& board, const std::vector<lens::PictureViews>& views,
                const lens::LensCalibration& calibration, const lens::LensAssessment& assessment,
                const fs::path& out) {
  const std::string model = ModelFile(calibration);
  Status status = MakeDirectory(out);
  if (status) status = WriteFileAtomic(out / "camera.cameramodel", model);
  for (const lens::ReportPicture& picture :
       lens::ReportPictures(views, calibration, assessment, "mm"))
    if (status) status = rig::WriteImage(out / picture.name, picture.page);
  if (status)
    status =
        WriteFileAtomic(out / "intrinsics.json",
                        lens::IntrinsicsJson(board, views, calibration, assessment, model, "mm"));
  return status;
}

std::string SummaryOf(const std::vector<lens::PictureViews>& views,
                      const lens::LensCalibration& calibration,
                      const lens::LensAssessment& assessment) {
  std::string text = Format("%zu views of %zu pictures used, %zu of %zu points are outliers\n",
                            calibration.views.size(), views.size(), calibration.outliers,
                            calibration.points.size());
  for (const lens::DroppedView& drop : calibration.dropped)
    text += "left out: " + views[drop.picture].picture +
            (drop.board ? Format(", board %zu", *drop.board + 1) : "") + ": " + drop.reason + "\n";
  text += assessment.verdict + "\n";
  for (const std::string& note : calibration.notes) text += "note: " + note + "\n";
  for (const std::string& advice : assessment.advice) text += advice + "\n";
  return text;
}

// Another board than was said shows in what is odd about the pictures.
Error WithRemarks(Error error, const std::vector<std::string>& remarks) {
  constexpr std::size_t kMost = 3;
  for (std::size_t i = 0; i < remarks.size() && i < kMost; ++i) error.text += "\n  " + remarks[i];
  if (remarks.size() > kMost) error.text += Format("\n  and %zu more", remarks.size() - kMost);
  return error;
}

int CalibrateIntrinsics(const IntrinsicsArguments& arguments) {
  const InterruptAtOnce guard;
  const auto board = board::ParseBoard(arguments.board);
  if (!board) return Fail(board.error());
  lens::LensOptions options;
  const auto model = lens::FullLensModelName(arguments.lens_model, "--lens");
  if (!model) return Fail(model.error());
  options.lens_model = *model;
  options.fits_warp = options.fits_shape = !arguments.flat;
  const fs::path out = arguments.out;
  for (const std::string& picture : arguments.pictures)
    if (const Status status = CheckOutputFolder(out, picture); !status) return Fail(status.error());
  const auto seen = FindBoardsInPictures(arguments.pictures, *board);
  if (!seen) return Fail(seen.error());
  std::optional<lens::LensAssessment> assessment;
  const auto calibration = [&] {
    StatusLine line;
    options.progress = [&line](const std::string& stage) { line.Show(stage); };
    auto found = lens::CalibrateLens(*board, seen->views, options);
    if (!found) return found;
    found->notes.insert(found->notes.end(), seen->remarks.begin(), seen->remarks.end());
    options.progress = [&line](const std::string& stage) { line.Show("two halves: " + stage); };
    assessment = lens::AssessLens(*board, seen->views, *found, options, arguments.distance_mm);
    return found;
  }();
  if (!calibration) return Fail(WithRemarks(calibration.error(), seen->remarks));
  if (const Status status = WriteAll(*board, seen->views, *calibration, *assessment, out); !status)
    return Fail(status.error());
  std::cout << SummaryOf(seen->views, *calibration, *assessment) << arguments.out
            << ": camera.cameramodel, intrinsics.json and pictures" << std::endl;
  return kDone;
}

}  // namespace

void AddCalibrateIntrinsics(CLI::App& calibrate, Action& action) {
  CLI::App* command = AddCommand(
      calibrate, "intrinsics",
      "The lens, from pictures of a calibration board held in many places: its model as mrcal "
      "reads it, its uncertainty over the picture, which pictures to leave out and where to add "
      "some. 10 to 30 pictures, tilted by 30 to 45 degrees, out to the corners",
      "turnlight calibrate intrinsics pictures/ --board 9x6 --square-mm 25 --out lens");
  auto arguments = std::make_shared<IntrinsicsArguments>();
  command
      ->add_option("IMAGES", arguments->pictures,
                   "Pictures, folders of pictures, or raw captures; all of one camera and focus")
      ->required();
  AddBoardOptions(*command, arguments->board);
  command
      ->add_option("--lens", arguments->lens_model,
                   "mrcal's lens model: OPENCV4, OPENCV5, OPENCV8, OPENCV12, CAHVOR, PINHOLE, "
                   "STEREOGRAPHIC, or for fisheyes and high accuracy "
                   "SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=18_fov_x_deg=60, for example")
      ->type_name("MODEL")
      ->capture_default_str();
  command
      ->add_option_function<double>(
          "--distance-mm",
          [arguments](const double& distance) { arguments->distance_mm = distance; },
          "The uncertainty at this distance as well as at infinity")
      ->type_name("MM")
      ->check(CLI::Range(1e-3, 1e9));
  command->add_flag(
      "--flat", arguments->flat,
      "Take the board for flat; else how it bends is fitted as well, and where that is not "
      "enough the place of each of its points");
  AddOut(*command, arguments->out, "Folder for camera.cameramodel, intrinsics.json and pictures");
  command->callback(
      [arguments, &action] { action = [arguments] { return CalibrateIntrinsics(*arguments); }; });
}

}  // namespace turnlight::app
