#include "app/calibrate/target_option.h"

#include "base/format.h"
#include "rig/session/mesh_file.h"

namespace turnlight::app {

namespace fs = std::filesystem;

void AddTargetShapeOptions(CLI::App& command, TargetWords& words) {
  command.add_option("--plane", words.plane, "The target: a rectangle, width and height")
      ->type_name("W,H")
      ->delimiter(',')
      ->expected(2)
      ->check(CLI::PositiveNumber);
  command.add_option("--sphere", words.sphere, "The target: a ball of this radius")
      ->type_name("MM")
      ->check(CLI::PositiveNumber);
  command.add_option("--mesh", words.mesh, "The target: a mesh in mm, PLY or OBJ")
      ->type_name("FILE");
}

Result<std::variant<calib::SphereShape, calib::PlaneShape, fs::path>> NamedTarget(
    const TargetWords& words) {
  using Target = std::variant<calib::SphereShape, calib::PlaneShape, fs::path>;
  const int given = !words.plane.empty() + (words.sphere > 0.0) + !words.mesh.empty();
  if (given != 1)
    return InputError(Format("%d targets, allowed is one of --sphere, --plane and --mesh", given));
  if (words.sphere > 0.0) return Target(calib::SphereShape{words.sphere});
  if (!words.mesh.empty()) return Target(fs::path(words.mesh));
  return Target(calib::PlaneShape{words.plane[0], words.plane[1], 1});
}

Result<calib::TargetShape> ReadTargetShape(const TargetWords& words) {
  const auto named = NamedTarget(words);
  if (!named) return Forward(named);
  if (const auto* sphere = std::get_if<calib::SphereShape>(&*named))
    return calib::TargetShape(*sphere);
  if (const auto* plane = std::get_if<calib::PlaneShape>(&*named))
    return calib::TargetShape(*plane);
  auto mesh = rig::ReadMesh(std::get<fs::path>(*named));
  if (!mesh) return Forward(mesh);
  return calib::TargetShape(std::move(*mesh));
}

}  // namespace turnlight::app
