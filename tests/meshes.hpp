// SPDX-License-Identifier: BSD-2-Clause
// Small geometries for the collective tests, and functions that mesh and distribute them.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/mesh.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/parts.hpp"
#include "src/mesh/read.hpp"
#include "src/parallel/teams.hpp"

namespace ricochet::test {

/// Truncated pyramid of the elements `kind` ("tet", "hex" or "prism"): a unit square at z = 0, with sides
/// that lean inwards by `lean` at z = 1. With lean = 0 it is the unit cube.
inline std::string block_geo(const std::string& kind, int divisions, double lean) {
  std::string text = "SetFactory(\"Built-in\");\n";
  const double h = 1.0 / divisions, s = 0.5 * lean;
  const double corner[8][3] = {{0, 0, 0}, {1, 0, 0},     {1, 1, 0},         {0, 1, 0},
                               {s, s, 1}, {1 - s, s, 1}, {1 - s, 1 - s, 1}, {s, 1 - s, 1}};
  for (int i = 0; i < 8; ++i)
    text +=
        fmt::format("Point({}) = {{{}, {}, {}, {}}};\n", i + 1, corner[i][0], corner[i][1], corner[i][2], h);
  const int edge[12][2] = {{1, 2}, {2, 3}, {3, 4}, {4, 1}, {5, 6}, {6, 7},
                           {7, 8}, {8, 5}, {1, 5}, {2, 6}, {3, 7}, {4, 8}};
  for (int i = 0; i < 12; ++i) text += fmt::format("Line({}) = {{{}, {}}};\n", i + 1, edge[i][0], edge[i][1]);
  text +=
      "Curve Loop(1) = {-4, -3, -2, -1};\nCurve Loop(2) = {5, 6, 7, 8};\nCurve Loop(3) = {1, 10, -5, -9};\n"
      "Curve Loop(4) = {2, 11, -6, -10};\nCurve Loop(5) = {3, 12, -7, -11};\nCurve Loop(6) = {4, 9, -8, "
      "-12};\n"
      "For i In {1:6}\nPlane Surface(i) = {i};\nEndFor\nSurface Loop(1) = {1:6};\nVolume(1) = {1};\n";
  if (kind != "tet") {
    text += fmt::format("Transfinite Curve{{1:12}} = {};\nTransfinite Surface{{1:6}};\n", divisions + 1);
    text += kind == "hex" ? "Recombine Surface{1:6};\n" : "Recombine Surface{3:6};\n";
    text += "Transfinite Volume{1} = {1, 2, 3, 4, 5, 6, 7, 8};\n";
    if (kind == "prism") text += "TransfQuadTri {1};\n";
  }
  return text +
         "Physical Volume(\"body\") = {1};\nPhysical Surface(\"bottom\") = {1};\nPhysical Surface(\"top\") = "
         "{2};\n"
         "Physical Surface(\"sides\") = {3:6};\n";
}

/// A triangulated square, extruded in layers of prisms.
inline std::string prism_geo(int divisions) {
  const double h = 1.0 / divisions;
  return fmt::format(
      "SetFactory(\"Built-in\");\nPoint(1) = {{0,0,0,{0}}};\nPoint(2) = {{1,0,0,{0}}};\nPoint(3) = "
      "{{1,1,0,{0}}};\nPoint(4) = {{0,1,0,{0}}};\n"
      "Line(1) = {{1,2}};\nLine(2) = {{2,3}};\nLine(3) = {{3,4}};\nLine(4) = {{4,1}};\nCurve Loop(1) = "
      "{{1,2,3,4}};\nPlane Surface(1) = {{1}};\n"
      "b[] = Extrude {{0, 0, 1}} {{ Surface{{1}}; Layers{{{1}}}; Recombine; }};\nPhysical Volume(\"body\") = "
      "{{b[1]}};\n"
      "Physical Surface(\"bottom\") = {{1}};\nPhysical Surface(\"top\") = {{b[0]}};\nPhysical "
      "Surface(\"sides\") = {{b[2], b[3], b[4], b[5]}};\n",
      h, divisions);
}

/// A rod of length 2 along x with named ends.
inline std::string rod_geo(int elements) {
  return fmt::format(
      "Point(1) = {{0,0,0}};\nPoint(2) = {{2,0,0}};\nLine(1) = {{1,2}};\nTransfinite Curve{{1}} = {};\n"
      "Physical Curve(\"rod\") = {{1}};\nPhysical Point(\"left\") = {{1}};\nPhysical Point(\"right\") = "
      "{{2}};\n",
      elements + 1);
}

/// A file that one rank writes and all ranks read. It is removed at the end of the scope.
class SharedFile {
 public:
  SharedFile(const std::string& extension, const std::string& text) {
    std::string name;
    if (parallel::rank_of(PETSC_COMM_WORLD) == 0) {
      static int number = 0;
      name = (std::filesystem::temp_directory_path() /
              fmt::format("ricochet-{}-{}{}", getpid(), number++, extension))
                 .string();
      std::ofstream(name) << text;
    }
    parallel::broadcast(PETSC_COMM_WORLD, name);
    path_ = name;
  }
  ~SharedFile() {
    MPI_Barrier(PETSC_COMM_WORLD);
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline scene::Body body_of(const std::filesystem::path& mesh, int order) {
  scene::Body body;
  body.name = "body";
  body.mesh = mesh;
  body.order = order;
  body.materials = {{.group = "", .density = 2.0, .young = 3.0, .poisson = 0.3, .area = 0.5}};
  return body;
}

/// All ranks as one team.
inline const parallel::Teams& one_team() {
  // Never destroyed, because that would happen after MPI ends.
  static const auto* teams = new parallel::Teams(PETSC_COMM_WORLD, 1);
  return *teams;
}

/// A team for each rank.
inline const parallel::Teams& own_teams() {
  static const auto* teams = new parallel::Teams(PETSC_COMM_WORLD, parallel::size_of(PETSC_COMM_WORLD));
  return *teams;
}

/// Reads a mesh and distributes it over the ranks of each team, as the program does. Requires a GmshSession.
inline mesh::Mesh mesh_of(const scene::Body& body, const parallel::Teams& teams = one_team()) {
  if (const auto files = mesh::open_msh(body, PETSC_COMM_WORLD))
    return mesh::read_msh(*files, body, teams.team(), teams.peers());
  mesh::GlobalMesh global;
  parallel::on_first_rank(PETSC_COMM_WORLD, [&] { global = mesh::read_mesh(body); });
  if (parallel::rank_of(teams.team()) == 0) mesh::broadcast(global, teams.peers());
  return mesh::distribute(std::move(global), teams.team(), teams.peers());
}

}  // namespace ricochet::test
