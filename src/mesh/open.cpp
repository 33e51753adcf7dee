// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/open.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmsh.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <vector>

#include "ricochet/error.hpp"
#include "src/mesh/file_kinds.hpp"
#include "src/mesh/fill_surface.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/msh_check.hpp"
#include "src/mesh/msh_outline.hpp"
#include "src/mesh/msh_sections.hpp"
#include "src/mesh/sew.hpp"
#include "src/scene/parts.hpp"

namespace ricochet::mesh {

namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

/// Whether the last word of `code` is `word`.
bool ends_in(const std::string& code, const std::string& word) {
  std::size_t end = code.size();
  while (end > 0 && is_space(code[end - 1])) --end;
  return end >= word.size() && code.compare(end - word.size(), word.size(), word) == 0 &&
         (end == word.size() || !is_word(code[end - word.size() - 1]));
}

/// The text of a .geo file without comments and strings, and the files that it includes.
struct Code {
  std::string text;
  std::vector<std::string> includes;
};

Code code_of(const std::filesystem::path& geo) {
  Code code;
  // Reading a device or a pipe might never end.
  if (std::error_code ignored; !std::filesystem::is_regular_file(geo, ignored)) return code;
  std::ostringstream stream;
  stream << std::ifstream(geo, std::ios::binary).rdbuf();
  const std::string text = stream.str();
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size());
      code.text += '\n';
    } else if (text.compare(i, 2, "/*") == 0) {
      i = std::min(text.find("*/", i + 2), text.size() - 2) + 1;
      code.text += ' ';
    } else if (text[i] == '"') {
      const std::size_t end = std::min(text.find('"', i + 1), text.size());
      if (ends_in(code.text, "Include")) code.includes.push_back(text.substr(i + 1, end - i - 1));
      code.text += ' ';
      i = end;
    } else {
      code.text += text[i];
    }
  }
  return code;
}

void check_parameters(const scene::Body& body) {
  if (body.geometry.empty()) return;
  const std::string file = body.mesh.filename().string();
  const std::string& asked = body.geometry.begin()->first;
  if (body.mesh.extension() != ".geo")
    throw InputError(fmt::format(
        "{}: bodies.{}.geometry.{}: only a .geo has parameters: remove it, or read the file from a .geo",
        file, body.name, asked));
  const std::set<std::string> defined = parameters_of(body.mesh);
  for (const auto& [name, value] : body.geometry)
    if (defined.count(name) == 0)
      throw InputError(
          fmt::format("{}: bodies.{}.geometry.{} = {}: the file has no such parameter: it defines {}. Change "
                      "the name, or "
                      "add it to a DefineConstant of the file.",
                      file, body.name, name, value,
                      defined.empty() ? "none" : fmt::format("{}", fmt::join(defined, ", "))));
}

/// A file in memory that sets the parameters of a .geo file and then merges that file. Parameters on the
/// command line of gmsh (-setnumber) would apply to all later bodies too.
class Parameters {
 public:
  explicit Parameters(const scene::Body& body) : file_(memfd_create("ricochet", MFD_CLOEXEC)) {
    std::string text;
    for (const auto& [parameter, value] : body.geometry) text += fmt::format("{} = {};\n", parameter, value);
    text += fmt::format("Merge \"{}\";\n", std::filesystem::absolute(body.mesh).string());
    if (file_ < 0 || write(file_, text.data(), text.size()) != std::ssize(text))
      throw InputError(fmt::format("{}: its parameters cannot be stored: free some memory",
                                   body.mesh.filename().string()));
  }
  Parameters(const Parameters&) = delete;
  Parameters& operator=(const Parameters&) = delete;
  ~Parameters() { close(file_); }
  std::string path() const { return fmt::format("/proc/self/fd/{}", file_); }

 private:
  int file_;
};

bool holds_elements() {
  for (int dim : {3, 1}) {
    std::vector<int> types;
    gmsh::model::mesh::getElementTypes(types, dim);
    if (!types.empty()) return true;
  }
  return false;
}

/// Refuses lines of zero length. For these, gmsh 4.8 throws in a thread of its own, which would end the
/// program.
void refuse_points_for_lines(const std::string& file) {
  gmsh::vectorpair curves, ends;
  gmsh::model::getEntities(curves, 1);
  if (curves.empty()) return;
  double low[3], high[3];
  gmsh::model::getBoundingBox(-1, -1, low[0], low[1], low[2], high[0], high[1], high[2]);
  const double size = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  for (const auto& [dim, tag] : curves) {
    std::string type;
    gmsh::model::getType(dim, tag, type);
    gmsh::model::getBoundary({{dim, tag}}, ends, /*combined=*/false, /*oriented=*/false);
    if (type != "Line" || ends.size() != 2) continue;
    std::vector<double> from, to;
    gmsh::model::getValue(0, ends[0].second, {}, from);
    gmsh::model::getValue(0, ends[1].second, {}, to);
    if (std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]) <= 1e-14 * size)
      throw InputError(
          fmt::format("{}: line {} has no length: check its points, and what geometry sets", file, tag));
  }
}

