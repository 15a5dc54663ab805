#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "app/scene_input.h"
#include "app/scene_overrides.h"
#include "base/file.h"
#include "base/sha256.h"
#include "estimator/target/geometry.h"
#include "estimator/target/renderer.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr double kMax8 = 255.0;
constexpr double kMax16 = 65535.0;

struct RenderArguments {
  std::string session;
  std::string params;
  std::string out;
  std::vector<std::string> settings;
  std::vector<std::string> lights;
  int samples = 5;
  bool no_shadows = false;
};

// How pictures are written: 16 bits in the session's own DN, but 8-bit sessions are widened and
// float sessions stay float, so that nothing is lost to rounding.
struct PictureFormat {
  calib::Radiometry radiometry;
  int depth = CV_16U;
  std::string extension = ".png";
  bool widened = false;
};

PictureFormat ChooseFormat(const rig::Session& session) {
  PictureFormat format{session.radiometry};
  calib::Radiometry& radiometry = format.radiometry;
  radiometry.noise.reset();
  const std::string extension = fs::path(session.frames.front().image).extension();
  if (extension == ".exr" || radiometry.white <= 1.0 || radiometry.white > kMax16) {
    format.depth = CV_32F;
    format.extension = ".exr";
  } else if (radiometry.white <= kMax8) {
    const double scale = kMax16 / radiometry.white;
    radiometry.black *= scale;
    radiometry.white = kMax16;
    if (radiometry.saturation) *radiometry.saturation *= scale;
    format.widened = true;
  }
  return format;
}

Result<estimator::model::Scene> BuildScene(const RenderArguments& arguments) {
  auto scene = ReadScene(arguments.params);
  if (!scene) return scene;
  if (!arguments.lights.empty()) scene->lights.clear();
  for (const std::string& text : arguments.lights) {
    const auto light = ParseLight(text);
    if (!light) return Forward(light);
    scene->lights.push_back(*light);
  }
  for (const std::string& setting : arguments.settings)
    if (const Status status = ApplySetting(setting, *scene); !status) return Forward(status);
  return scene;
}

Status RequireLightsOutside(const estimator::model::Scene& scene,
                            const estimator::target::Geometry& geometry,
                            const rig::Session& session) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const estimator::model::Light& light = scene.lights[i];
    if (!(light.inverse_distance > 0.0)) continue;
    const Eigen::Vector3d p_WL = light.direction / light.inverse_distance;
    for (const rig::FrameRecord& frame : session.frames) {
      const double distance = (p_WL - frame.X_WT * geometry.center()).norm();
      if (distance > geometry.radius()) continue;
      char text[160];
      std::snprintf(text, sizeof text,
                    "light %zu: it is %.4g from the target's centre, allowed is more than the "
                    "target's radius, %.4g",
                    i, distance, geometry.radius());
      return InputError(text);
    }
  }
  return {};
}

Status RequireFactors(const estimator::model::Scene& scene, const rig::Session& session,
                      const std::string& file) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const std::size_t count = scene.lights[i].factors.size();
    if (count == 0 || count == session.frames.size()) continue;
    return InputError(
        file + ": lights/" + std::to_string(i) + "/factors: " + std::to_string(count) +
        " numbers, allowed is one for each of the " + std::to_string(session.frames.size()) +
        " frames of " + session.root.string());
  }
  return {};
}

Result<rig::FrameRecord> WriteFrame(const cv::Mat& picture, const rig::FrameRecord& like,
                                    const std::string& name, const fs::path& out) {
  if (const Status status = rig::WriteImage(out / name, picture); !status) return Forward(status);
  const auto bytes = ReadFile(out / name);
  if (!bytes) return Forward(bytes);
  rig::FrameRecord frame = like;
  frame.image = name;
  frame.mask.reset();
  frame.validity.reset();
  frame.sha256 = Sha256Hex(*bytes);
  return frame;
}

