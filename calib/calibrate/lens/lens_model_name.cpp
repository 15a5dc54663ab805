#include "calib/calibrate/lens/lens_model_name.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "base/format.h"
#include "calib/camera_model.h"

extern "C" {
#include <mrcal/mrcal.h>
}

namespace turnlight::calib::calibrate::lens {
namespace {

constexpr std::string_view kPrefix = "LENSMODEL_";
constexpr std::string_view kSplined = "LENSMODEL_SPLINED_STEREOGRAPHIC";
constexpr int kMaxParameters = 4000;

// All but CAHVORE, for whose projection mrcal 2.2 has no derivatives.
std::string AllowedNames() {
  std::vector<std::string> names;
  for (const char* const* name = mrcal_supported_lensmodel_names(); *name != nullptr; ++name)
    if (std::string_view(*name).find("CAHVORE") == std::string_view::npos)
      names.emplace_back(std::string_view(*name).substr(kPrefix.size()));
  for (std::string& name : names)
    if (name.starts_with("SPLINED"))
      name = "SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=18_fov_x_deg=60";
  return Listed(names) + " (the numbers of the splined one are examples)";
}

// Words in capitals, but what belongs to a configuration as it is.
std::string WithPrefix(const std::string& name) {
  std::string text = name;
  const auto end = std::min(text.find('='), text.size());
  const bool configured = end < text.size();
  const auto words = configured ? std::min(text.rfind('_', end), text.size()) : end;
  for (std::size_t i = 0; i < words; ++i)
    text[i] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[i])));
  return text.starts_with(kPrefix) ? text : std::string(kPrefix) + text;
}

}  // namespace

bool IsSplined(const std::string& full_name) { return full_name.starts_with(kSplined); }

Result<std::string> FullLensModelName(const std::string& name, const std::string& what) {
  const std::string full = WithPrefix(name.substr(0, 200));
  const auto refuse = [&](const std::string& why) {
    return InputError(what + ": '" + name.substr(0, 100) + "' " + why);
  };
  if (full.starts_with("LENSMODEL_CAHVORE"))
    return refuse(
        "cannot be calibrated: mrcal projects this lens model but has no derivatives of "
        "it; allowed are " +
        AllowedNames());
  const mrcal_lensmodel_type_t type = mrcal_lensmodel_type_from_name(full.c_str());
  if (!mrcal_lensmodel_type_is_valid(type) || full.find('\0') != std::string::npos)
    return refuse("is no lens model; allowed are " + AllowedNames());
  mrcal_lensmodel_t model{};
  if (!mrcal_lensmodel_from_name(&model, full.c_str()))
    return refuse(
        "lacks its configuration, for example "
        "SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=18_fov_x_deg=60");
  std::size_t count = 0;
  if (IsSplined(full)) {
    const auto& config = model.LENSMODEL_SPLINED_STEREOGRAPHIC__config;
    count = 4 + std::size_t{2} * config.Nx * config.Ny;
  } else {
    count = static_cast<std::size_t>(mrcal_lensmodel_num_params(&model));
  }
  if (count > kMaxParameters)
    return refuse("has " + std::to_string(count) + " parameters, allowed are at most " +
                  std::to_string(kMaxParameters));
  // The reader of camera models knows what else mrcal would not survive.
  std::string text = "{'lensmodel': '" + full + "', 'extrinsics': [0,0,0,0,0,0], 'imagersize': " +
                     "[100, 100], 'intrinsics': [100, 100, 50, 50";
  for (std::size_t i = 4; i < count; ++i) text += ", 0";
  const auto camera = CameraModel::FromString(text + "]}", what);
  if (!camera) return Forward(camera);
  return full;
}

}  // namespace turnlight::calib::calibrate::lens
