// PLY: the header says what follows, so that whatever is not of the mesh can be stepped over.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "base/printable.h"
#include "rig/session/mesh_formats.h"
#include "rig/session/number_text.h"
#include "rig/session/ply_header.h"

namespace turnlight::rig {
namespace {

constexpr double kStripEnd = -1.0, kUnsignedStripEnd = 4294967295.0;

// Values one after another, as text. Each Take is false where the values end or are no numbers.
class TextValues {
 public:
  explicit TextValues(std::string_view rest) : rest_(rest) {}

  bool Take(PlyType, double& value) {
    const auto number = NumberOf(Word());
    value = number.value_or(0.0);
    return number.has_value();
  }
  bool Skip(PlyType, std::size_t count) {
    for (; count > 0; --count)
      if (Word().empty()) return false;
    return true;
  }
  // The least that a value takes, and what is there, in bytes.
  static double BytesOf(PlyType) { return 2.0; }
  double Left() const { return static_cast<double>(rest_.size()) + 1.0; }

 private:
  std::string_view Word() {
    const auto blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    const char* end = rest_.data() + rest_.size();
    const char* begin = std::find_if_not(rest_.data(), end, blank);
    const char* stop = std::find_if(begin, end, blank);
    rest_ = {stop, static_cast<std::size_t>(end - stop)};
    return {begin, static_cast<std::size_t>(stop - begin)};
  }
  std::string_view rest_;
};

// The same, as bytes.
class BinaryValues {
 public:
  BinaryValues(std::string_view rest, bool big)
      : rest_(rest), swap_(big == (std::endian::native == std::endian::little)) {}

  bool Take(PlyType type, double& value) {
    if (rest_.size() < SizeOf(type)) return false;
    switch (type) {
      case PlyType::kInt8:
        value = Get<std::int8_t>();
        break;
      case PlyType::kUint8:
        value = Get<std::uint8_t>();
        break;
      case PlyType::kInt16:
        value = Get<std::int16_t>();
        break;
      case PlyType::kUint16:
        value = Get<std::uint16_t>();
        break;
      case PlyType::kInt32:
        value = Get<std::int32_t>();
        break;
      case PlyType::kUint32:
        value = Get<std::uint32_t>();
        break;
      case PlyType::kFloat:
        value = Get<float>();
        break;
      case PlyType::kDouble:
        value = Get<double>();
        break;
    }
    return true;
  }
  bool Skip(PlyType type, std::size_t count) {
    if (static_cast<double>(count) * BytesOf(type) > Left()) return false;
    rest_.remove_prefix(count * SizeOf(type));
    return true;
  }
  static double BytesOf(PlyType type) { return static_cast<double>(SizeOf(type)); }
  double Left() const { return static_cast<double>(rest_.size()); }

 private:
  template <typename T>
  T Get() {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    if (swap_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }
  std::string_view rest_;
  bool swap_;
};

// Of a vertex: where in the element's list of properties x, y, z, nx, ny, nz are; -1 if not there.
using VertexSlots = std::array<int, 6>;

int SlotOf(const PlyElement& element, std::string_view name, bool list) {
  for (std::size_t i = 0; i < element.properties.size(); ++i)
    if (element.properties[i].name == name && element.properties[i].count_type.has_value() == list)
      return static_cast<int>(i);
  return -1;
}

int IndexSlot(const PlyElement& element) {
  const int slot = SlotOf(element, "vertex_indices", true);
  return slot >= 0 ? slot : SlotOf(element, "vertex_index", true);
}

bool IsFaces(const PlyElement& element) {
  return element.name == "face" || element.name == "tristrips";
}

Result<VertexSlots> SlotsOfVertex(const PlyElement& vertex, const std::string& file) {
  VertexSlots slots{};
  const std::array<std::string_view, 6> names{"x", "y", "z", "nx", "ny", "nz"};
  for (std::size_t i = 0; i < names.size(); ++i) slots[i] = SlotOf(vertex, names[i], false);
  for (std::size_t i = 0; i < 3; ++i)
    if (slots[i] < 0)
      return InputError(file + ": the PLY vertices have no property " + std::string(names[i]) +
                        ", allowed is a single number of any type");
  if (slots[3] < 0 || slots[4] < 0 || slots[5] < 0) slots[3] = slots[4] = slots[5] = -1;
  return slots;
}

Status CheckElements(const PlyHeader& header, const std::string& file) {
  std::size_t vertices = 0, faces = 0;
  std::string names;
  for (const PlyElement& element : header.elements) {
    vertices += element.name == "vertex" ? 1 : 0;
    faces += IsFaces(element) ? 1 : 0;
    if (names.size() < 200) names += (names.empty() ? "" : ", ") + element.name.substr(0, 40);
    if (IsFaces(element) && IndexSlot(element) < 0)
      return InputError(file + ": the PLY element " + element.name +
                        " has no list vertex_indices or vertex_index");
  }
  if (vertices != 1 || faces == 0)
    return InputError(file + ": the PLY is no mesh: its elements are " +
                      (names.empty() ? "none" : Printable(names)) +
                      ", allowed are one vertex, and face or tristrips" +
                      (faces == 0 ? "; of a cloud of points make a mesh first" : ""));
  return {};
}

template <typename Values>
class PlyReader {
 public:
  PlyReader(const PlyHeader& header, const std::string& file, Values values)
      : header_(header), file_(file), values_(std::move(values)) {}

