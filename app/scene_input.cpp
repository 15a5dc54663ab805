#include "app/scene_input.h"

#include "base/file.h"
#include "estimator/results/scene_json.h"

namespace turnlight::app {
namespace {

constexpr std::uint64_t kMaxSceneBytes = 64 << 20;

}  // namespace

Result<estimator::model::Scene> ReadScene(const std::filesystem::path& path) {
  const auto text = ReadTypedFile(path, kMaxSceneBytes);
  if (!text) return Forward(text);
  return estimator::results::ParseScene(*text, path.string());
}

Result<estimator::model::InitialGuess> ReadInitialGuess(const std::filesystem::path& path) {
  const auto text = ReadTypedFile(path, kMaxSceneBytes);
  if (!text) return Forward(text);
  return estimator::results::ParseInitialGuess(*text, path.string());
}

}  // namespace turnlight::app