/// Adds the names in the list that starts at `i`. Returns the position after the list.
std::size_t add_listed(const std::string& code, std::size_t i, std::set<std::string>& names) {
  // A name stands at the start and after each comma outside nested brackets.
  int inner = 0;
  bool expected = true;
  for (; i < code.size() && inner >= 0; ++i) {
    const char c = code[i];
    if (expected && is_word(c)) {
      const std::size_t start = i;
      while (i + 1 < code.size() && is_word(code[i + 1])) ++i;
      names.insert(code.substr(start, i + 1 - start));
      expected = false;
    } else if (c == '[' || c == '(' || c == '{') {
      ++inner;
    } else if (c == ']' || c == ')' || c == '}') {
      --inner;
    } else if (c == ',' && inner == 0) {
      expected = true;
    }
  }
  return i;
}

void add_parameters(const std::string& code, std::set<std::string>& names) {
  const auto skip_spaces = [&](std::size_t i) {
    while (i < code.size() && is_space(code[i])) ++i;
    return i;
  };
  for (std::size_t i = 0; i < code.size();) {
    const std::size_t start = i;
    while (i < code.size() && is_word(code[i])) ++i;
    const std::string word = code.substr(start, i - start);
    if (word.empty()) {
      ++i;
      continue;
    }
    if (word != "Exists" && word != "DefineConstant") continue;
    const std::size_t bracket = skip_spaces(i);
    if (bracket == code.size() || (code[bracket] != '[' && code[bracket] != '(')) continue;
    i = bracket + 1;
    if (word == "DefineConstant") {
      i = add_listed(code, i, names);
      continue;
    }
    i = skip_spaces(i);
    std::size_t end = i;
    while (end < code.size() && is_word(code[end])) ++end;
    if (end > i && std::isdigit(static_cast<unsigned char>(code[i])) == 0)
      names.insert(code.substr(i, end - i));
  }
}

}  // namespace

std::set<std::string> parameters_of(const std::filesystem::path& geo) {
  std::set<std::string> names;
  std::set<std::filesystem::path> seen;
  std::vector<std::filesystem::path> files{geo};
  while (!files.empty()) {
    const std::filesystem::path file = std::move(files.back());
    files.pop_back();
    std::error_code ignored;
    if (!seen.insert(std::filesystem::weakly_canonical(file, ignored)).second) continue;
    const Code code = code_of(file);
    add_parameters(code.text, names);
    for (const std::string& included : code.includes) files.push_back(file.parent_path() / included);
  }
  return names;
}

void check_file(const scene::Body& body) {
  const std::string file = body.mesh.filename().string();
  check_kind(body.mesh);
  if (!std::filesystem::is_regular_file(body.mesh) || !std::ifstream(body.mesh))
    throw InputError(fmt::format("{}: no such file, or not readable: check bodies.{}.mesh = \"{}\"", file,
                                 body.name, body.mesh.string()));
  check_parameters(body);
}

std::vector<std::filesystem::path> msh_files(const scene::Body& body) {
  std::vector<std::filesystem::path> files = scene::part_files(body.mesh);
  for (const std::filesystem::path& part : files)
    if (const std::string version = msh_version(part); is_old_version(version))
      throw InputError(
          fmt::format("{}: is of version {}: save parts in version 4.1 (Mesh.MshFileVersion = 4.1)",
                      part.filename().string(), version));
  if (!files.empty() || body.mesh.extension() != ".msh") return files;
  check_file(body);
  if (!is_old_version(msh_version(body.mesh))) files.push_back(body.mesh);
  return files;
}

