// See mesh.h. Formats: Wavefront OBJ ("v x y z [w]", "f a b c ..." with
// corners a, a/t, a//n or a/t/n, counted from 1 or back from -1), STL (ASCII "vertex x y z";
// binary: 80 bytes of header, a little-endian count, 50 bytes a triangle).
#include "scene/mesh.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unordered_set>
#include <utility>

#include "math/hash.h"

namespace tumble {
namespace {

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;  // bytes
constexpr std::string_view kBlank = " \t\r";

[[noreturn]] void fail(const std::string& name, std::size_t line, const std::string& reason,
                       std::string_view value) {
  throw MeshError(name + ":" + std::to_string(line) + ": " + reason + " (" +
                  std::string(value.substr(0, 60)) + ")");
}

std::string_view next_token(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(kBlank), line.size());
  const std::size_t end = std::min(line.find_first_of(kBlank, begin), line.size());
  const std::string_view token = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return token;
}

/// Calls visit(line, number from 1) for every line.
template <class Visit>
void for_each_line(std::string_view text, Visit&& visit) {
  for (std::size_t begin = 0, number = 1; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    visit(text.substr(begin, end - begin), number);
    begin = end + 1;
  }
}

Vec3 parse_point(std::string_view rest, const std::string& name, std::size_t number) {
  const std::string_view whole = rest;
  Vec3 point;
  for (int i = 0; i < 3; ++i) {
    const std::string_view token = next_token(rest);
    const std::from_chars_result end = std::from_chars(token.data(), token.data() + token.size(), point[i]);
    if (token.empty() || end.ec != std::errc() || end.ptr != token.data() + token.size()) {
      fail(name, number, "a vertex needs three numbers", whole);
    }
    if (!std::isfinite(point[i])) fail(name, number, "a vertex must be finite", token);
  }
  return point;
}

struct PointHash {
  std::size_t operator()(const Vec3& p) const {
    Hash hash;
    hash.add(p);
    return hash.value();
  }
};

std::uint32_t read_word(std::string_view bytes, std::size_t offset) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  }
  return word;
}

/// One corner of an OBJ face, as an index from 0.
std::uint32_t parse_corner(std::string_view token, std::size_t vertices, const std::string& name,
                           std::size_t number) {
  const std::string_view index = token.substr(0, token.find('/'));
  std::int64_t i = 0;
  const std::from_chars_result end = std::from_chars(index.data(), index.data() + index.size(), i);
  if (index.empty() || end.ec != std::errc() || end.ptr != index.data() + index.size()) {
    fail(name, number, "a face's corner needs the number of a vertex", token);
  }
  const std::int64_t from_zero = i < 0 ? i + static_cast<std::int64_t>(vertices) : i - 1;
  if (from_zero < 0 || from_zero >= static_cast<std::int64_t>(vertices)) {
    fail(name, number, "a face names a vertex that is not above it, of " + std::to_string(vertices), token);
  }
  return static_cast<std::uint32_t>(from_zero);
}

void parse_face(std::string_view rest, const std::string& name, std::size_t number, MeshTriangles& mesh) {
  std::vector<std::uint32_t> loop;
  const std::string_view whole = rest;
  for (std::string_view token = next_token(rest); !token.empty(); token = next_token(rest)) {
    loop.push_back(parse_corner(token, mesh.vertices.size(), name, number));
  }
  if (loop.size() < 3) fail(name, number, "a face needs three corners or more", whole);
  for (std::size_t i = 2; i < loop.size(); ++i) mesh.triangles.push_back({loop[0], loop[i - 1], loop[i]});
}

/// STL has no indices: every three points are a triangle.
MeshTriangles as_triangles(std::vector<Vec3> points) {
  MeshTriangles mesh{std::move(points), {}};
  for (std::uint32_t i = 2; i < mesh.vertices.size(); i += 3) mesh.triangles.push_back({i - 2, i - 1, i});
  return mesh;
}

std::vector<Vec3> read_binary_stl(std::string_view bytes, const std::string& name) {
  const std::uint64_t triangles = read_word(bytes, kStlHeader - 4);
  std::vector<Vec3> points;
  points.reserve(3 * triangles);
  for (std::uint64_t t = 0; t < triangles; ++t) {
    for (std::size_t corner = 1; corner <= 3; ++corner) {  // 0 is the normal
      Vec3 p;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t offset = kStlHeader + t * kStlTriangle + 12 * corner + 4 * i;
        p[static_cast<Eigen::Index>(i)] = std::bit_cast<float>(read_word(bytes, offset));
      }
      if (!p.allFinite())
        throw MeshError(name + ": a vertex must be finite (triangle " + std::to_string(t) + ")");
      points.push_back(p);
    }
  }
  return points;
}

std::vector<Vec3> read_ascii_stl(std::string_view text, const std::string& name) {
  std::vector<Vec3> points;
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    if (next_token(line) == "vertex") points.push_back(parse_point(line, name, number));
  });
  return points;
}

}  // namespace

std::string resolve_mesh_path(const std::string& uri, const std::string& directory) {
  std::string path = uri.starts_with("file://") ? uri.substr(7) : uri;
  if (path.empty()) throw MeshError("names no file");
  if (path.find("://") != std::string::npos)
    throw MeshError("only paths and file:// are supported (" + uri + ")");
  return (std::filesystem::path(directory) / path).lexically_normal().string();
}

std::vector<Vec3> distinct_points(const std::vector<Vec3>& points) {
  std::unordered_set<Vec3, PointHash> seen;  // never iterated: the order stays the file's
  std::vector<Vec3> result;
  for (Vec3 p : points) {
    p += Vec3::Zero();  // -0 and 0 are one point
    if (seen.insert(p).second) result.push_back(p);
  }
  return result;
}

MeshTriangles read_obj(std::string_view text, const std::string& name) {
  MeshTriangles mesh;
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    const std::string_view keyword = next_token(line);
    if (keyword == "v") mesh.vertices.push_back(parse_point(line, name, number));
    if (keyword == "f") parse_face(line, name, number, mesh);
  });
  return mesh;
}

MeshTriangles read_stl(std::string_view bytes, const std::string& name) {
  // The length decides: "solid" opens many binary files too.
  const bool has_header = bytes.size() >= kStlHeader;
  if (has_header &&
      bytes.size() == kStlHeader + std::uint64_t{kStlTriangle} * read_word(bytes, kStlHeader - 4)) {
    return as_triangles(read_binary_stl(bytes, name));
  }
  if (bytes.starts_with("solid")) {
    if (std::vector<Vec3> points = read_ascii_stl(bytes, name); !points.empty()) {
      return as_triangles(std::move(points));
    }
  }
  throw MeshError(
      name + ": neither ASCII nor binary STL (" + std::to_string(bytes.size()) + " bytes" +
      (has_header ? ", header says " + std::to_string(read_word(bytes, kStlHeader - 4)) + " triangles" : "") +
      ")");
}

MeshTriangles read_mesh_file(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (extension != ".obj" && extension != ".stl")
    throw MeshError(path + ": only .obj and .stl are supported (" + extension + ")");
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) throw MeshError(path + ": cannot be read");
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return extension == ".obj" ? read_obj(bytes, path) : read_stl(bytes, path);
}

}  // namespace tumble
