// SPDX-License-Identifier: BSD-2-Clause
// An invalid scene is refused in one line: the file, the key, the value found, and the remedy.
#include <gmock/gmock.h>
#include <toml++/toml.h>

#include <algorithm>

#include "base/similar.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/read.hpp"
#include "tests/scene/scenes.hpp"

namespace ricochet::scene::refusals_test {

using namespace test;
using ::testing::HasSubstr;

/// The list of refusals, which describes its entries.
const toml::table& list() {
  static const toml::table table = toml::parse_file(RICOCHET_SOURCE "/tests/programs/mistakes.toml");
  return table;
}

TEST(Refused, is_each_change_of_the_list_with_its_line) {
  const Folder folder;
  folder.write("push.csv", "0, 1\n");
  int refused = 0;
  for (const toml::node& group : *list()["refusals"].as_array()) {
    const std::string of = *group.at_path("of").value<std::string>();
    for (const toml::node& entry : *group.at_path("lines").as_array()) {
      std::vector<std::string> words;
      for (const toml::node& word : *entry.as_array()) words.push_back(*word.value<std::string>());
      const std::string &from = words.at(0), &to = words.at(1), &line = words.at(2);
      SCOPED_TRACE(to + line);
      const std::string base = of == "nothing" ? "" : shared_scene(of);
      const auto file = folder.write("scene.toml", from.empty() ? base + to : changed(base, from, to));
      const bool placed = line.starts_with("scene.toml:") || line.starts_with("--set");
      EXPECT_EQ(complaint_of([&] {
                  read(file, {words.begin() + 3, words.end()});
                }),
                placed ? line : "scene.toml: " + line);
      ++refused;
    }
  }
  EXPECT_GT(refused, 350);
}

// So that a new list of tables joins the list of refusals.
TEST(Refused, is_a_misspelt_key_of_each_list_of_tables) {
  std::size_t lists = 0;
  for (const Section* section : all_sections())
    lists += static_cast<std::size_t>(std::ranges::count(section->keys, Type::tables, &Key::type));
  EXPECT_EQ(lists, 8);
}

TEST(Refused, is_text_that_is_not_utf_8) {
  EXPECT_EQ(complaint_about("a = 1\nb = \"\xe9\""),
            "scene.toml:2:5: this is not UTF-8: save the file as UTF-8 in the editor");
}

// A line of a damaged file may be very long.
TEST(Refused, is_a_long_line_in_a_short_one) {
  EXPECT_THAT(complaint_about("a = " + std::string(1 << 20, '(')),
              HasSubstr("…: write a vector in brackets"));
}

TEST(Refused, is_a_file_that_is_missing_or_not_toml) {
  const Folder folder;
  const auto complaint_of_file = [&](const char* name, const std::string& text) {
    const std::filesystem::path file = folder.write(name, text);
    return complaint_of([&] { read(file); }).substr(file.string().size());
  };
  const std::string missing = (folder.path() / "none").string();
  EXPECT_EQ(complaint_of([&] { read(missing); }), missing + ": no such file: name a scene, SCENE.toml");
  EXPECT_EQ(complaint_of([&] { read(folder.path()); }),
            folder.path().string() + ": is a folder: name a scene, SCENE.toml");
  const std::string there = folder.write("none.toml", smallest);
  EXPECT_EQ(complaint_of([&] { read(missing); }), missing + ": no such file: did you mean " + there + "?");
  EXPECT_EQ(complaint_of([&] { read(folder.path()); }),
            folder.path().string() + ": is a folder: name a scene, such as " + there);
  EXPECT_THAT(complaint_of_file("a.result.h5", ""), HasSubstr(": is a result: name the scene"));
  EXPECT_THAT(complaint_of_file("a.kernel.h5", ""), HasSubstr(": is a kernel: name the scene"));
  EXPECT_THAT(complaint_of_file("a.geo", ""), HasSubstr(": is a mesh or drawing: name a scene"));
  EXPECT_THAT(complaint_of_file("a.bdf", ""), HasSubstr(": is a deck: run ricochet import mesh on it"));
  EXPECT_THAT(complaint_of_file("a.med", ""), HasSubstr(": is a mesh: run ricochet import mesh on it"));
  EXPECT_EQ(complaint_of_file("hdf5.toml", "\x89HDF\r\n"), ": is an HDF5 file: name a scene, SCENE.toml");
  EXPECT_EQ(complaint_of_file("utf16.toml", "\xff\xfet"), ": is UTF-16 text: save it as UTF-8 in the editor");
}

// Very deeply nested tables would exhaust the stack when they are destroyed.
TEST(Refused, is_a_key_of_endless_depth) {
  std::string key = "a";
  for (int depth = 0; depth < 100000; ++depth) key += ".a";
  for (const std::string& line : {key + " = 1", "[" + key + "]"})
    EXPECT_EQ(complaint_about(smallest + line),
              "scene.toml:18: more than 100 dots: no key is nested so deeply; break the line");
  EXPECT_EQ(complaint_about(smallest, {key + "=1"}).substr(0, 8), "--set a.");
  EXPECT_EQ(complaint_about(smallest, {"title={" + key + "=1}"}),
            "--set:1: more than 100 dots: no key is nested so deeply; break the line");
  EXPECT_EQ(scene_of("# " + std::string(1000, '.') + smallest).title, "scene");
}

TEST(Refused, is_a_file_that_is_too_long_for_a_scene) {
  EXPECT_THAT(complaint_about(smallest + std::string(5 << 20, '\n')), HasSubstr("is larger than 4 MiB"));
}

TEST(Refused, is_reported_in_one_line_for_any_value) {
  EXPECT_EQ(complaint_about(smallest + "[\"a\\nb\\u007f\"]\n").find_first_of("\n\x7f"), std::string::npos);
}

// Otherwise the message would propose what the reader refuses.
TEST(Example, of_every_key_is_accepted) {
  int examples = 0;
  for (const Key& key : body_keys.keys) {
    if (key.example.empty() || key.name == "material") continue;
    ++examples;
    EXPECT_NO_THROW(scene_of(
        changed(smallest, "contact = \"skin\"", "contact = \"skin\"\n" + key.name + " = " + key.example)))
        << key.name;
  }
  EXPECT_EQ(examples, 3);
  EXPECT_NO_THROW(scene_of(
      changed(smallest, "[contact]", "[contact]\nfriction = " + pair_keys.find("friction")->example)));
  EXPECT_NO_THROW(
      scene_of(changed(smallest, "{ density = 1000, young = 1e9 }", body_keys.find("material")->example)));
  EXPECT_NO_THROW(scene_of(
      changed(smallest, "[time]", "[loads]\ngravity = " + loads_keys.find("gravity")->example + "\n[time]")));
  for (const Key& key : scene_keys.keys)
    EXPECT_EQ(key.example.starts_with("[" + key.name), key.type == Type::table) << key.name;
}

// The suggestion is one of the words, or none; a word that exists is its own nearest word.
TEST(MostSimilar, is_none_for_a_word_that_shares_few_letters) {
  const std::vector<std::string> words{"mesh", "gap", "velocity"};
  for (const std::string& word : words) EXPECT_EQ(ricochet::base::most_similar(word, words), word);
  for (const char* word : {"qqq", "x", "", "elephant", "höhe"})
    EXPECT_EQ(ricochet::base::most_similar(word, words), "") << word;
  EXPECT_EQ(ricochet::base::most_similar("VELOCITY", words), "velocity");
  EXPECT_EQ(ricochet::base::most_similar("velo", words), "velocity");
}

}  // namespace ricochet::scene::refusals_test
