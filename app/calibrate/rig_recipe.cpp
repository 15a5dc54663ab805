#include "app/calibrate/rig_recipe.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "app/rig_config.h"
#include "app/run_config.h"
#include "base/file.h"
#include "calib/calibrate/board/board_words.h"
#include "calib/calibrate/lens/lens_model_name.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxRecipeBytes = std::uint64_t{16} << 20;
constexpr Range kExposure{.min = 0.1, .max = 1e8};
constexpr std::size_t kMostExposures = 64;

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string Joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

// A top-level section's lines as [first, end), from 0.
std::pair<std::size_t, std::size_t> SectionLines(const Document& document, const std::string& key,
                                                 std::size_t count) {
  const auto begin = static_cast<std::size_t>(document.lines.at("/" + key)) - 1;
  std::size_t end = count;
  for (const auto& [pointer, line] : document.lines) {
    const auto at = static_cast<std::size_t>(line) - 1;
    if (pointer.find('/', 1) == std::string::npos && at > begin) end = std::min(end, at);
  }
  return {begin, end};
}

// The lines stay, empty, so that messages name the right ones.
std::string Without(const Document& document, const std::string& text,
                    const std::vector<std::string>& keys) {
  std::vector<std::string> lines = LinesOf(text);
  for (const std::string& key : keys) {
    if (!document.root.contains(key)) continue;
    const auto [begin, end] = SectionLines(document, key, lines.size());
    for (std::size_t i = begin; i < end; ++i) lines[i].clear();
  }
  return Joined(lines);
}

Result<ResponseRecipe> ReadResponse(StrictObject object) {
  ResponseRecipe response;
  const nlohmann::json& list = object.Raw("exposures_us");
  const std::size_t count = list.is_array() ? list.size() : 0;
  if (count < 3 || count > kMostExposures)
    object.Refuse("exposures_us", "a list of 3 to 64 exposures");
  else
    response.exposures_us =
        object.OptionalNumbers("exposures_us", count, kExposure).value_or(std::vector<double>());
  response.pairs =
      static_cast<int>(object.OptionalInteger("pairs", 1, 100).value_or(response.pairs));
  response.grey_card = object.OptionalBoolean("grey_card").value_or(false);
  if (const Status status = object.Finish(); !status) return Forward(status);
  return response;
}

Status ReadTurning(StrictObject object, TurningRecipe& turning, double* height) {
  turning.count =
      static_cast<int>(object.OptionalInteger("count", 3, 1000).value_or(turning.count));
  turning.step_deg =
      object.OptionalNumber("step_deg", {.max = 360.0, .above = 0.0}).value_or(turning.step_deg);
  turning.exposure_us =
      object.OptionalNumber("exposure_us", kExposure).value_or(turning.exposure_us);
  if (height)
    *height = object.OptionalNumber("board_height", {.min = -1e6, .max = 1e6}).value_or(*height);
  return object.Finish();
}

Status ReadIntrinsics(StrictObject object, RigRecipe& recipe) {
  recipe.pictures =
      static_cast<int>(object.OptionalInteger("pictures", 3, 10000).value_or(recipe.pictures));
  recipe.intrinsics_exposure_us =
      object.OptionalNumber("exposure_us", kExposure).value_or(recipe.intrinsics_exposure_us);
  return object.Finish();
}

Status ReadCalibrate(StrictObject object, RigRecipe& recipe) {
  const StrictObject board = object.Object("board");
  const auto response = object.OptionalObject("response");
  const auto intrinsics = object.OptionalObject("intrinsics");
  const auto axis = object.OptionalObject("axis"), target = object.OptionalObject("target");
  const std::string lens = object.OptionalString("lens_model").value_or("OPENCV8");
  recipe.lens_note = object.OptionalString("lens_note").value_or("");
  if (Status status = object.Finish(); !status) return status;
  const auto model = calib::calibrate::lens::FullLensModelName(lens, object.Where("lens_model"));
  if (!model) return Forward(model);
  recipe.lens_model = *model;
  auto read = calib::calibrate::board::ReadBoard(board);
  if (!read) return Forward(read);
  recipe.board = std::move(*read);
  if (response) {
    auto list = ReadResponse(*response);
    if (!list) return Forward(list);
    recipe.response = std::move(*list);
  }
  Status status;
  if (intrinsics) status = ReadIntrinsics(*intrinsics, recipe);
  if (status && axis) status = ReadTurning(*axis, recipe.axis, &recipe.board_height);
  if (status && target) status = ReadTurning(*target, recipe.target, nullptr);
  return status;
}

