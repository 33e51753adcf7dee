// The gmsh library as a scope, and its errors as ours.
#pragma once

#include <string>

namespace ricochet::mesh {

/// gmsh from here to the end of the scope; one at a time in a process.
class GmshSession {
 public:
  GmshSession();
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;
};

/// Frees what gmsh holds of the meshes read so far; shape functions and quadrature need none. Needs a
/// GmshSession.
void forget_meshes();

/// Calls `task`, turning whatever gmsh throws into an InputError "`where`: gmsh: message".
template <class Task>
void with_gmsh_errors(const std::string& where, Task&& task);

}  // namespace ricochet::mesh

#include "src/mesh/gmsh_errors.hpp"
