// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/surface_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/atomic_file.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

constexpr std::string_view solid = "solid ";
constexpr std::size_t header = 80, facet = 50;  // bytes of a binary file, and of one of its triangles

/// Triangles by their corners, joined where the file has the same numbers.
class JoinedCorners {
 public:
  JoinedCorners(const std::filesystem::path& path, double scale) : path_(path), scale_(scale) {}

  void add(const Vector3& corner) {
    Vector3 x = corner;
    for (double& coordinate : x) {
      coordinate = scale_ * coordinate + 0.0;  // −0 is 0
      if (!std::isfinite(coordinate))
        throw InputError(fmt::format("{}: triangle {} has a coordinate that is not finite. Export it anew.",
                                     path_.string(), mesh_.triangle.size() + 1));
    }
    const auto [found, is_new] = number_.emplace(x, static_cast<std::uint32_t>(mesh_.node.size()));
    if (is_new) mesh_.node.push_back(x);
    corner_[count_++] = found->second;
    if (count_ < 3) return;
    count_ = 0;
    // Slivers whose corners coincide in single precision have no area.
    if (corner_[0] != corner_[1] && corner_[1] != corner_[2] && corner_[2] != corner_[0])
      mesh_.triangle.push_back(corner_);
  }
  bool is_whole() const { return count_ == 0; }
  SurfaceMesh take() { return std::move(mesh_); }

 private:
  const std::filesystem::path& path_;
  double scale_;
  SurfaceMesh mesh_;
  std::map<Vector3, std::uint32_t> number_;
  std::array<std::uint32_t, 3> corner_{};
  std::size_t count_ = 0;
};

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t k = 4; k-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes[at + k]);
  return out;
}

void read_binary(const std::string& bytes, JoinedCorners& out) {
  for (std::size_t at = header + 4; at < bytes.size(); at += facet)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Vector3 x{};
      for (std::size_t k = 0; k < 3; ++k)
        x[k] = std::bit_cast<float>(word_at(bytes, at + 12 * (corner + 1) + 4 * k));
      out.add(x);
    }
}

constexpr std::string_view space = " \t\r\n";

/// The next word of a text, without it; empty at the end.
std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(space), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(space));
  text.remove_prefix(word.size());
  return word;
}

/// @return whether the word is a number
template <class Number>
bool read_number(std::string_view word, Number& out) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  return error == std::errc() && end == word.data() + word.size();
}

/// The next three words as numbers. @return whether they are
bool read_numbers(std::string_view& text, Vector3& out) {
  return std::ranges::all_of(out, [&](double& value) { return read_number(take_word(text), value); });
}

/// Reads "vertex x y z" anywhere in the text. Returns false for a vertex without three numbers.
bool read_text(std::string_view text, JoinedCorners& out) {
  constexpr std::string_view vertex = "vertex";
  Vector3 x{};
  for (std::string_view word; !(word = take_word(text)).empty();) {
    if (word != vertex) continue;
    if (!read_numbers(text, x)) return false;
    out.add(x);
  }
  return true;
}

/// Reads the lines "v x y z" and "f i j k …" of a Wavefront OBJ file. Corners count vertices from 1, or from
/// the last one, −1, backwards; a texture and a normal may follow them, i/t/n. A face with more than
/// three corners is cut at the first of them. Other lines are left out. Returns the number of the first line
/// that is wrong, or 0.
std::size_t read_obj(std::string_view text, JoinedCorners& out) {
  std::vector<Vector3> vertex;
  std::vector<std::size_t> corner;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::string_view kind = take_word(line);
    if (kind == "v" && !read_numbers(line, vertex.emplace_back())) return number;
    if (kind != "f") continue;
    corner.clear();
    for (std::string_view word; !(word = take_word(line)).empty();) {
      std::int64_t at = 0;
      if (!read_number(word.substr(0, word.find('/')), at)) return number;
      const auto count = std::ssize(vertex);
      if (at == 0 || at > count || at < -count) return number;
      corner.push_back(static_cast<std::size_t>(at > 0 ? at - 1 : count + at));
    }
    if (corner.size() < 3) return number;
    for (std::size_t k = 2; k < corner.size(); ++k)
      for (const std::size_t i : {corner[0], corner[k - 1], corner[k]}) out.add(vertex[i]);
  }
  return 0;
}

bool is_obj(const std::filesystem::path& path) {
  return std::ranges::equal(path.extension().string(), std::string_view(".obj"), {},
                            [](unsigned char c) { return std::tolower(c); });
}

}  // namespace

SurfaceMesh read_surface(const std::filesystem::path& path, double scale) {
  const auto refuse = [&](const char* what) { throw InputError(fmt::format("{}: {}", path.string(), what)); };
  std::error_code failure;
  std::ifstream file(path, std::ios::binary);
  if (!std::filesystem::is_regular_file(path, failure) || !file)
    refuse("no such file. Name an STL or OBJ file of a closed surface.");
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  JoinedCorners out(path, scale);
  const bool is_binary =
      bytes.size() >= header + 4 && bytes.size() == header + 4 + facet * std::size_t{word_at(bytes, header)};
  if (is_obj(path)) {
    if (const std::size_t line = read_obj(bytes, out); line > 0)
      throw InputError(fmt::format(
          "{}: line {} is no vertex with three numbers, and no face with three or more corners among the "
          "vertices before it. Export the surface anew, or as STL.",
          path.string(), line));
  } else if (is_binary)
    read_binary(bytes, out);
  else if (!bytes.starts_with("solid") || !read_text(bytes, out) || !out.is_whole())
    refuse(
        "is no STL file, or is incomplete. Export the surface as STL, for example by gmsh FILE -2 -format "
        "stl.");
  SurfaceMesh mesh = out.take();
  if (mesh.triangle.empty()) refuse("has no triangles. Export the surface anew.");
  return mesh;
}

void write_surface(const SurfaceMesh& mesh, const std::string& title, const std::filesystem::path& path) {
  base::AtomicFile temporary(path);
  std::ofstream file(temporary.path());
  file << solid << title << '\n';
  for (const auto& triangle : mesh.triangle) {
    file << "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t corner : triangle)
      file << fmt::format("vertex {} {} {}\n", mesh.node[corner][0], mesh.node[corner][1],
                          mesh.node[corner][2]);
    file << "endloop\nendfacet\n";
  }
  file << "endsolid\n";
  file.close();
  if (!file) temporary.fail();
  temporary.commit();
}

std::string title_of_surface(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  return std::getline(file, line) && line.starts_with(solid) ? line.substr(solid.size()) : "";
}

}  // namespace ricochet::contact
