#include "calib/calibrate/handheld/corners_file.h"

#include "base/strict_object.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

PickedCorners ReadPicture(StrictObject& object) {
  PickedCorners picked;
  picked.image = object.String("image");
  const std::vector<double> numbers = object.Matrix("corners", 4, 2);
  for (std::size_t i = 0; i < 4 && numbers.size() == 8; ++i)
    picked.pixels[i] = {numbers[2 * i], numbers[2 * i + 1]};
  return picked;
}

}  // namespace

Result<CornersFile> ReadCorners(const Document& document) {
  StrictObject object(document);
  CornersFile file;
  const std::vector<double> size = object.Numbers("size", 2, {.above = 0.0});
  std::vector<StrictObject> pictures = object.Objects("pictures", 1);
  if (const Status status = object.Finish(); !status) return Forward(status);
  file.plane = {size[0], size[1], 1};
  for (StrictObject& picture : pictures) {
    file.pictures.push_back(ReadPicture(picture));
    if (const Status status = picture.Finish(); !status) return Forward(status);
  }
  return file;
}

PlaneView ViewOf(const PickedCorners& corners, const PlaneShape& plane) {
  PlaneView view;
  view.name = corners.image;
  const double x = 0.5 * plane.width, y = 0.5 * plane.height;
  const std::array<Eigen::Vector2d, 4> places{{{-x, y}, {x, y}, {x, -y}, {-x, -y}}};
  for (std::size_t i = 0; i < 4; ++i) view.points.push_back({places[i], corners.pixels[i], 1.0});
  return view;
}

}  // namespace turnlight::calib::calibrate::handheld