Status ReadSimulatorSection(StrictObject object, RigRecipe& recipe) {
  const std::string config = object.String("config");
  const auto seed = object.OptionalInteger("noise_seed", 0, std::int64_t{1} << 53);
  StrictObject props = object.Object("props");
  if (Status status = object.Finish(); !status) return status;
  auto simulator = ReadSimulatorConfig(recipe.folder / config);
  if (!simulator) return Forward(simulator);
  if (!simulator->table || !simulator->camera)
    return InputError(object.Where("config") + ": \"" + config +
                      "\", allowed is a simulator with a table and a camera");
  if (seed) {
    const auto number = static_cast<std::uint64_t>(*seed);
    simulator->simulation.camera.noise_seed = number;
    simulator->camera->camera.noise_seed = number;
  }
  for (const char* name : {"flat", "dark", "grey", "handheld", "board", "empty"}) {
    const auto section = props.OptionalObject(name);
    if (!section) continue;
    auto prop = rig::sim::ReadProp(*section);
    if (!prop) return Forward(prop);
    recipe.props.emplace(name, std::move(*prop));
  }
  recipe.simulator = std::move(*simulator);
  return props.Finish();
}

// Whoever is asked for a prop later must have it.
Status CheckProps(const RigRecipe& recipe, const std::string& where) {
  std::vector<std::string> needed{"handheld", "board", "empty"};
  if (recipe.response) needed.insert(needed.end(), {"flat", "dark"});
  if (recipe.response && recipe.response->grey_card) needed.push_back("grey");
  for (const std::string& name : needed)
    if (!recipe.props.contains(name))
      return InputError(where + "/props/" + name +
                        ": this key is missing, a step of the section calibrate needs it");
  return {};
}

}  // namespace

Result<bool> IsRigRecipe(const fs::path& path) {
  const auto text = ReadTypedFile(path, kMaxRecipeBytes);
  if (!text) return Forward(text);
  const auto document = ParseYaml(*text, path.string());
  if (!document) return Forward(document);
  return document->root.is_object() && document->root.contains("calibrate");
}

Result<RigRecipe> ReadRigRecipe(const fs::path& path) {
  const auto text = ReadTypedFile(path, kMaxRecipeBytes);
  if (!text) return Forward(text);
  const auto document = ParseYaml(*text, path.string());
  if (!document) return Forward(document);
  StrictObject root(*document);
  const StrictObject calibrate = root.Object("calibrate");
  const auto simulator = root.OptionalObject("simulator");
  StrictObject rig = root.Object("rig");
  if (!root.ok()) return Forward(root.Finish());
  RigRecipe recipe;
  recipe.text = *text;
  recipe.run_text = Without(*document, *text, {"calibrate", "simulator"});
  recipe.folder = path.parent_path();
  recipe.length_unit = rig.OptionalString("length_unit").value_or("mm");
  if (rig.Has("calibration"))
    return InputError(rig.Where("calibration") +
                      ": it is what this command finds; allowed is a "
                      "config without it");
  const StrictObject target = rig.Object("target");
  if (!rig.ok()) return Forward(rig.Finish());
  auto shape = ReadRigTarget(target, recipe.folder);
  if (!shape) return Forward(shape);
  recipe.shape = std::move(shape->shape);
  Status status = ReadCalibrate(calibrate, recipe);
  if (status && simulator) status = ReadSimulatorSection(*simulator, recipe);
  if (status && simulator) status = CheckProps(recipe, root.Where("simulator"));
  if (!status) return Forward(status);
  // What the capture at the end needs is wrong now or never.
  if (const auto run = ParseRunConfig(recipe.run_text, path.string(), path); !run)
    return Forward(run);
  auto devices = ParseDeviceConfig(recipe.run_text, path);
  if (!devices) return Forward(devices);
  recipe.devices = std::move(*devices);
  return recipe;
}

Result<std::string> RunTextWith(const RigRecipe& recipe, const fs::path& calibration) {
  const Document& document = *recipe.devices.document;
  std::vector<std::string> lines = LinesOf(recipe.run_text);
  const auto table = document.lines.find("/rig/table");
  const auto rig = document.lines.find("/rig");
  if (table == document.lines.end() || rig == document.lines.end() || table->second <= rig->second)
    return InputError(recipe.devices.file +
                      ": rig: allowed is a block, with each key on a line of its own");
  const std::string& line = lines[static_cast<std::size_t>(table->second) - 1];
  const std::string indent = line.substr(0, line.find_first_not_of(' '));
  // A file that the config names is found from wherever the copy is.
  const nlohmann::json& target = document.root["rig"]["target"];
  const auto mesh = document.lines.find("/rig/target");
  if (target.contains("path") && mesh != document.lines.end()) {
    const fs::path path = fs::absolute(recipe.folder / target["path"].get<std::string>());
    nlohmann::json absolute = target;
    absolute["path"] = path.lexically_normal().string();
    for (const auto& [pointer, at] : document.lines)
      if (pointer.starts_with("/rig/target/")) lines[static_cast<std::size_t>(at) - 1].clear();
    lines[static_cast<std::size_t>(mesh->second) - 1] = indent + "target: " + absolute.dump();
  }
  lines.insert(lines.begin() + table->second - 1,
               indent + "calibration: " + nlohmann::json(calibration.string()).dump());
  return Joined(lines);
}

}  // namespace turnlight::app
