// PLY by OpenMesh's reader, without its half-edge mesh: that drops faces it cannot link.
//
// The reader trusts a header, reads lists that it does not know as single values, and keeps its
// state in one global object. So the header is parsed here and passed on in a plain form with only
// what is needed, the stream throws where the reader would go on after the end, and one thread
// reads at a time.
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <charconv>
#include <locale>
#include <map>
#include <mutex>
#include <sstream>
#include <string_view>

#include "rig/session/mesh_formats.h"

namespace turnlight::rig {
namespace {

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

struct Property {
  std::string name;
  std::string type;        // the plain name: "uchar", "float", ...
  std::string count_type;  // of a list's length; empty for a single value
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string format;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes up to the first value
};

// The names of types that files use, and the ones that the reader knows in every place.
const std::map<std::string, std::string, std::less<>> kTypes{
    {"char", "char"},   {"int8", "char"},     {"uchar", "uchar"},   {"uint8", "uchar"},
    {"short", "short"}, {"int16", "short"},   {"ushort", "ushort"}, {"uint16", "ushort"},
    {"int", "int"},     {"int32", "int"},     {"uint", "uint"},     {"uint32", "uint"},
    {"float", "float"}, {"float32", "float"}, {"double", "double"}, {"float64", "double"}};
// Lengths of lists: a list that fits in memory is as long read as signed or unsigned.
const std::map<std::string, std::string, std::less<>> kCountTypes{
    {"char", "uchar"},   {"uchar", "uchar"}, {"ushort", "uint16"},
    {"short", "uint16"}, {"int", "int"},     {"uint", "int"}};

std::vector<std::string> Words(std::string_view line) {
  std::vector<std::string> words;
  std::istringstream stream{std::string(line)};
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

bool ParseProperty(const std::vector<std::string>& words, Property& property) {
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3) return false;
  const auto type = kTypes.find(words[words.size() - 2]);
  if (type == kTypes.end()) return false;
  property = {words.back(), type->second, ""};
  if (!list) return true;
  const auto count = kTypes.find(words[2]);
  if (count == kTypes.end() || !kCountTypes.contains(count->second)) return false;
  property.count_type = kCountTypes.at(count->second);
  return true;
}

// Takes one line of the header; false if it cannot be understood.
bool ParseLine(const std::vector<std::string>& words, Header& header) {
  if (words[0] == "comment" || words[0] == "obj_info") return true;
  if (words[0] == "format" && words.size() == 3 && words[2] == "1.0") {
    header.format = words[1];
    return words[1] == "ascii" || words[1] == "binary_little_endian" ||
           words[1] == "binary_big_endian";
  }
  if (words[0] == "element" && words.size() == 3) {
    Element element{words[1], 0, {}};
    const char* end = words[2].data() + words[2].size();
    const auto result = std::from_chars(words[2].data(), end, element.count);
    header.elements.push_back(element);
    return result.ec == std::errc() && result.ptr == end;
  }
  if (words[0] == "property" && !header.elements.empty()) {
    header.elements.back().properties.emplace_back();
    return ParseProperty(words, header.elements.back().properties.back());
  }
  return false;
}

Result<Header> ParseHeader(const std::string& bytes, const std::string& file) {
  Header header;
  for (std::size_t number = 1;; ++number) {
    const std::size_t end = bytes.find('\n', header.size);
    if (end == std::string::npos || end - header.size > 4096)
      return InputError(file + ": truncated PLY: its header does not end");
    const std::string_view line = std::string_view(bytes).substr(header.size, end - header.size);
    header.size = end + 1;
    const std::vector<std::string> words = Words(line);
    if (number == 1 && (words.size() != 1 || (words[0] != "ply" && words[0] != "PLY")))
      return InputError(file + ": not a PLY file: it does not begin with \"ply\"");
    if (number == 1 || words.empty()) continue;
    if (words[0] == "end_header") return header;
    if (!ParseLine(words, header))
      return InputError(
          file + ":" + std::to_string(number) + ": \"" + std::string(line.substr(0, 80)) +
          "\", allowed are format 1.0, element, property, comment and obj_info lines" +
          " with PLY's types");
  }
}

bool HasScalar(const Element& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(), [&](const Property& p) {
    return p.name == name && p.count_type.empty() && (p.type == "float" || p.type == "double");
  });
}

bool HasNormals(const Element& vertex) {
  return HasScalar(vertex, "nx") && HasScalar(vertex, "ny") && HasScalar(vertex, "nz");
}

bool IsList(const Property& property) { return !property.count_type.empty(); }

bool IsIndexList(const Property& property) {
  return IsList(property) && (property.name == "vertex_index" || property.name == "vertex_indices");
}

Status CheckHeader(const Header& header, const std::string& bytes, const std::string& file) {
  if (header.format.empty()) return InputError(file + ": damaged PLY: its header has no format");
  if (header.elements.size() < 2 || header.elements[0].name != "vertex" ||
      header.elements[1].name != "face")
    return InputError(file + ": the PLY elements do not begin with vertex and face: no faces to" +
                      " read");
  const Element& vertex = header.elements[0];
  const Element& face = header.elements[1];
  for (const char* axis : {"x", "y", "z"})
    if (!HasScalar(vertex, axis))
      return InputError(file + ": the PLY vertices have no property " + axis +
                        " of type float or double");
  for (const Property& property : vertex.properties)
    if (IsList(property))
      return InputError(file + ": PLY list property " + property.name +
                        " of vertices, allowed are single values");
  const auto& properties = face.properties;
  if (properties.empty() || !IsIndexList(properties[0]) ||
      std::count_if(properties.begin(), properties.end(), IsList) != 1)
    return InputError(file +
                      ": the PLY faces have another list than vertex_indices or do not begin" +
                      " with it, allowed is one list, vertex_indices, and single values after it");
  for (const Element& element : {vertex, face})
    if (element.count > bytes.size())
      return InputError(file + ": truncated PLY: " + std::to_string(element.count) + " elements " +
                        element.name + " in a file of " + std::to_string(bytes.size()) + " bytes");
  return {};
}

// The same file with a header of only what the reader needs to know. Single values that are of no
// use are named so that it skips them.
std::string PlainFile(const Header& header, const std::string& bytes) {
  static const std::vector<std::string> kUsed{"x", "y", "z", "nx", "ny", "nz"};
  const bool normals = HasNormals(header.elements[0]);
  std::string text = "ply\nformat " + header.format + " 1.0\n";
  for (std::size_t i = 0; i < 2; ++i) {
    const Element& element = header.elements[i];
    text += "element " + element.name + " " + std::to_string(element.count) + "\n";
    for (const Property& property : element.properties) {
      const auto used = std::find(kUsed.begin(), kUsed.end(), property.name);
      if (IsList(property))
        text += "property list " + property.count_type + " " + property.type + " vertex_indices\n";
      else if (i == 0 && used - kUsed.begin() < (normals ? 6 : 3))
        text += "property " + property.type + " " + property.name + "\n";
      else
        text += "property " + property.type + " skipped\n";
    }
  }
  return text + "end_header\n" + bytes.substr(header.size);
}

// Takes what the reader reports. The half of the interface that is about other things does nothing.
class Importer : public OpenMesh::IO::BaseImporter {
 public:
  const PolygonMesh& mesh() const { return mesh_; }