namespace {

/// The extent of all nodes of these files.
Extent extent_of_nodes(const std::vector<std::filesystem::path>& files, double scale) {
  constexpr double none = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{none, none, none}, high{-none, -none, -none};
  Extent extent{0, 0};
  for (const std::filesystem::path& file : files) {
    const MshOutline outline = outline_of(file);
    MshStream in(file);
    for (const MshNodes& block : outline.nodes)
      read_nodes(
          in, outline.binary, block, 0, block.tags.count, [](auto) {},
          [&](double x, double y, double z) {
            const std::array<double, 3> at{x, y, z};
            for (std::size_t c = 0; c < 3; ++c) {
              low[c] = std::min(low[c], at[c]);
              high[c] = std::max(high[c], at[c]);
            }
          });
    for (const MshElements& block : outline.elements)
      if (block.list.count > 0) extent.dimension = std::max(extent.dimension, block.entity.dim);
  }
  for (std::size_t c = 0; c < 3; ++c) extent.length = std::max(extent.length, scale * (high[c] - low[c]));
  return extent;
}

/// @return what was done to its faces, for the user; mostly empty
std::string open_file(const scene::Body& body) {
  check_file(body);
  if (body.mesh.extension() == ".msh") check_msh(body.mesh);
  if (body.geometry.empty())
    gmsh::open(body.mesh.string());
  else
    gmsh::open(Parameters(body).path());
  // A .geo says itself what it merges, and built-in geometry knows no tolerance.
  return is_drawing(body.mesh) && !body.mesh.extension().string().starts_with(".geo") ? sew_faces(body.mesh)
                                                                                      : "";
}

/// Asks gmsh for the small elements of a body while this object lives.
class LocalSizes {
 public:
  /// @param factor  by which gmsh multiplies all sizes
  LocalSizes(const scene::Body& body, double factor) : set_(!body.refine.empty()) {
    if (!set_) return;
    gmsh::model::mesh::setSizeCallback(
        // Later versions of gmsh (4.12) also pass the size without this function, and take what it returns.
        [balls = body.refine, scale = body.scale, factor](int, int, double x, double y, double z,
                                                          auto... otherwise) {
          double size = std::numeric_limits<double>::max();
          for (const scene::FineBall& ball : balls) {
            const double away =
                std::hypot(scale * x - ball.at[0], scale * y - ball.at[1], scale * z - ball.at[2]);
            size = std::min(size, ball.size_at(away));
          }
          return std::min({size / (scale * factor), otherwise...});
        });
  }
  LocalSizes(const LocalSizes&) = delete;
  LocalSizes& operator=(const LocalSizes&) = delete;
  ~LocalSizes() {
    if (set_) gmsh::model::mesh::removeSizeCallback();
  }

 private:
  bool set_;
};

}  // namespace

Extent extent_of(const scene::Body& body) {
  if (const auto files = msh_files(body); !files.empty()) return extent_of_nodes(files, body.scale);
  open_file(body);
  double low[3], high[3], longest = 0;
  gmsh::model::getBoundingBox(-1, -1, low[0], low[1], low[2], high[0], high[1], high[2]);
  for (int k = 0; k < 3; ++k) longest = std::max(longest, high[k] - low[k]);
  return {longest * body.scale, gmsh::model::getDimension()};
}

namespace {

/// Whether the file of the model is a mesh, and not a geometry.
bool is_meshed(const scene::Body& body) {
  return body.mesh.extension() == ".msh" || (body.mesh.extension() != ".geo" && holds_elements());
}

/// Meshes the entities of the model up to this dimension.
/// @param sewn  what was done to its faces; those that cross each other cannot be meshed
void mesh_model(const scene::Body& body, int dimension, const std::string& sewn) {
  refuse_points_for_lines(body.mesh.filename().string());
  double own = 1;  // of the file
  gmsh::option::getNumber("Mesh.MeshSizeFactor", own);
  if (body.size_factor != 1) gmsh::option::setNumber("Mesh.MeshSizeFactor", own * body.size_factor);
  const LocalSizes sizes(body, own * body.size_factor);
  try {
    gmsh::model::mesh::generate(dimension);
    gmsh::model::mesh::setOrder(body.order);
  } catch (...) {
    GmshSession::keep_broken_model();
    if (sewn.empty()) throw;
    throw InputError(gmsh_error(sewn, text_of_current_exception()).what() +
                     std::string(": its faces may cross each other: export the body as a solid, in .step"));
  }
}

}  // namespace

Opened open_model(const scene::Body& body) {
  Opened out{.sewn = open_file(body), .meshed_before = is_meshed(body)};
  if (out.meshed_before) return out;
  if (is_surface(body.mesh)) fill_surface(body.mesh.filename().string());
  mesh_model(body, gmsh::model::getDimension(), out.sewn);
  return out;
}

Opened open_surface(const scene::Body& body) {
  constexpr const char* curvature = "Mesh.MeshSizeFromCurvature";
  Opened out{.sewn = open_file(body), .meshed_before = is_meshed(body)};
  if (out.meshed_before) return out;
  double own = 0;  // of the file
  gmsh::option::getNumber(curvature, own);
  if (own == 0) gmsh::option::setNumber(curvature, triangles_around);
  mesh_model(body, 2, out.sewn);
  return out;
}

}  // namespace ricochet::mesh
