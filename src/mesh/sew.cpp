// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/sew.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

namespace {

/// Tolerances that are tried, as shares of the drawing; ricochet surfaces numbers faces by the same ones.
constexpr double tolerances[] = {1e-9, 1e-7, 1e-6, 1e-5};

/// An option of gmsh, with its former value again at the end of the scope.
class Option {
 public:
  Option(const char* name, double value) : name_(name) {
    gmsh::option::getNumber(name_, before_);
    gmsh::option::setNumber(name_, value);
  }
  Option(const Option&) = delete;
  Option& operator=(const Option&) = delete;
  ~Option() { gmsh::option::setNumber(name_, before_); }

 private:
  const char* name_;
  double before_ = 0;
};

std::size_t entities(int dim) {
  gmsh::vectorpair found;
  gmsh::model::getEntities(found, dim);
  return found.size();
}

double diagonal() {
  double low[3], high[3];
  gmsh::model::getBoundingBox(-1, -1, low[0], low[1], low[2], high[0], high[1], high[2]);
  return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

/// Edges of one face alone. The seam of a cylinder occurs twice in the boundary of its face.
std::size_t free_edges() {
  gmsh::vectorpair faces, edges;
  gmsh::model::getEntities(faces, 2);
  std::map<int, int> uses;
  for (const auto& face : faces) {
    gmsh::model::getBoundary({face}, edges, /*combined=*/false, /*oriented=*/false);
    for (const auto& [dim, edge] : edges) ++uses[std::abs(edge)];
  }
  std::size_t count = 0;
  for (const auto& [edge, times] : uses) count += times == 1 ? 1 : 0;
  return count;
}

/// Faces that bound no volume.
std::size_t loose_faces() {
  gmsh::vectorpair faces;
  gmsh::model::getEntities(faces, 2);
  std::size_t count = 0;
  for (const auto& [dim, face] : faces) {
    std::vector<int> volumes, curves;
    gmsh::model::getAdjacencies(dim, face, volumes, curves);
    count += volumes.empty() ? 1 : 0;
  }
  return count;
}

}  // namespace

std::string sew_faces(const std::filesystem::path& drawing) {
  const std::size_t faces = entities(2);
  if (faces == 0 || entities(3) > 0) return "";
  const std::string file = drawing.filename().string();
  const double size = diagonal();
  const Option sews("Geometry.OCCSewFaces", 1), makes_solids("Geometry.OCCMakeSolids", 1);
  for (const double tolerance : tolerances) {
    const Option within("Geometry.Tolerance", tolerance * size);
    gmsh::model::remove();
    gmsh::open(drawing.string());
    if (entities(3) == 0) continue;
    std::string note = fmt::format(
        "{}: its {} loose faces were sewn into {} with a tolerance of {:.2g} in its units", file, faces,
        entities(3) == 1 ? "a solid" : fmt::format("{} solids", entities(3)), tolerance * size);
    if (const std::size_t loose = loose_faces(); loose > 0)
      note += fmt::format("; {} faces bound none of them and are left out", loose);
    return note;
  }
  throw InputError(fmt::format(
      "{}: has faces but no solid, and {} edges of its {} faces stay free if faces are sewn with a "
      "tolerance of {:.2g} in its units: export the body as a solid, in .step",
      file, free_edges(), faces, tolerances[std::size(tolerances) - 1] * size));
}

}  // namespace ricochet::mesh
