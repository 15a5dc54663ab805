// Wavefront OBJ: the lines of vertices, normals and faces; all others are passed over.
#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

#include "base/printable.h"
#include "rig/session/mesh_formats.h"
#include "rig/session/number_text.h"

namespace turnlight::rig {
namespace {

constexpr std::string_view kBlanks = " \t\v\f";
constexpr std::string_view kBom = "\xEF\xBB\xBF";

std::string_view TakeWord(std::string_view& rest) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; };
  const auto begin = std::find_if_not(rest.begin(), rest.end(), blank);
  const auto end = std::find_if(begin, rest.end(), blank);
  const std::string_view word(begin, end);
  rest = std::string_view(end, rest.end());
  return word;
}

// Walks through the lines of a file, ended by CR, LF or both.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {
    if (rest_.starts_with(kBom)) rest_.remove_prefix(kBom.size());
  }

  // The next line of vertices, normals or faces; false at the end. A line that ends with a
  // backslash goes on in the next. The view is good until the next call.
  bool Next(std::string_view& line) {
    while (!rest_.empty()) {
      line = TakeLine();
      number_ = ends_;
      std::string_view words = line;
      const std::string_view keyword = TakeWord(words);
      if (keyword != "v" && keyword != "vn" && keyword != "f") continue;
      if (!Continues(line)) return true;
      joined_.clear();
      while (Continues(line)) {
        joined_.append(line.substr(0, line.find_last_of('\\'))).push_back(' ');
        line = TakeLine();
      }
      line = joined_.append(line);
      return true;
    }
    return false;
  }
  // Of the line's beginning, from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view TakeLine() {
    const auto end =
        std::find_if(rest_.begin(), rest_.end(), [](char c) { return c == '\n' || c == '\r'; });
    std::string_view line = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(line.size());
    rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : rest_.empty() ? 0 : 1);
    ++ends_;
    return line.substr(0, CommentOf(line));
  }
  // Where a word begins with #: "1.#QNAN" is a number.
  static std::size_t CommentOf(std::string_view line) {
    std::size_t at = line.find('#');
    while (at != std::string_view::npos && at > 0 &&
           kBlanks.find(line[at - 1]) == std::string_view::npos)
      at = line.find('#', at + 1);
    return at;
  }
  static bool Continues(std::string_view line) {
    const std::size_t last = line.find_last_not_of(kBlanks);
    return last != std::string_view::npos && line[last] == '\\';
  }

  std::string_view rest_;
  std::string joined_;
  std::size_t ends_ = 0, number_ = 0;
};

// An index as the file has it, counted from 1 or backwards from -1, counted from 0; what names
// nothing is negative.
std::int32_t Resolve(std::int64_t index, std::size_t count) {
  const std::int64_t from_0 = index > 0 ? index - 1 : static_cast<std::int64_t>(count) + index;
  return index == 0 ? -1 : KeptIndex(static_cast<double>(from_0));
}

// A corner of a face: v, v/t, v//n or v/t/n, where t and n may be left empty. False if it is none.
bool TakeCorner(std::string_view word, PolygonMesh& mesh) {
  std::array<std::int64_t, 3> indices{};
  std::size_t given = 0;
  for (std::size_t part = 0; part < 3; ++part) {
    const std::string_view text = word.substr(0, word.find('/'));
    if (!text.empty()) {
      const char* end = text.data() + text.size();
      const auto read = std::from_chars(text.data() + (text[0] == '+' ? 1 : 0), end, indices[part]);
      if (read.ec != std::errc() || read.ptr != end) return false;
      given |= std::size_t{1} << part;
    }
    if (text.size() == word.size()) {
      word = {};
      break;
    }
    word.remove_prefix(text.size() + 1);
  }
  if (!word.empty() || (given & 1) == 0) return false;
  PolygonMesh::Corner corner;
  corner.vertex = Resolve(indices[0], mesh.vertices.size());
  if ((given & 4) != 0) corner.normal = Resolve(indices[2], mesh.normals.size());
  mesh.corners.push_back(corner);
  return true;
}

bool TakeVector(std::string_view words, std::vector<Eigen::Vector3d>& vectors) {
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) {
    const auto number = NumberOf(TakeWord(words));
    if (!number) return false;
    vector[i] = *number;
  }
  vectors.push_back(vector);
  return true;
}

bool TakeFace(std::string_view words, PolygonMesh& mesh) {
  for (std::string_view word; !(word = TakeWord(words)).empty();)
    if (!TakeCorner(word, mesh)) return false;
  mesh.ends.push_back(mesh.corners.size());
  return true;
}

}  // namespace

Result<PolygonMesh> ReadObj(const std::string& bytes, const std::string& file) {
  PolygonMesh mesh;
  Lines lines(bytes);
  for (std::string_view line; lines.Next(line);) {
    std::string_view words = line;
    const std::string_view keyword = TakeWord(words);
    const bool face = keyword == "f";
    if (face ? TakeFace(words, mesh)
             : TakeVector(words, keyword == "v" ? mesh.vertices : mesh.normals))
      continue;
    return InputError(file + ":" + std::to_string(lines.number()) + ": " +
                      Printable(line.substr(0, 80)) +
                      (face ? ", allowed are corners v, v/t, v//n or v/t/n after \"f\""
                            : ", allowed are 3 numbers after \"" + std::string(keyword) + "\""));
  }
  return mesh;
}

}  // namespace turnlight::rig
