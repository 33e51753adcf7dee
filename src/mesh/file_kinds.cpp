// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/file_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

namespace {

// Kinds that gmsh 4.8 of Debian reads.
constexpr std::array drawings{".geo", ".geo_unrolled", ".step", ".stp", ".brep", ".iges", ".igs"};
constexpr std::array meshes{".msh", ".stl", ".unv", ".mesh", ".bdf", ".nas", ".vtk"};

constexpr const char* by_meshio = "convert it to .msh, for example with meshio";
constexpr const char* by_export = "export it from there as .step";
constexpr const char* surface_only =
    "it holds a surface: fill it with volume elements in gmsh, and name the .msh";

struct Foreign {
  std::string_view ending;
  const char *software, *advice;
};
constexpr Foreign others[] = {
    {".inp", "a mesh of Abaqus or CalculiX", by_meshio},
    {".med", "a mesh of Salome or code_aster", by_meshio},
    {".mmed", "a mesh of Salome or code_aster", by_meshio},
    {".vtu", "a mesh of ParaView", by_meshio},
    {".pvtu", "a mesh of ParaView", by_meshio},
    {".cgns", "a mesh of a flow solver (CGNS)", by_meshio},
    {".xml", "a mesh of FEniCS, or other XML", by_meshio},
    {".xdmf", "a mesh of FEniCS or ParaView", by_meshio},
    {".e", "a mesh of Cubit or Sierra (Exodus)", by_meshio},
    {".exo", "a mesh of Cubit or Sierra (Exodus)", by_meshio},
    {".ex2", "a mesh of Cubit or Sierra (Exodus)", by_meshio},
    {".f3grid", "a mesh of FLAC3D", by_meshio},
    {".avs", "a mesh of AVS", by_meshio},
    {".su2", "a mesh of SU2", by_meshio},
    {".node", "a mesh of TetGen", by_meshio},
    {".ele", "a mesh of TetGen", by_meshio},
    {".vol", "a mesh of Netgen", "export it from there as Gmsh2 Format, .msh"},
    {".fem", "a deck of OptiStruct", "export it from there as Nastran, .bdf"},
    {".k", "a deck of LS-DYNA", by_meshio},
    {".key", "a deck of LS-DYNA", by_meshio},
    {".cdb", "a mesh of Ansys", "export it from there as Nastran, .bdf"},
    {".ply", "a surface of a scanner or MeshLab", surface_only},
    {".obj", "a surface of Blender or a scanner", surface_only},
    {".off", "a surface of Geomview", surface_only},
    {".3mf", "a surface for 3-D printers", surface_only},
    {".wrl", "a surface of VRML", surface_only},
    {".diff", "a mesh of Diffpack", by_meshio},
    {".p3d", "a grid of Plot3D", by_meshio},
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

void check_kind(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  if (is_drawing(file) || std::ranges::count(meshes, ending) > 0) return;
  const std::string name = file.filename().string();
  const auto* const other = std::ranges::find(others, ending, &Foreign::ending);
  if (other != std::end(others))
    throw InputError(
        fmt::format("{}: is {}, which gmsh does not read: {}", name, other->software, other->advice));
  throw InputError(
      fmt::format("{}: \"{}\" is no kind of mesh or drawing that gmsh reads: name a .geo, .msh, .step, "
                  ".brep, .iges, .unv, .mesh, .bdf or .vtk",
                  name, ending));
}

}  // namespace ricochet::mesh
