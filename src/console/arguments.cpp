// SPDX-License-Identifier: BSD-2-Clause
#include "src/console/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/similar.hpp"

namespace ricochet::console {

namespace {

/// Number of brackets and braces that are open at the end of `text`.
int open_brackets(const std::string& text) {
  int open = 0;
  for (const char c : text) open += (c == '[' || c == '{') - (c == ']' || c == '}');
  return open;
}

/// The remedy for a value of --set that the shell has split, or that follows its key as a word of its own.
std::optional<std::string> split_setting(const std::vector<std::string>& words) {
  for (std::size_t i = 0; i + 2 < words.size(); ++i) {
    if (words[i] != "--set") continue;
    std::string text = words[i + 1];
    if (text.find('=') == std::string::npos && !words[i + 2].starts_with('-'))
      return fmt::format("--set {0} {1}: write --set {0}={1}", text, words[i + 2]);
    for (std::size_t k = i + 2; open_brackets(text) > 0 && k < words.size(); ++k) {
      text += " " + words[k];
      if (open_brackets(text) == 0)
        return fmt::format("--set {}: the shell splits a value at blanks: quote it, --set '{}'", words[i + 1],
                           text);
    }
  }
  return std::nullopt;
}

std::string unknown_option(const CLI::App& app, const std::string& word, const Elsewhere& elsewhere) {
  const std::string option = word.substr(0, word.find('='));
  if (const auto found = elsewhere.find(option); found != elsewhere.end())
    return fmt::format("{}: is an option of {}, not of {}: leave it out here", option, found->second,
                       app.get_name());
  std::vector<std::string> known;
  for (const CLI::Option* each : app.get_options())
    for (const std::string& name : each->get_lnames()) known.push_back("--" + name);
  const std::string similar = base::most_similar(option, known);
  return fmt::format("{}: there is no such option{}", option,
                     similar.empty() ? "" : fmt::format(": did you mean {}?", similar));
}

std::string unexpected(const CLI::App& app, const std::string& word, const Elsewhere& elsewhere) {
  if (word.size() > 1 && word.starts_with('-')) return unknown_option(app, word, elsewhere);
  if (word.find('=') != std::string::npos)
    return fmt::format("{0}: is not an option: write --set '{0}'", word);
  const std::string input =
      app.get_options([](const CLI::Option* option) { return option->get_positional(); }).front()->get_name();
  return fmt::format("{}: is one word too many: give one {}", word, input);
}

}  // namespace

std::string complaint(const CLI::App& app, const CLI::ParseError& error,
                      const std::vector<std::string>& words, const Elsewhere& elsewhere) {
  const auto split = split_setting(words);
  if (split && error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) return *split;
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) {
    const std::vector<std::string> extra = app.remaining();
    const auto first =
        std::ranges::find_if(words, [&](const auto& word) { return std::ranges::count(extra, word) > 0; });
    return unexpected(app, first == words.end() ? extra.front() : *first, elsewhere);
  }
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError)) {
    for (std::size_t i = 0; i + 1 < words.size(); ++i)
      if (words[i] == "--set" && words[i + 1].find('=') == std::string::npos)
        return fmt::format("--set {}: is not KEY=VALUE: write --set KEY=VALUE SCENE.toml", words[i + 1]);
    return fmt::format("{}: name a file", error.what());
  }
  std::string message = error.what();
  std::ranges::replace(message, '\n', ' ');
  return message;
}

}  // namespace ricochet::console
