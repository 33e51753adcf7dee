// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: what the versions of .msh have in common.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "src/mesh/groups.hpp"
#include "src/mesh/msh_stream.hpp"

namespace ricochet::mesh {

/// The version of a .msh file, such as "4.1"; empty if it cannot be read.
std::string msh_version(const std::filesystem::path& msh);
bool is_old_version(const std::string& version);  ///< 2 to 2.2

/// Reads the sections of an untrusted .msh file in their order. Classes for each version read the sections
/// whose content depends on it.
class MshSections {
 public:
  explicit MshSections(const std::filesystem::path& msh) : path_(msh), in_(msh) {}
  MshSections(const MshSections&) = delete;
  MshSections& operator=(const MshSections&) = delete;
  virtual ~MshSections() = default;

  /// Needs a GmshSession for the element types. Throws InputError "FILE: line N: what".
  void read();

 protected:
  struct ElementType {
    int dim = 0, nodes = 0;
  };
  static constexpr std::int64_t largest_int = 2147483647, largest_tag = std::int64_t{1} << 40;

  /// Reads the numbers of a section. @return whether the section may be in a mesh
  virtual bool section(const std::string& name) = 0;

  /// These functions read integers of the types that the format prescribes.
  std::int64_t count(const char* what) { return in_.integer<std::uint64_t>(what, 0, largest_tag); }
  int number(const char* what, std::int64_t low, std::int64_t high) {
    return static_cast<int>(in_.integer<std::int32_t>(what, low, high));
  }
  int entity(const char* what) { return number(what, 0, largest_int); }
  /// Reads a count that stands on a line of its own.
  std::int64_t line_count(const char* what);
  void coordinates();

  /// Throws InputError unless gmsh knows the type, and all its nodes or only those on edges are Lagrange
  /// nodes.
  ElementType type_of(int type) const;

  std::filesystem::path path_;
  MshStream in_;
  bool binary_ = false;
  std::map<EntityKey, std::string> names_;  ///< of physical groups, by their numbers

 private:
  void format();
  void end(const std::string& name);
  void comments();
  void names();

  std::set<std::string> seen_;
};

}  // namespace ricochet::mesh
