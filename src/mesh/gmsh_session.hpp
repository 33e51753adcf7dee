// SPDX-License-Identifier: BSD-2-Clause
// A scope in which gmsh is initialised, and the conversion of its errors to InputError.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

/// Initialises gmsh until the end of the scope. A process may have only one session at a time.
///
/// gmsh 4.8 crashes when it deletes a model of which it could not make the mesh. After `keep_broken_model`,
/// gmsh therefore stays initialised until the process ends; later sessions use further models.
class GmshSession {
 public:
  GmshSession();
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;
  static void keep_broken_model();
};

/// Frees the meshes that gmsh has read so far. Shape functions do not need them. Needs a GmshSession.
void forget_meshes();

/// Returns an error with `message` on one line, or with a remedy if gmsh says no more than that it could not
/// read.
inline InputError gmsh_error(const std::string& where, std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  message.erase(message.find_last_not_of(' ') + 1);
  if (message.starts_with("Could not read file"))
    return InputError(where + ": gmsh cannot read it: it is damaged, or of another kind: export it again");
  return InputError(where + ": gmsh: " + message);
}

/// Describes the exception that is being handled, of any type.
std::string text_of_current_exception();

/// Calls `task` and converts any exception of gmsh to an InputError "`where`: gmsh: message". Besides
/// std::exception, gmsh throws strings and numbers, and its reader of drawings throws classes of its own.
template <class Task>
void with_gmsh_errors(const std::string& where, Task&& task) {
  try {
    task();
  } catch (const InputError&) {
    throw;
  } catch (...) {
    throw gmsh_error(where, text_of_current_exception());
  }
}

}  // namespace ricochet::mesh
