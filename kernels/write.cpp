// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/write.hpp"

#include "base/hdf5_writer.hpp"
#include "kernels/format.hpp"

namespace ricochet::kernels {
namespace {

/// Writes the data that list_kernel lists.
class KernelWriter {
 public:
  explicit KernelWriter(base::hdf5::Writer& file) : file_(file) {}

  void group(const std::string& name) { file_.group(name); }
  void attribute(const std::string& object, const char* name, const auto& value) {
    file_.attribute(object, name, value);
  }
  void constant(const std::string& object, const char* name, const std::string& value) {
    file_.attribute(object, name, value);
  }
  void optional_attribute(const std::string& object, const char* name, const auto& value) {
    if (value != 0) file_.attribute(object, name, value);
  }
  std::size_t rows(const std::string&, const auto& values, std::size_t width) {
    return values.size() / width;
  }
  template <class Values>
  void dataset(const std::string& name, const Values& values, const Shape& shape, const std::string& unit) {
    file_.write<typename Values::value_type>(name, values, shape, unit);
  }
  void optional_dataset(const std::string& name, const auto& values, const Shape& shape,
                        const std::string& unit) {
    if (!values.empty()) dataset(name, values, shape, unit);
  }
  void strings(const std::string& name, const std::vector<std::string>& values, std::size_t) {
    file_.write_strings(name, values);
  }
  void elements(const std::string& name, const std::vector<std::int64_t>& element, int corners, int,
                std::size_t) {
    const auto k = static_cast<std::size_t>(corners);
    dataset(name, element, {element.size() / k, k}, "1");
  }
  void choose(const std::string&, const auto&) {}
  void names(const std::string& kind, const auto& items) {
    std::vector<std::string> names;
    for (const auto& item : items) names.push_back(item.name);
    if (!names.empty()) file_.write_strings("/names/" + kind, names);
  }

 private:
  base::hdf5::Writer& file_;
};

}  // namespace

void write(const Kernel& kernel, const std::filesystem::path& path) {
  validate(kernel, path.string());
  base::hdf5::Writer file(path);
  file.attribute("/", "format", kFormat);
  const auto& compact = kernel.surface.compact;
  file.attribute("/", "version", compact && compact->compressed() ? kVersion : kVersion - 1);
  KernelWriter writer(file);
  list_kernel(writer, kernel);
  file.commit();
}

}  // namespace ricochet::kernels
