// SPDX-License-Identifier: BSD-2-Clause
// What a host finds in the library of a bundle: one plug-in, whose URI and instrument are files of the
// bundle. Each bundle has a copy of the library, so that it can be moved and sent as it is.
#include <lv2/core/lv2.h>
#include <lv2/core/lv2_util.h>
#include <lv2/log/logger.h>
#include <lv2/midi/midi.h>

#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "lv2/plugin.hpp"
#include "ricochet/error.hpp"

namespace ricochet::lv2 {
namespace {

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw InputError(path.string() + ": cannot be read. Write the bundle again with ricochet export.");
  return {std::istreambuf_iterator<char>(file), {}};
}

LV2_Handle instantiate(const LV2_Descriptor*, double rate_hz, const char* bundle,
                       const LV2_Feature* const* features) noexcept {
  LV2_URID_Map* map = nullptr;
  LV2_Log_Logger logger{};
  // clang-format off
  const char* missing = lv2_features_query(features, LV2_LOG__log, &logger.log, false,
                                           LV2_URID__map, &map, true, nullptr);
  // clang-format on
  lv2_log_logger_set_map(&logger, map);
  try {
    if (missing) throw InputError(std::string("the host does not provide the feature ") + missing + ".");
    const std::filesystem::path file = std::filesystem::path(bundle) / "instrument";
    const std::string block = content(file);
    return new Plugin(player::load(std::as_bytes(std::span(block)), file.string()), rate_hz,
                      map->map(map->handle, LV2_MIDI__MidiEvent));
  } catch (const std::exception& error) {
    lv2_log_error(&logger, "ricochet: %s\n", error.what());
    return nullptr;
  }
}

Plugin& plugin(LV2_Handle handle) { return *static_cast<Plugin*>(handle); }

struct Library {
  explicit Library(const std::filesystem::path& bundle) : uri(content(bundle / "uri")) {}

  std::string uri;
  LV2_Descriptor descriptor{
      .URI = uri.c_str(),
      .instantiate = instantiate,
      .connect_port = [](LV2_Handle handle, std::uint32_t port,
                         void* data) { plugin(handle).connect(port, data); },
      .activate = [](LV2_Handle handle) { plugin(handle).activate(); },
      .run = [](LV2_Handle handle, std::uint32_t samples) { plugin(handle).run(samples); },
      .deactivate = nullptr,
      .cleanup = [](LV2_Handle handle) { delete &plugin(handle); },
      .extension_data = nullptr};
  LV2_Lib_Descriptor entry{
      .handle = this,
      .size = sizeof(LV2_Lib_Descriptor),
      .cleanup = [](LV2_Lib_Handle handle) { delete static_cast<Library*>(handle); },
      .get_plugin = [](LV2_Lib_Handle handle, std::uint32_t index) -> const LV2_Descriptor* {
        return index == 0 ? &static_cast<Library*>(handle)->descriptor : nullptr;
      }};
};

}  // namespace
}  // namespace ricochet::lv2

LV2_SYMBOL_EXPORT const LV2_Lib_Descriptor* lv2_lib_descriptor(const char* bundle,
                                                               const LV2_Feature* const*) {
  try {
    return &(new ricochet::lv2::Library(bundle))->entry;
  } catch (const std::exception&) {
    return nullptr;  // the host then reports that the library has no plug-in
  }
}
