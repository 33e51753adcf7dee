// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

#include "base/hdf5_reader.hpp"
#include "kernels/format.hpp"

namespace ricochet::kernels {

namespace hdf5 = base::hdf5;
namespace {

constexpr const char* kAdvice = "Compute it again with ricochet-kernel.";

/// Whether the file is marked as a kernel; its version is checked separately.
bool is_kernel(const hdf5::Reader& file) {
  return file.has_attribute("/", "format") && file.string_attribute("/", "format") == kFormat;
}

void check_version(const hdf5::Reader& file) {
  if (!is_kernel(file)) file.fail("is not a Ricochet kernel (no attribute format = \"ricochet-kernel\").");
  const std::int64_t version = file.integer_attribute("/", "version");
  if (version > kVersion)
    file.fail(
        fmt::format("has format version {}, but this program reads versions up to {}. Use a newer Ricochet.",
                    version, kVersion));
  if (version < 1) file.fail(fmt::format("has format version {}, which never existed.", version));
}

/// Reads the data that list_kernel lists.
class KernelReader {
 public:
  explicit KernelReader(const hdf5::Reader& file) : file_(file) {}

  void group(const std::string&) {}
  void attribute(const std::string& object, const char* name, std::string& value) {
    value = file_.string_attribute(object, name);
  }
  void attribute(const std::string& object, const char* name, double& value) {
    value = file_.double_attribute(object, name);
  }
  void attribute(const std::string& object, const char* name, Vector3& value) {
    std::ranges::copy(file_.doubles_attribute(object, name, value.size()), value.begin());
  }
  /// Integers, and flags, which are 0 or 1.
  template <std::integral T>
  void attribute(const std::string& object, const char* name, T& value) {
    using Limits = std::numeric_limits<T>;
    const std::int64_t number = file_.integer_attribute(object, name);
    if (number < Limits::min() || number > Limits::max())
      file_.fail(fmt::format("attribute \"{}\" of \"{}\" is {}, not from {:d} to {:d}.", name, object, number,
                             Limits::min(), Limits::max()));
    value = static_cast<T>(number);
  }
  void constant(const std::string&, const char*, const char*) {}
  void optional_attribute(const std::string& object, const char* name, auto& value) {
    if (file_.has_attribute(object, name)) attribute(object, name, value);
  }
  std::size_t rows(const std::string& name, const auto&, std::size_t) {
    if (!file_.exists(name)) return 0;
    const Shape shape = file_.shape(name);
    return shape.empty() ? 0 : shape.front();
  }
  template <hdf5::Element T>
  void dataset(const std::string& name, std::vector<T>& values, const Shape& shape, const std::string&) {
    values = file_.read<T>(name, shape);
  }
  template <std::size_t count>
  void dataset(const std::string& name, std::array<double, count>& values, const Shape& shape,
               const std::string&) {
    std::ranges::copy(file_.read<double>(name, shape), values.begin());
  }
  void optional_dataset(const std::string& name, auto& values, const Shape& shape, const std::string& unit) {
    if (file_.exists(name)) dataset(name, values, shape, unit);
  }
  void strings(const std::string& name, std::vector<std::string>& values, std::size_t length) {
    values = file_.read_strings(name, length);
  }
  void elements(const std::string& name, std::vector<std::int64_t>& element, int& corners, int, std::size_t) {
    element = file_.read<std::int64_t>(name, {hdf5::any, hdf5::any});
    corners = static_cast<int>(std::min<std::size_t>(file_.shape(name)[1], 4));  // validate refuses 4
  }
  void choose(const std::string& group, auto& value) {
    if (file_.exists(group)) value.emplace();
  }
  /// The names become names of datasets and are therefore checked first.
  void names(const std::string& kind, auto& items) {
    const std::string list = "/names/" + kind;
    if (!file_.exists(list)) return;
    for (const std::string& name : file_.read_strings(list, rows(list, items, 1))) {
      if (!is_free_name(name)) file_.fail(fmt::format("dataset \"{}\" contains an invalid name.", list));
      items.emplace_back().name = name;
    }
  }

