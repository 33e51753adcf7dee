// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/gmsh_session.hpp"

#include <gmsh.h>

namespace ricochet::mesh {

GmshSession::GmshSession() {
  std::string name = "gmsh", verbosity = "-v", none = "0";
  char* words[] = {name.data(), verbosity.data(), none.data()};
  gmsh::initialize(3, words, /*readConfigFiles=*/false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.NumThreads", 1);
}

GmshSession::~GmshSession() {
  gmsh::onelab::clear();  // definitions of a .geo would override the defaults of the next one
  gmsh::finalize();
}

void forget_meshes() { gmsh::clear(); }

}  // namespace ricochet::mesh