  Result<PolygonMesh> Read() {
    std::size_t needed = 0;
    for (std::size_t i = 0; i < header_.elements.size(); ++i)
      if (IsFaces(header_.elements[i]) || header_.elements[i].name == "vertex") needed = i + 1;
    for (std::size_t i = 0; i < needed; ++i) {
      const PlyElement& element = header_.elements[i];
      if (const Status status = CheckRoom(element); !status) return Forward(status);
      std::size_t done = 0;
      if (element.name == "vertex") {
        const auto slots = SlotsOfVertex(element, file_);
        if (!slots) return Forward(slots);
        done = Vertices(element, *slots);
      } else if (IsFaces(element)) {
        done = Faces(element, static_cast<std::size_t>(IndexSlot(element)));
      } else {
        done = Others(element);
      }
      if (done < element.count)
        return InputError(file_ +
                          ": damaged or truncated PLY: its values end, or cannot be read, after " +
                          std::to_string(done) + " of " + std::to_string(element.count) +
                          " elements " + Printable(element.name.substr(0, 40)));
    }
    if (has_normals_)
      for (PolygonMesh::Corner& corner : mesh_.corners) corner.normal = corner.vertex;
    return std::move(mesh_);
  }

 private:
  // Every element takes at least its single values and the lengths of its lists.
  Status CheckRoom(const PlyElement& element) const {
    double bytes = 0.0;
    for (const PlyProperty& property : element.properties)
      bytes += Values::BytesOf(property.count_type.value_or(property.type));
    if (static_cast<double>(element.count) * bytes <= values_.Left()) return {};
    return InputError(file_ + ": truncated PLY: " + std::to_string(element.count) + " elements " +
                      Printable(element.name.substr(0, 40)) + " do not fit in the file");
  }

  bool SkipProperty(const PlyProperty& property) {
    if (!property.count_type) return values_.Skip(property.type, 1);
    std::size_t length = 0;
    return Length(property, length) && values_.Skip(property.type, length);
  }
  // The length of a list; a signed one that seems negative was written as unsigned.
  bool Length(const PlyProperty& property, std::size_t& length) {
    double value = 0.0;
    if (!values_.Take(*property.count_type, value)) return false;
    if (value < 0.0) value += std::exp2(8.0 * static_cast<double>(SizeOf(*property.count_type)));
    if (!(value >= 0.0) || value != std::floor(value) ||
        value * Values::BytesOf(property.type) > values_.Left())
      return false;
    length = static_cast<std::size_t>(value);
    return true;
  }

  // Each returns how many elements could be read.
  std::size_t Others(const PlyElement& element) {
    if (element.properties.empty()) return element.count;
    for (std::size_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties)
        if (!SkipProperty(property)) return i;
    return element.count;
  }

