// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/gmsh_session.hpp"

#include <gmsh.h>

namespace ricochet::mesh {

namespace {

bool has_broken_model = false;

}  // namespace

GmshSession::GmshSession() {
  if (has_broken_model) {
    gmsh::model::add("");
    gmsh::option::setNumber("Mesh.MeshSizeFactor", 1);  // the only option of open_model
    return;
  }
  std::string name = "gmsh", verbosity = "-v", none = "0";
  char* words[] = {name.data(), verbosity.data(), none.data()};
  gmsh::initialize(3, words, /*readConfigFiles=*/false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.NumThreads", 1);
}

GmshSession::~GmshSession() {
  gmsh::onelab::clear();  // definitions of a .geo would override the defaults of the next one
  if (!has_broken_model) gmsh::finalize();
}

void GmshSession::keep_broken_model() { has_broken_model = true; }

void forget_meshes() { has_broken_model ? gmsh::model::remove() : gmsh::clear(); }

}  // namespace ricochet::mesh
