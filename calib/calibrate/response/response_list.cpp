#include "calib/calibrate/response/response_list.h"

#include <algorithm>
#include <system_error>

#include "base/file.h"
#include "base/strict_object.h"

namespace turnlight::calib::calibrate::response {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxListBytes = 4 << 20;
constexpr std::size_t kFewestExposures = 3;
const char* const kNames[] = {"response.yaml", "response.yml", "response.json"};

Result<fs::path> FindList(const fs::path& path) {
  std::error_code code;
  if (!fs::is_directory(path, code)) return path;
  for (const char* name : kNames)
    if (fs::exists(path / name, code)) return path / name;
  return InputError(path.string() +
                    ": holds no list of pictures, allowed is a folder with response.yaml "
                    "or response.json, or such a file");
}

std::vector<fs::path> ReadNames(StrictObject& object, const std::string& key,
                                const fs::path& folder) {
  std::vector<fs::path> names;
  const nlohmann::json& list = object.Raw(key);
  bool good = list.is_array() && !list.empty();
  for (std::size_t i = 0; good && i < list.size(); ++i) {
    good = list[i].is_string() && !list[i].get<std::string>().empty();
    if (good) names.push_back(folder / list[i].get<std::string>());
  }
  if (!good) object.Refuse(key, "a list of pictures' files, at least one");
  return names;
}

void AddToSeries(ListedGroup group, std::vector<ListedGroup>& series) {
  const auto same = std::find_if(series.begin(), series.end(), [&](const ListedGroup& other) {
    return other.exposure_us == group.exposure_us;
  });
  if (same == series.end())
    series.push_back(std::move(group));
  else
    same->images.insert(same->images.end(), group.images.begin(), group.images.end());
}

void SortSeries(std::vector<ListedGroup>& series) {
  std::stable_sort(series.begin(), series.end(), [](const ListedGroup& a, const ListedGroup& b) {
    return a.exposure_us < b.exposure_us;
  });
}

// Those of one exposure together, from the shortest to the longest.
Status ReadSeries(StrictObject& object, const fs::path& folder, std::vector<ListedGroup>& series) {
  for (StrictObject entry : object.Objects("series", kFewestExposures)) {
    ListedGroup group;
    group.exposure_us = entry.Number("exposure_us", {.above = 0.0});
    group.images = ReadNames(entry, "images", folder);
    if (Status status = entry.Finish(); !status) return status;
    AddToSeries(std::move(group), series);
  }
  SortSeries(series);
  if (object.ok() && series.size() < kFewestExposures)
    object.RefuseText(
        "series", std::to_string(series.size()) + " different exposures, allowed are at least 3");
  return {};
}

Status ReadCard(StrictObject object, const fs::path& folder, std::optional<GreyCard>& out) {
  GreyCard card;
  card.images = ReadNames(object, "images", folder);
  const auto rectangle = object.Numbers("rectangle", 4, {.min = 0.0, .max = 65536.0});
  card.rectangle = {static_cast<int>(rectangle[0]), static_cast<int>(rectangle[1]),
                    static_cast<int>(rectangle[2]), static_cast<int>(rectangle[3])};
  if (object.ok() && (card.rectangle.width < 2 || card.rectangle.height < 2))
    object.Refuse("rectangle", "[x, y, width, height] in pixels, at least 2 x 2");
  out = std::move(card);
  return object.Finish();
}

}  // namespace

Result<ResponseList> ReadResponseList(const fs::path& path) {
  const auto file = FindList(path);
  if (!file) return Forward(file);
  const auto text = ReadTypedFile(*file, kMaxListBytes);
  if (!text)
    return InputError(text.error().text +
                      "; allowed is a raw capture, or response.yaml or the folder that holds it");
  const auto document = ParseYaml(*text, file->string());
  if (!document) return Forward(document);
  StrictObject object(*document);
  object.AllowPrefix("x-");
  const fs::path folder = file->parent_path();
  ResponseList list;
  list.source = file->string();
  list.bayer = object.OptionalChoice("bayer", {"RGGB", "BGGR", "GRBG", "GBRG"});
  list.white = object.OptionalNumber("white", {.max = 65535.0, .above = 1.0});
  list.gain_db = object.OptionalNumber("gain_db").value_or(0.0);
  if (Status status = ReadSeries(object, folder, list.series); !status) return Forward(status);
  if (object.Has("dark")) list.dark.images = ReadNames(object, "dark", folder);
  if (object.Has("flat")) list.flat.images = ReadNames(object, "flat", folder);
  if (const auto card = object.OptionalObject("grey_card"))
    if (Status status = ReadCard(*card, folder, list.grey_card); !status) return Forward(status);
  if (const Status status = object.Finish(); !status) return Forward(status);
  return list;
}

Result<ResponseList> ListOfCapture(const rig::RawCapture& capture,
                                   const std::optional<cv::Rect>& card) {
  ResponseList list;
  list.source = (capture.root / rig::kCaptureFile).string();
  list.bayer = capture.bayer;
  list.white = capture.radiometry.white;
  list.series_is_flat = true;
  std::vector<fs::path> grey;
  std::optional<double> gain_db;
  for (const rig::RawCaptureFrame& frame : capture.frames) {
    const fs::path image = capture.root / frame.image;
    const bool flat = frame.kind == "flat";
    if (frame.kind == "dark") list.dark.images.push_back(image);
    if (frame.kind == "grey") grey.push_back(image);
    if (flat && !frame.exposure.exposure_us)
      return InputError(list.source + ": " + frame.image +
                        ": a flat frame without exposure_us, allowed are frames with it");
    if (flat) AddToSeries({*frame.exposure.exposure_us, {image}}, list.series);
    if (!flat && frame.kind != "dark" && frame.kind != "grey") continue;
    if (gain_db && *gain_db != frame.exposure.gain_db)
      return InputError(list.source + ": " + frame.image +
                        ": gain_db differs from the frames' before, allowed is one gain for all");
    gain_db = frame.exposure.gain_db;
  }
  SortSeries(list.series);
  list.gain_db = gain_db.value_or(0.0);
  if (list.series.size() < kFewestExposures)
    return InputError(list.source + ": frames of kind \"flat\" at " +
                      std::to_string(list.series.size()) +
                      " exposures, allowed are at least 3: take an evenly lit surface from nearly "
                      "black to clipped, twice each");
  if (card && grey.empty())
    return InputError("--card: " + list.source + " has no frames of kind \"grey\"");
  if (card) list.grey_card = GreyCard{std::move(grey), *card};
  return list;
}

}  // namespace turnlight::calib::calibrate::response
