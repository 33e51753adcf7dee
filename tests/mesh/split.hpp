// SPDX-License-Identifier: BSD-2-Clause
// Meshes in one file and in several files, in a folder that all ranks use.
#pragma once

#include <gmsh.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "src/mesh/gmsh_session.hpp"
#include "src/parallel/parallel.hpp"

namespace ricochet::test {

inline int me() { return parallel::rank_of(PETSC_COMM_WORLD); }

/// A folder that one rank creates and all ranks use. It is removed at the end of the scope.
class SharedFolder {
 public:
  SharedFolder() {
    std::string name;
    if (me() == 0) {
      name = (std::filesystem::temp_directory_path() / "ricochet-parts-XXXXXX").string();
      EXPECT_NE(mkdtemp(name.data()), nullptr);
    }
    parallel::broadcast(PETSC_COMM_WORLD, name);
    path_ = name;
  }
  ~SharedFolder() {
    MPI_Barrier(PETSC_COMM_WORLD);
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  /// Runs `task` on one rank, between two barriers.
  template <class Task>
  void once(Task&& task) const {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (me() == 0) task();
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  void write(const std::string& name, const std::string& text) const {
    once([&] { std::ofstream(path_ / name) << text; });
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Writes the mesh to whole.msh, and again as `parts` files: split_1.msh and so on, or as the one
/// file split.msh if there are none.
inline void write_both(const SharedFolder& folder, const std::string& geo, int order, int parts,
                       bool binary = false) {
  folder.write("body.geo", geo);
  folder.once([&] {
    const mesh::GmshSession gmsh;
    gmsh::open((folder / "body.geo").string());
    gmsh::model::mesh::generate(3);
    gmsh::model::mesh::setOrder(order);
    gmsh::option::setNumber("Mesh.Binary", binary ? 1 : 0);  // text rounds coordinates
    gmsh::write((folder / "whole.msh").string());
    if (parts > 1) {
      gmsh::model::mesh::partition(parts);
      gmsh::option::setNumber("Mesh.PartitionSplitMeshFiles", 1);
    }
    gmsh::write((folder / (parts == 1 ? "split_1.msh" : "split.msh")).string());
  });
}

}  // namespace ricochet::test