// The rendered frames are a session themselves: it says how its pictures are encoded.
Status WriteDescription(const rig::Session& session, const PictureFormat& format,
                        std::vector<rig::FrameRecord> frames, const fs::path& out) {
  rig::Session rendered = session;
  rendered.calibration.reset();  // that is of the pictures that were captured
  rendered.camera_path = "camera.cameramodel";
  rendered.radiometry = format.radiometry;
  rendered.bayer.reset();
  rendered.frames = std::move(frames);
  if (const auto* mesh = std::get_if<rig::MeshFile>(&session.target)) {
    const auto bytes = ReadFile(session.root / mesh->path);
    if (!bytes) return Forward(bytes);
    const std::string name = "target" + fs::path(mesh->path).extension().string();
    if (const Status status = WriteFileAtomic(out / name, *bytes); !status) return status;
    rendered.target = rig::MeshFile{name};
  }
  return rig::WriteSession(rendered, out);
}

int Render(const RenderArguments& arguments) {
  const auto session = rig::ReadSession(arguments.session);
  if (!session) return Fail(session.error());
  const auto scene = BuildScene(arguments);
  if (!scene) return Fail(scene.error());
  auto shape = rig::ReadTarget(*session);
  if (!shape) return Fail(shape.error());
  const estimator::target::Geometry geometry(std::move(*shape));
  const fs::path out = arguments.out;
  Status status = RequireLightsOutside(*scene, geometry, *session);
  if (status) status = RequireFactors(*scene, *session, arguments.params);
  if (status) status = CheckOutputFolder(out, arguments.session);
  if (status) status = CheckNewFolder(out);
  if (status) status = MakeDirectory(out / "frames");
  if (!status) return Fail(status.error());

  const calib::RayGrid rays(*session->camera);
  const PictureFormat format = ChooseFormat(*session);
  const estimator::target::RenderOptions options{arguments.samples, !arguments.no_shadows};
  std::vector<rig::FrameRecord> frames;
  {
    Progress progress("rendering", session->frames.size());
    for (const rig::FrameRecord& frame : session->frames) {
      if (Interrupted()) break;
      const auto scene_there = estimator::model::AtKeyframe(*scene, frames.size());
      const auto rendering =
          estimator::target::Render(scene_there, geometry, rays, frame.X_WC, frame.X_WT, options);
      char name[32];
      std::snprintf(name, sizeof name, "frames/%03zu", frames.size());
      auto written = WriteFrame(
          calib::Encode(rendering.radiance, format.radiometry, frame.exposure, format.depth), frame,
          name + format.extension, out);
      if (!written) return Fail(written.error());
      frames.push_back(std::move(*written));
      progress.Step();
    }
  }
  const std::size_t count = frames.size();
  if (count < session->frames.size()) {
    std::cerr << "turnlight: interrupted; " << arguments.out << " is no complete session"
              << std::endl;
    return kInterrupted;
  }
  status = WriteDescription(*session, format, std::move(frames), out);
  if (!status) return Fail(status.error());
  std::cout << arguments.out << ": " << count << (count == 1 ? " frame" : " frames") << " rendered"
            << (format.widened ? ", widened to 16 bits (white is 65535, see session.json)" : "")
            << std::endl;
  return kDone;
}

}  // namespace

void AddRender(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "render",
      "Show what the camera of a session would see of its target in a known or estimated "
      "scene. The output is a session itself",
      "turnlight render my_session --params result/result.json --out relit "
      "--set shininess=80");
  auto arguments = std::make_shared<RenderArguments>();
  command->add_option("SESSION", arguments->session, "The session's folder")->required();
  command->add_option("--params", arguments->params, "truth.json or result.json")
      ->required()
      ->type_name("FILE");
  AddOut(*command, arguments->out, "Folder for frames/ and session.json; new or empty");
  command
      ->add_option("--set", arguments->settings,
                   "Change a parameter; may be repeated. Keys: model, albedo, ambient, diffuse, "
                   "specular, shininess or alpha, f0, roughness_deg, light.N.intensity")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command
      ->add_option("--light", arguments->lights,
                   "Replace the lights: x,y,z,distance|inf,intensity; may be repeated")
      ->type_name("LIGHT")
      ->allow_extra_args(false);
  command
      ->add_option("--samples", arguments->samples,
                   "Rays per pixel and axis (default 5): a pixel is the mean over its footprint")
      ->type_name("N")
      ->check(CLI::Range(1, 32));
  command->add_flag("--no-shadows", arguments->no_shadows,
                    "Leave out the shadows that the target casts on itself");
  command->callback([arguments, &action] { action = [arguments] { return Render(*arguments); }; });
}

}  // namespace turnlight::app
