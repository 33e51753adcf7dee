// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace ricochet::scene {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t largest = 4 << 20;

/// The first scene in the folder, in alphabetical order; empty if it has none or cannot be read.
std::string scene_in(const fs::path& folder) {
  std::string first;
  std::error_code failure;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure))
    if (entry->path().extension() == ".toml" && (first.empty() || entry->path().string() < first))
      first = entry->path().string();
  return first;
}

/// What the file is if it is not a scene, judged by its name, and what to do with it. Otherwise empty.
std::string other_kind(const std::string& name) {
  if (name.ends_with(".result.h5"))
    return "is a result: name the scene that it was computed from; ricochet plot draws a result";
  if (name.ends_with(".kernel.h5"))
    return "is a kernel: name the scene that it was computed from, which finds its kernels itself";
  if (name.ends_with(".h5")) return "is an HDF5 file: name a scene, SCENE.toml";
  if (name.ends_with(".summary.json"))
    return "is the summary of a result: name the scene that it was computed from";
  for (const char* ending : {".inp", ".bdf", ".nas", ".fem"})
    if (name.ends_with(ending))
      return "is a deck: run ricochet import mesh on it, which writes the mesh and the draft of a scene";
  for (const char* ending : {".med", ".vtu", ".cgns"})
    if (name.ends_with(ending))
      return "is a mesh: run ricochet import mesh on it, and name a scene with the .msh as bodies.NAME.mesh";
  for (const char* ending :
       {".geo", ".msh", ".step", ".stp", ".brep", ".iges", ".igs", ".stl", ".vtk", ".unv"})
    if (name.ends_with(ending))
      return "is a mesh or drawing: name a scene, with this file as bodies.NAME.mesh; "
             "a scene starts as a copy of a folder in meshes/";
  return "";
}

/// What is wrong with bytes that are not UTF-8 text. Otherwise empty.
std::string not_text(const std::string& text) {
  if (text.starts_with("\x89HDF")) return "is an HDF5 file: name a scene, SCENE.toml";
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    return "is UTF-16 text: save it as UTF-8 in the editor";
  if (text.find('\0') != std::string::npos) return "is not a text file: name a scene, SCENE.toml";
  return "";
}

/// A mistake in a line that is not TOML, and its remedy.
struct Slip {
  std::regex line;
  const char* remedy;
};

/// The remedy for a line that is not TOML; the first pattern that fits decides. Empty if none does.
std::string remedy_for(const std::string& line) {
  static const Slip slips[] = {
      {std::regex("“|”|„|‘|’|«|»"), "use straight quotes, \"…\""},
      {std::regex(R"(^\s*//|^[^"']*("[^"]*"[^"']*)*\s//)"), "a comment starts with #"},
      {std::regex(R"(^\s*[\w.-]+\s*:)"), "write = between key and value"},
      {std::regex(R"(^[^=]*=\s*"[^"]*\\)"), "write / in place of \\ in a path"},
      {std::regex(R"([=\[,{]\s*(True|TRUE|False|FALSE|yes|no|on|off)\b)"),
       "write true or false, in lower case"},
      {std::regex(R"(=\s*[-+]?\d+,\d+\s*(#.*)?$)"), "write a decimal point in place of the comma"},
      {std::regex(R"(;\s*(#.*)?$)"), "remove the semicolon"},
      {std::regex(R"(^(\s*\[.*\]|[^\[{]*=.*|[^=]*=[^\[]*\[[^\]]*\]\s*),\s*(#.*)?$)"),
       "remove the comma at the end of the line"},
      {std::regex(R"(=\s*\()"), "write a vector in brackets, [x, y, z]"},
      {std::regex(R"([=\[,{]\s*[-+]?\.\d)"), "write a digit before the decimal point, 0.5"},
      {std::regex(R"([=\[,{]\s*[-+]?\d[\d_.]*([eE][-+]?\d+)?\s*[A-Za-zµ°%/])"),
       "give the number alone: docs/keys.md states the unit of each key"},
      {std::regex(R"(\[[^\]]*[\d.]\s+[-+\d.]|\[[^\]]*"\s+")"), "separate the entries of a list by commas"},
      {std::regex(R"(^\s*[\w."-]+\s*=\s*(#.*)?$)"), "a value is missing after ="},
      {std::regex(R"(^[^"]*("[^"]*"[^"]*)*"[^"]*$)"), "close the text with a quote"},
      {std::regex(R"(^\s*\[[^\]]*$)"), "close the name of the table with ]"},
      {std::regex(R"(^\s*\[\s*\w+\s+\w+)"), "write dots between the parts of the name, as in [bodies.NAME]"},
      {std::regex(R"(=\s*[A-Za-z_./~])"), "write text in quotes, \"…\""},
      {std::regex(R"(^\s*\w[^=]*$)"), "write KEY = VALUE"},
  };
  for (const Slip& slip : slips)
    if (std::regex_search(line, slip.line)) return slip.remedy;
  return "";
}

