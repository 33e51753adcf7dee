// SPDX-License-Identifier: BSD-2-Clause
// XDMF files: short texts that describe the HDF5 file beside them to ParaView and other viewers.
//
//   xdmf::File file(path, "two-disks.motion.h5");
//   file.begin("upper");                      // a grid that moves …
//   for (…) file.add(grid, time);             // … and its frames
//   file.end();
//   file.commit();                            // now path exists
//
// Each frame has datasets of its own because ParaView's readers fail on parts of a dataset.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "base/atomic_file.hpp"

namespace ricochet::base::xdmf {

/// A dataset of floating-point numbers, (nodes) or (nodes, 3).
struct Field {
  std::string name;     ///< shown to the user
  std::string dataset;  ///< in the HDF5 file
  bool vector = false;
  int bytes = 4;  ///< per number
};

struct Grid {
  std::string name;
  int corners = 3;  ///< per element: 1 for points, 2 for segments, 3 for triangles
  std::size_t elements = 0, nodes = 0;
  std::string element;  ///< dataset (elements, corners), 64-bit integers
  Field position{};     ///< vector [m]
  std::vector<Field> fields{};
};

class File {
 public:
  /// @param data  name of the HDF5 file, in the same folder
  /// The file has a temporary name until `commit`; if it is destroyed earlier, nothing remains.
  File(const std::filesystem::path& path, std::string data);
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void begin(const std::string& name);
  /// Adds a frame to the open grid or, if no time is given, a grid that does not move.
  void add(const Grid& grid, std::optional<double> time = {});
  void end();

  /// Completes the text, syncs it to disk and renames the file. No member may be called afterwards. Throws
  /// InputError on failure; the final path then still holds the previous file, if there was one.
  void commit();

 private:
  std::string item(const std::string& dataset, const std::string& shape, const char* type, int bytes) const;

  AtomicFile temporary_;
  std::string data_;
  std::ofstream text_;
};

}  // namespace ricochet::base::xdmf