  VertexHandle add_vertex() override {
    mesh_.vertices.emplace_back(0.0, 0.0, 0.0);
    return VertexHandle(static_cast<int>(mesh_.vertices.size()) - 1);
  }
  VertexHandle add_vertex(const OpenMesh::Vec3f& point) override {
    const VertexHandle vertex = add_vertex();
    set_point(vertex, point);
    return vertex;
  }
  void set_point(VertexHandle vertex, const OpenMesh::Vec3f& p) override {
    mesh_.vertices.at(static_cast<std::size_t>(vertex.idx())) = {p[0], p[1], p[2]};
  }
  void set_normal(VertexHandle vertex, const OpenMesh::Vec3f& n) override {
    mesh_.normals.resize(mesh_.vertices.size());
    mesh_.normals.at(static_cast<std::size_t>(vertex.idx())) = {n[0], n[1], n[2]};
  }
  FaceHandle add_face(const VHandles& vertices) override {
    for (const VertexHandle vertex : vertices) mesh_.corners.push_back({vertex.idx(), -1});
    mesh_.ends.push_back(mesh_.corners.size());
    return FaceHandle(static_cast<int>(mesh_.ends.size()) - 1);
  }
  std::size_t n_vertices() const override { return mesh_.vertices.size(); }
  std::size_t n_faces() const override { return mesh_.ends.size(); }
  std::size_t n_edges() const override { return 0; }

  HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
  FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<OpenMesh::Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<OpenMesh::Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_normal(VertexHandle, const OpenMesh::Vec3d&) override {}
  void set_color(VertexHandle, const OpenMesh::Vec3uc&) override {}
  void set_color(VertexHandle, const OpenMesh::Vec4uc&) override {}
  void set_color(VertexHandle, const OpenMesh::Vec3f&) override {}
  void set_color(VertexHandle, const OpenMesh::Vec4f&) override {}
  void set_texcoord(VertexHandle, const OpenMesh::Vec2f&) override {}
  void set_status(VertexHandle, const OpenMesh::Attributes::StatusInfo&) override {}
  void set_next(HalfedgeHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(HalfedgeHandle, const OpenMesh::Vec2f&) override {}
  void set_texcoord(VertexHandle, const OpenMesh::Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const OpenMesh::Vec3f&) override {}
  void set_status(HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
  void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3uc&) override {}
  void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4uc&) override {}
  void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3f&) override {}
  void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4f&) override {}
  void set_status(OpenMesh::EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
  void set_normal(FaceHandle, const OpenMesh::Vec3f&) override {}
  void set_normal(FaceHandle, const OpenMesh::Vec3d&) override {}
  void set_color(FaceHandle, const OpenMesh::Vec3uc&) override {}
  void set_color(FaceHandle, const OpenMesh::Vec4uc&) override {}
  void set_color(FaceHandle, const OpenMesh::Vec3f&) override {}
  void set_color(FaceHandle, const OpenMesh::Vec4f&) override {}
  void set_status(FaceHandle, const OpenMesh::Attributes::StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}

 private:
  PolygonMesh mesh_;
};

}  // namespace

Result<PolygonMesh> ReadPly(const std::string& bytes, const std::string& file) {
  const auto header = ParseHeader(bytes, file);
  if (!header) return Forward(header);
  if (const Status status = CheckHeader(*header, bytes, file); !status) return Forward(status);
  Importer importer;
  bool read = false;
  try {
    static std::mutex one_reader;
    const std::lock_guard lock(one_reader);
    omerr().disable();
    omlog().disable();
    std::istringstream stream(PlainFile(*header, bytes));
    stream.imbue(std::locale::classic());
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    OpenMesh::IO::Options options = OpenMesh::IO::Options::VertexNormal;
    read = OpenMesh::IO::PLYReader().read(stream, importer, options);
  } catch (const std::ios_base::failure&) {
    read = false;
  }
  if (!read || importer.n_vertices() != header->elements[0].count ||
      importer.n_faces() != header->elements[1].count)
    return InputError(
        file + ": damaged or truncated PLY: its values end, or cannot be read, after " +
        std::to_string(importer.n_vertices()) + " of " + std::to_string(header->elements[0].count) +
        " vertices and " + std::to_string(importer.n_faces()) + " of " +
        std::to_string(header->elements[1].count) + " faces");
  PolygonMesh mesh = importer.mesh();
  if (!mesh.normals.empty())
    for (PolygonMesh::Corner& corner : mesh.corners) corner.normal = corner.vertex;
  return mesh;
}

}  // namespace turnlight::rig
