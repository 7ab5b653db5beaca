#include "canopus/structured_text/compiler.hpp"

#include <algorithm>
#include <deque>

#include "canopus/ascii/words.hpp"
#include "canopus/structured_text/declarations.hpp"

namespace canopus::structured_text {

namespace {

constexpr std::size_t most_bytes = 2'000'000;  // of all files
constexpr std::size_t most_sources = 1000;

}  // namespace

Compilation compile(std::span<const Source> sources, const program::DeviceNames* devices) {
  auto made = std::make_shared<program::Program>();
  std::vector<SourceError> errors;
  made->code.push_back({});  // where a program that called nothing ends
  made->positions.push_back({});
  std::deque<std::string> capitals;
  std::deque<SyntaxTree> trees;
  Declarations declarations(*made, devices, errors);
  std::size_t bytes = 0;
  for (const Source& source : sources) {
    bytes += source.text.size();
    const auto file = static_cast<std::uint16_t>(made->files.size());
    made->files.push_back(source.name);
    if (bytes > most_bytes || made->files.size() > most_sources) {
      errors.push_back({{file, 1, 1},
                        "too much Structured Text: expected at most " + std::to_string(most_sources) +
                            " files with " + std::to_string(most_bytes) + " bytes in all"});
      break;
    }
    capitals.push_back(ascii::upper(source.text));
    trees.push_back(parse(tokens_of(source.text, capitals.back(), file, errors), errors));
  }
  // What a mistake has left out would be missed in what is right.
  if (errors.empty()) {
    for (const SyntaxTree& tree : trees) declarations.add(tree);
    declarations.compile_all();
  }
  Compilation result;
  std::ranges::stable_sort(errors, {}, [](const SourceError& error) {
    return std::tuple(error.at.file, error.at.line, error.at.column);
  });
  for (SourceError& error : errors) {
    if (result.errors.size() >= 100) break;
    result.errors.push_back(
        {made->files[error.at.file], error.at.line, error.at.column, std::move(error.message)});
  }
  if (result.errors.empty()) result.program = std::move(made);
  return result;
}

}  // namespace canopus::structured_text