  std::size_t Vertices(const PlyElement& element, const VertexSlots& slots) {
    has_normals_ = slots[3] >= 0;
    mesh_.single_precision = std::all_of(slots.begin(), slots.begin() + 3, [&](int slot) {
      return element.properties[static_cast<std::size_t>(slot)].type == PlyType::kFloat;
    });
    std::vector<int> part(element.properties.size(), -1);  // of a vertex, by property
    for (std::size_t k = 0; k < slots.size(); ++k)
      if (slots[k] >= 0) part[static_cast<std::size_t>(slots[k])] = static_cast<int>(k);
    mesh_.vertices.reserve(element.count);
    if (has_normals_) mesh_.normals.reserve(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
      std::array<double, 6> v{};
      for (std::size_t p = 0; p < part.size(); ++p) {
        const bool ours = part[p] >= 0;
        if (ours ? !values_.Take(element.properties[p].type, v[static_cast<std::size_t>(part[p])])
                 : !SkipProperty(element.properties[p]))
          return i;
      }
      mesh_.vertices.emplace_back(v[0], v[1], v[2]);
      if (has_normals_) mesh_.normals.emplace_back(v[3], v[4], v[5]);
    }
    return element.count;
  }

  std::size_t Faces(const PlyElement& element, std::size_t index_slot) {
    const bool strips = element.name == "tristrips";
    mesh_.ends.reserve(mesh_.ends.size() + (strips ? 0 : element.count));
    for (std::size_t i = 0; i < element.count; ++i)
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p != index_slot ? !SkipProperty(property)
                            : !(strips ? Strip(property) : Polygon(property)))
          return i;
      }
    return element.count;
  }

  bool Polygon(const PlyProperty& property) {
    std::size_t length = 0;
    if (!Length(property, length)) return false;
    for (std::size_t i = 0; i < length; ++i) {
      double index = 0.0;
      if (!values_.Take(property.type, index)) return false;
      mesh_.corners.push_back({KeptIndex(index), -1});
    }
    mesh_.ends.push_back(mesh_.corners.size());
    return true;
  }

  // Triangles that each share an edge with the next, wound in turns; -1 begins a new strip. Those
  // that name a vertex twice are how strips are joined.
  bool Strip(const PlyProperty& property) {
    std::size_t length = 0;
    if (!Length(property, length)) return false;
    std::array<std::int32_t, 3> last{};
    std::size_t seen = 0;
    for (std::size_t i = 0; i < length; ++i) {
      double index = 0.0;
      if (!values_.Take(property.type, index)) return false;
      if (index == kStripEnd || index == kUnsignedStripEnd) {
        seen = 0;
        continue;
      }
      last = {last[1], last[2], KeptIndex(index)};
      if (++seen < 3 || last[0] == last[1] || last[1] == last[2] || last[2] == last[0]) continue;
      const bool turned = seen % 2 == 0;
      mesh_.corners.push_back({last[turned ? 1 : 0], -1});
      mesh_.corners.push_back({last[turned ? 0 : 1], -1});
      mesh_.corners.push_back({last[2], -1});
      mesh_.ends.push_back(mesh_.corners.size());
    }
    return true;
  }

  const PlyHeader& header_;
  const std::string& file_;
  Values values_;
  PolygonMesh mesh_;
  bool has_normals_ = false;
};

// A call of its own: from -O2 on, the vectoriser of g++ 12 drops the rounding of (double)(float)x.
[[gnu::noinline]] float SingleOf(double value) { return static_cast<float>(value); }

void RoundToFloat(std::vector<Eigen::Vector3d>& values) {
  for (Eigen::Vector3d& v : values) v = {SingleOf(v.x()), SingleOf(v.y()), SingleOf(v.z())};
}

// Text can say more than the type that it is declared as. It is taken at its type, as other
// programs do, unless that would spoil the mesh.
void TakeDeclaredPrecision(PolygonMesh& mesh) {
  if (!mesh.single_precision || ExtentOf(mesh.vertices).CoarseInFloat()) {
    mesh.single_precision = false;
    return;
  }
  RoundToFloat(mesh.vertices);
  RoundToFloat(mesh.normals);
}

}  // namespace

Result<PolygonMesh> ReadPly(const std::string& bytes, const std::string& file) {
  const auto header = ReadPlyHeader(bytes, file);
  if (!header) return Forward(header);
  if (const Status status = CheckElements(*header, file); !status) return Forward(status);
  const std::string_view rest = std::string_view(bytes).substr(header->size);
  if (header->format == PlyFormat::kAscii) {
    auto mesh = PlyReader<TextValues>(*header, file, TextValues(rest)).Read();
    if (mesh) TakeDeclaredPrecision(*mesh);
    return mesh;
  }
  const bool big = header->format == PlyFormat::kBigEndian;
  return PlyReader<BinaryValues>(*header, file, BinaryValues(rest, big)).Read();
}

}  // namespace turnlight::rig
