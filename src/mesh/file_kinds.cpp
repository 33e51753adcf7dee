// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/file_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "ricochet/error.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::mesh {

namespace {

// Kinds that gmsh 4.8 of Debian reads.
constexpr std::array drawings{".geo", ".geo_unrolled", ".step", ".stp", ".brep", ".iges", ".igs"};
constexpr std::array meshes{".msh", ".stl", ".unv", ".mesh", ".vtk"};

constexpr const char* by_other_kind =
    "export it from there as .vtu, .med or .bdf, and run ricochet import mesh on that";
constexpr const char* by_export = "export it from there as .step";
constexpr const char* surface_only =
    "it holds a surface: save it from there as .stl, of which gmsh meshes the inside";

struct Foreign {
  std::string_view ending;
  const char *software, *advice;
};
constexpr Foreign others[] = {
    {".pvtu", "a mesh of ParaView", "save it from there as one .vtu, and run ricochet import mesh on it"},
    {".k", "a deck of LS-DYNA", by_other_kind},
    {".key", "a deck of LS-DYNA", by_other_kind},
    {".cdb", "a mesh of Ansys", "export it from there as Nastran, .bdf"},
    {".ply", "a surface of a scanner or MeshLab", surface_only},
    {".obj", "a surface of Blender or a scanner", surface_only},
    {".off", "a surface of Geomview", surface_only},
    {".3mf", "a surface for 3-D printers", surface_only},
    {".wrl", "a surface of VRML", surface_only},
    {".diff", "a mesh of Diffpack", by_other_kind},
    {".p3d", "a grid of Plot3D", by_other_kind},
    {".pos", "a result of gmsh", "name the .msh that it was computed on"},
    {".fcstd", "a drawing of FreeCAD", by_export},
    {".scad", "a drawing of OpenSCAD", "write it in gmsh's own language, .geo"},
    {".sldprt", "a drawing of SolidWorks", by_export},
    {".f3d", "a drawing of Fusion", by_export},
    {".ipt", "a drawing of Inventor", by_export},
    {".prt", "a drawing of NX or Creo", by_export},
    {".catpart", "a drawing of CATIA", by_export},
    {".3dm", "a drawing of Rhino", by_export},
    {".x_t", "a drawing of Parasolid", by_export},
    {".x_b", "a drawing of Parasolid", by_export},
    {".sat", "a drawing of ACIS", by_export},
    {".dwg", "a drawing of AutoCAD", by_export},
    {".dxf", "a drawing of AutoCAD", by_export},
};

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

}  // namespace

bool is_drawing(const std::filesystem::path& file) {
  return std::ranges::count(drawings, ending_of(file)) > 0;
}

bool is_surface(const std::filesystem::path& file) { return ending_of(file) == ".stl"; }

void check_kind(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  if (is_drawing(file) || std::ranges::count(meshes, ending) > 0) return;
  const std::string name = file.filename().string();
  const auto* const other = std::ranges::find(others, ending, &Foreign::ending);
  if (other != std::end(others))
    throw InputError(
        fmt::format("{}: is {}, which gmsh does not read: {}", name, other->software, other->advice));
  if (scene::is_foreign_mesh(file))
    throw InputError(
        fmt::format("{}: is a mesh of another program, which gmsh does not read: run ricochet import "
                    "mesh {}, and name the .msh that it writes",
                    name, file.string()));
  throw InputError(
      fmt::format("{}: \"{}\" is no kind of mesh or drawing that gmsh reads: name a .geo, .msh, .step, "
                  ".brep, .iges, .stl, .unv, .mesh, .vtk, .inp, .bdf or .med",
                  name, ending));
}

}  // namespace ricochet::mesh
