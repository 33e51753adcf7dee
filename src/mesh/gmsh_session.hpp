// SPDX-License-Identifier: BSD-2-Clause
// The gmsh library as a scope, and its errors as ours.
#pragma once

#include <algorithm>
#include <cctype>
#include <exception>
#include <string>

#include "ricochet/error.hpp"

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

/// `message` in one line.
inline InputError gmsh_error(const std::string& where, std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return InputError(where + ": gmsh: " + message);
}

/// Calls `task`, turning whatever gmsh throws into an InputError "`where`: gmsh: message".
template <class Task>
void with_gmsh_errors(const std::string& where, Task&& task) {
  try {
    task();
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw gmsh_error(where, error.what());
  } catch (const std::string& message) {
    throw gmsh_error(where, message);
  } catch (int code) {
    throw gmsh_error(where, "error " + std::to_string(code));
  }
}

}  // namespace ricochet::mesh
