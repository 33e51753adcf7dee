#include "src/mesh/open.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmsh.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <regex>
#include <sstream>

#include "kernels/error.hpp"

namespace ricochet::mesh {

namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Text of a .geo without comments and strings, its Includes in their place. `depth` ends a circle of them.
std::string code_of(const std::filesystem::path& geo, int depth = 0) {
  std::ostringstream stream;
  stream << std::ifstream(geo, std::ios::binary).rdbuf();
  const std::string text = stream.str();
  std::string code;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size());
      code += '\n';
    } else if (text.compare(i, 2, "/*") == 0) {
      i = std::min(text.find("*/", i + 2), text.size() - 2) + 1;
      code += ' ';
    } else if (text[i] == '"') {
      const std::size_t end = std::min(text.find('"', i + 1), text.size());
      static const std::regex include("\\bInclude\\s*$");
      if (depth < 16 && std::regex_search(code, include))
        code += code_of(geo.parent_path() / text.substr(i + 1, end - i - 1), depth + 1);
      code += ' ';
      i = end;
    } else {
      code += text[i];
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

/// A file that sets the parameters of a body's .geo and then reads it; gone with the scope. Parameters on
/// gmsh's own command line (-setnumber) would hold for all bodies to come.
class Parameters {
 public:
  explicit Parameters(const scene::Body& body) {
    std::string name = (std::filesystem::temp_directory_path() / "ricochet-XXXXXX.geo").string();
    const int handle = mkstemps(name.data(), 4);
    path_ = name;
    std::string text;
    for (const auto& [parameter, value] : body.geometry) text += fmt::format("{} = {};\n", parameter, value);
    text += fmt::format("Merge \"{}\";\n", std::filesystem::absolute(body.mesh).string());
    const bool written = handle >= 0 && write(handle, text.data(), text.size()) == std::ssize(text);
    if (handle >= 0) close(handle);
    if (!written) {
      std::remove(name.c_str());
      throw InputError(fmt::format("{}: can't be written: make room there, or set TMPDIR", name));
    }
  }
  Parameters(const Parameters&) = delete;
  Parameters& operator=(const Parameters&) = delete;
  ~Parameters() { std::remove(path_.c_str()); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// gmsh takes what it can from a file that ends early, and says so only of some.
void check_whole(const std::filesystem::path& msh) {
  std::ifstream stream(msh, std::ios::binary);
  const bool starts = stream.get() == '$';
  std::string tail;
  if (starts) {
    stream.seekg(0, std::ios::end);
    const std::streamoff size = stream.tellg(), length = std::min<std::streamoff>(size, 256);
    tail.resize(static_cast<std::size_t>(length));
    stream.seekg(size - length);
    stream.read(tail.data(), length);
    while (!tail.empty() && std::isspace(static_cast<unsigned char>(tail.back())) != 0) tail.pop_back();
    tail.erase(0, tail.find_last_of('\n') + 1);
  }
  const std::string file = msh.filename().string();
  if (!starts)
    throw InputError(
        fmt::format("{}: is not a gmsh mesh (it does not start with $MeshFormat): write it with gmsh, or "
                    "name another file",
                    file));
  if (tail.rfind("$E", 0) != 0)
    throw InputError(fmt::format(
        "{}: is cut off (its last line is not $EndElements or another end): write it again with gmsh", file));
}

bool holds_elements() {
  for (int dim : {3, 1}) {
    std::vector<int> types;
    gmsh::model::mesh::getElementTypes(types, dim);
    if (!types.empty()) return true;
  }
  return false;
}

/// gmsh 4.8 throws from a thread of its own, which ends the program, where a line has no length.
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

}  // namespace

std::set<std::string> parameters_of(const std::filesystem::path& geo) {
  const std::string code = code_of(geo);
  std::set<std::string> names;
  static const std::regex exists(R"(\bExists\s*[\[(]\s*([A-Za-z_]\w*))"), list(R"(\bDefineConstant\s*[\[(])");
  for (std::sregex_iterator it(code.begin(), code.end(), exists), end; it != end; ++it)
    names.insert((*it)[1].str());
  for (std::sregex_iterator it(code.begin(), code.end(), list), end; it != end; ++it) {
    // A name stands at the start and after each comma that no inner bracket holds.
    int inner = 0;
    bool expected = true;
    for (auto i = static_cast<std::size_t>(it->position() + it->length()); i < code.size() && inner >= 0;
         ++i) {
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
  }
  return names;
}

namespace {

void open_file(const scene::Body& body) {
  const std::string file = body.mesh.filename().string();
  if (!std::filesystem::is_regular_file(body.mesh) || !std::ifstream(body.mesh))
    throw InputError(fmt::format("{}: no such file, or not readable: check bodies.{}.mesh = \"{}\"", file,
                                 body.name, body.mesh.string()));
  check_parameters(body);
  if (body.mesh.extension() == ".msh") check_whole(body.mesh);
  if (body.geometry.empty())
    gmsh::open(body.mesh.string());
  else
    gmsh::open(Parameters(body).path());
}

}  // namespace

Extent extent_of(const scene::Body& body) {
  open_file(body);
  double low[3], high[3], longest = 0;
  gmsh::model::getBoundingBox(-1, -1, low[0], low[1], low[2], high[0], high[1], high[2]);
  for (int k = 0; k < 3; ++k) longest = std::max(longest, high[k] - low[k]);
  return {longest * body.scale, gmsh::model::getDimension()};
}

bool open_model(const scene::Body& body) {
  open_file(body);
  if (body.mesh.extension() == ".msh" || (body.mesh.extension() != ".geo" && holds_elements())) return true;
  refuse_points_for_lines(body.mesh.filename().string());
  gmsh::model::mesh::generate(gmsh::model::getDimension());
  gmsh::model::mesh::setOrder(body.order);
  return false;
}

}  // namespace ricochet::mesh