/// The remedy for errors that the line alone does not show, by the parser's description of them.
std::string remedy_for_rest(const std::string& description) {
  const auto states = [&](const char* words) { return description.find(words) != std::string::npos; };
  if (states("redefine existing table"))
    return "the file has this table already: choose another name, or put all its keys in one place";
  if (states("redefine")) return "the table has this key already: remove one of the two";
  if (states("end-of-file")) return "the file ends within a value: is it complete?";
  if (states("parsing array")) return "the list before it is not closed: add ]";
  if (states("inline table")) return "close a table in braces with } on the line where it starts";
  const std::size_t reason = description.find(": ");
  return "this is not TOML: " + description.substr(reason == std::string::npos ? 0 : reason + 2);
}

/// The n-th line, from 1, without blanks around it. It is cut to 200 bytes, because matching recurses.
std::string line_of(const std::string& text, std::uint32_t number) {
  std::istringstream stream(text);
  std::string line;
  for (std::uint32_t n = 0; n < number && std::getline(stream, line); ++n) continue;
  line.resize(std::min<std::size_t>(line.size(), 200));
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

std::string text_of(const fs::path& file) {
  const auto refuse = [&](const std::string& what) {
    if (!what.empty()) throw InputError(one_line(fmt::format("{}: {}", file.string(), what)));
  };
  std::error_code failure;
  if (fs::is_directory(file, failure)) {
    const std::string inside = scene_in(file);
    refuse("is a folder: name a scene" + (inside.empty() ? ", SCENE.toml" : ", such as " + inside));
  }
  if (!fs::is_regular_file(file, failure)) {
    const fs::path with_ending = file.string() + ".toml";
    refuse("no such file" + (fs::is_regular_file(with_ending, failure)
                                 ? fmt::format(": did you mean {}?", with_ending.string())
                                 : ": name a scene, SCENE.toml"));
  }
  refuse(other_kind(file.filename().string()));
  if (fs::file_size(file, failure) > largest)
    refuse("is larger than 4 MiB, so it is not a scene: name another file");
  std::ifstream stream(file, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(stream), {});
  if (!stream) refuse("cannot be read: change its permissions, or name another file");
  refuse(not_text(text));
  return text;
}

toml::table tables_of(const std::string& text, const std::string& name) {
  toml::table parsed;
  try {
    parsed = parse_toml(text, name);
  } catch (const toml::parse_error& error) {
    const auto [line, column] = error.source().begin;
    const std::string place = fmt::format("{}:{}:{}", name, line, column), description(error.description());
    if (description.find("utf-8") != std::string::npos)  // the line cannot be printed
      throw InputError(place + ": this is not UTF-8: save the file as UTF-8 in the editor");
    const std::string found = line_of(text, line);
    // A key or table that is given twice is valid by itself.
    std::string remedy = description.find("redefine") == std::string::npos ? remedy_for(found) : "";
    if (remedy.empty()) remedy = remedy_for_rest(description);
    throw InputError(one_line(fmt::format("{}: {}: {}", place, shortened(found), remedy)));
  }
  if (parsed.contains("scene") && !parsed.contains("bodies"))
    throw InputError(fmt::format("{0}: is a study: run it with ricochet sweep {0}, or name its scene, {1}",
                                 name, parsed["scene"].value_or(std::string("SCENE.toml"))));
  return parsed;
}

}  // namespace ricochet::scene
