// Wavefront OBJ by tinyobjloader. Only the lines of vertices, normals and faces are passed on: the
// library follows material files, takes memory for tags that a hostile file can multiply, and reads
// a number that it does not understand as 0.
#include <tiny_obj_loader.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>

#include "rig/session/mesh_formats.h"

namespace turnlight::rig {
namespace {

constexpr std::string_view kBlank = " \t\r";

std::string_view TakeWord(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
  const std::string_view word = rest.substr(0, rest.find_first_of(kBlank));
  rest.remove_prefix(word.size());
  return word;
}

bool IsFinite(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && end == word.data() + word.size() && std::isfinite(value);
}

bool HasThreeNumbers(std::string_view line) {
  for (int i = 0; i < 3; ++i)
    if (!IsFinite(TakeWord(line))) return false;
  return true;
}

// The lines of vertices, normals and faces, numbers checked.
Result<std::string> GeometryLines(const std::string& bytes, const std::string& file) {
  std::string kept;
  std::size_t number = 0;
  for (std::size_t start = 0; start < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', start), bytes.size());
    const std::string_view line = std::string_view(bytes).substr(start, end - start);
    start = end + 1;
    ++number;
    std::string_view rest = line;
    const std::string_view keyword = TakeWord(rest);
    if (keyword != "v" && keyword != "vn" && keyword != "f") continue;
    const std::string where = file + ":" + std::to_string(number) + ": ";
    if (keyword != "f" && !HasThreeNumbers(rest))
      return InputError(where + std::string(line.substr(0, 80)) +
                        ", allowed are 3 finite numbers after \"" + std::string(keyword) + "\"");
    if (line.find('\\') != std::string_view::npos || line.find('\0') != std::string_view::npos)
      return InputError(where + "a continued line or a zero byte, allowed is one face a line");
    kept.append(line).push_back('\n');
  }
  return kept;
}

// An index as the file has it, counted from 1 or backwards from -1, counted from 0; -1 if it is
// none.
std::int64_t Resolve(int index, std::size_t count) {
  if (index > 0) return std::int64_t{index} - 1;
  return index < 0 ? static_cast<std::int64_t>(count) + index : -1;
}

void AddVertex(void* mesh, double x, double y, double z, double) {
  static_cast<PolygonMesh*>(mesh)->vertices.emplace_back(x, y, z);
}

void AddNormal(void* mesh, double x, double y, double z) {
  static_cast<PolygonMesh*>(mesh)->normals.emplace_back(x, y, z);
}

void AddFace(void* user_data, tinyobj::index_t* indices, int count) {
  PolygonMesh& mesh = *static_cast<PolygonMesh*>(user_data);
  for (int i = 0; i < count; ++i)
    mesh.corners.push_back({Resolve(indices[i].vertex_index, mesh.vertices.size()),
                            Resolve(indices[i].normal_index, mesh.normals.size())});
  mesh.ends.push_back(mesh.corners.size());
}

}  // namespace

Result<PolygonMesh> ReadObj(const std::string& bytes, const std::string& file) {
  const auto lines = GeometryLines(bytes, file);
  if (!lines) return Forward(lines);
  PolygonMesh mesh;
  tinyobj::callback_t callbacks;
  callbacks.vertex_cb = AddVertex;
  callbacks.normal_cb = AddNormal;
  callbacks.index_cb = AddFace;
  std::istringstream stream(*lines);
  std::string warnings, errors;
  if (!tinyobj::LoadObjWithCallback(stream, callbacks, &mesh, nullptr, &warnings, &errors))
    return InputError(file + ": damaged OBJ: " + errors);
  return mesh;
}

}  // namespace turnlight::rig