 private:
  const hdf5::Reader& file_;
};

/// Whether a dataset has an attribute, whose only value is `expected`.
bool has_constant(const hdf5::Reader& file, const std::string& name, const char* attribute,
                  const char* expected) {
  if (!file.exists(name) || !file.has_attribute(name, attribute)) return false;
  if (file.string_attribute(name, attribute) != expected)
    file.fail(fmt::format("attribute \"{}\" of \"{}\" is not \"{}\".", attribute, name, expected));
  return true;
}

/// Whether the static correction is stored along the normals alone.
bool has_normal_residual(const hdf5::Reader& file) {
  return has_constant(file, "/surface/residual_flexibility", kComponents, kNormal);
}

void check_certificate(const hdf5::Reader& file, const Modes& modes) {
  // Of Ritz vectors that earlier versions computed from a lower element order, with unbounded residuals.
  if (file.has_attribute("/modes/certificate", "approximate")) file.fail("its modes are not certified.");
  const Certificate& certificate = modes.certificate;
  if (!certificate.complete && !modes.imported())
    file.fail(fmt::format("its certificate is not complete ({} modes found, {} proved).",
                          certificate.count_found, certificate.count_by_inertia));
  if (certificate.count_found < 0 || certificate.left_out < 0)
    file.fail("its certificate contains a negative count.");
  const std::int64_t kept = certificate.count_found - certificate.left_out;
  if (kept < 0 || static_cast<std::uint64_t>(kept) != modes.size())
    file.fail(fmt::format("its certificate is for {} modes, but \"/modes/angular_frequency\" has {}.", kept,
                          modes.size()));
  if (certificate.shift.size() != certificate.modes_below.size())
    file.fail("\"/modes/certificate/shift\" and \"/modes/certificate/modes_below\" differ in length.");
  for (std::size_t s = 0; certificate.left_out == 0 && s < certificate.shift.size(); ++s) {
    const auto below = std::ranges::count_if(
        modes.angular_frequency, [&](double omega) { return omega * omega < certificate.shift[s]; });
    if (static_cast<double>(below) != certificate.modes_below[s])
      file.fail(fmt::format("has {} modes below {:.6g} Hz, but its certificate counted {}.", below,
                            std::sqrt(std::max(certificate.shift[s], 0.0)) / (2 * std::numbers::pi),
                            certificate.modes_below[s]));
  }
}

}  // namespace

Kernel read(const std::filesystem::path& path, bool view) {
  const hdf5::Reader file(path, kAdvice);
  check_version(file);
  Kernel kernel;
  if (file.has_attribute("/surface/shape", "direction")) {
    kernel.surface.components = 1;
    kernel.surface.direction.emplace();
  }
  kernel.surface.normal_residual = has_normal_residual(file);
  if (file.exists(kCompressed) || file.is_single("/surface/residual_flexibility"))
    kernel.surface.compact.emplace();
  if (file.exists("/surface/whole")) kernel.surface.whole.emplace();
  if (view && file.exists("/view")) kernel.view.emplace();
  KernelReader reader(file);
  list_kernel(reader, kernel);
  for (Load& load : kernel.applied) {
    const std::string unit = file.string_attribute("/loads/" + load.name, "unit");
    load.unit = unit == kTractionUnit ? "Pa" : unit == kForceUnit ? "N" : "";
    load.inward = has_constant(file, "/loads/" + load.name, kActs, kInward);
  }
  check_certificate(file, kernel.modes);
  validate(kernel, path.string());
  return kernel;
}

std::optional<Header> read_header(const std::filesystem::path& path) noexcept {
  try {
    const hdf5::Reader file(path, kAdvice);
    if (!is_kernel(file) || file.integer_attribute("/", "version") > kVersion) return std::nullopt;
    Header header{file.string_attribute("/", "hash"), file.string_attribute("/", "scene"),
                  file.string_attribute("/", "mesh_sha256")};
    if (file.exists("/surface/whole"))
      header.held = file.read<std::int64_t>("/surface/whole/held", {hdf5::any});
    header.normal_residual = has_normal_residual(file);
    header.mesh_error = file.exists("/modes/stiffness_error");
    return header;
  } catch (...) {
    return std::nullopt;
  }
}

std::string read_hash(const std::filesystem::path& path) noexcept {
  const auto header = read_header(path);
  return header ? header->hash : "";
}

bool has_newer_format(const std::filesystem::path& path) noexcept {
  try {
    const hdf5::Reader file(path, kAdvice);
    return is_kernel(file) && file.integer_attribute("/", "version") > kVersion;
  } catch (...) {
    return false;
  }
}

}  // namespace ricochet::kernels
