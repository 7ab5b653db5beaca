#include "canopus/web/commands/start_page.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <utility>

#include <fmt/format.h>

#include "canopus/module_settings/recent_projects.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/web/commands/example_files.hpp"

namespace canopus::web {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_verdicts = 20000;

/// A file, and in the folder wherever links lead. Folders that are links are not entered.
bool is_inside(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  if (!fs::is_symlink(file, error)) return true;
  const fs::path real = fs::canonical(file, error);
  const fs::path top = fs::canonical(folder, error);
  return !error && std::ranges::mismatch(top, real).in1 == top.end();
}

std::string too_many() {
  return fmt::format("{} are running already; end one of them first", WebStart::most_running);
}

/// Its files in a folder of their own; empty: they cannot be written.
fs::path write_example() {
  std::error_code error;
  fs::path name = ChildProcess::make_folder();
  if (name.empty()) return {};
  for (const ExampleFile& file : example_files()) {
    const fs::path path = name / file.path;
    fs::create_directories(path.parent_path(), error);
    std::ofstream out(path, std::ios::binary);
    out << file.content;
    if (out.flush()) continue;
    fs::remove_all(name, error);
    return {};
  }
  return name;
}

}  // namespace

WebStart::~WebStart() {
  std::error_code ignored;
  for (auto& [number, child] : children_) {
    child.process->stop();
    if (!child.folder.empty()) fs::remove_all(child.folder, ignored);
  }
}

/// Plants have a bus, the settings of a module their element; other TOML and XML files are none of ours. A file is read once as long
/// as it stays as it is.
bool WebStart::is_ours(const fs::path& file, std::uintmax_t& to_read) {
  std::error_code error;
  constexpr std::uintmax_t largest = 4U << 20;
  const std::uintmax_t size = fs::file_size(file, error);
  const bool may_be_plant = file.extension() == ".toml";
  if ((!may_be_plant && file.extension() != ".xml") || error || size > largest) return false;
  const auto written = fs::last_write_time(file, error);
  if (verdicts_.size() >= most_verdicts) verdicts_.clear();
  Verdict& verdict = verdicts_[file.string()];
  if (verdict.written == written && verdict.size == size && size != 0) return verdict.is_ours;
  if (size > to_read) return false;
  to_read -= size;
  const auto text = text::read_file(file.string());
  verdict = {.written = written,
             .size = size,
             .is_ours = text && text->contains(may_be_plant ? "[[bus]]" : "<canopus-module")};
  return verdict.is_ours;
}

WebStart::Json WebStart::list() {
  std::vector<std::string> plants;
  std::vector<std::string> projects;
  std::vector<std::string> settings;
  std::error_code error;
  constexpr int deepest = 2;
  constexpr int most_looked_at = 20000;
  int looked_at = 0;
  std::uintmax_t to_read = most_read;
  fs::recursive_directory_iterator files(folder_, fs::directory_options::skip_permission_denied, error);
  for (; !error && files != fs::recursive_directory_iterator() && ++looked_at < most_looked_at;
       files.increment(error)) {
    const fs::path& path = files->path();
    std::error_code unknown;
    const bool is_folder = files->is_directory(unknown);
    const bool is_hidden = path.filename().string().starts_with('.');
    if (is_folder && (is_hidden || files.depth() >= deepest)) files.disable_recursion_pending();
    if (is_folder || is_hidden) continue;
    const std::string shown = path.lexically_relative(folder_).string();
    if (!is_inside(path, folder_)) continue;
    if (path.extension() == ".cpj" && projects.size() < most_listed) projects.push_back(shown);
    std::vector<std::string>& found = path.extension() == ".xml" ? settings : plants;
    if (found.size() < most_listed && is_ours(path, to_read)) found.push_back(shown);
  }
  std::ranges::sort(plants);
  std::ranges::sort(projects);
  std::ranges::sort(settings);
  Json running = Json::array();
  for (const auto& [number, child] : children_) {
    if (child.url.empty()) continue;
    running.push_back(
        {{"number", number}, {"path", fs::path(child.path).lexically_relative(folder_).string()}});
  }
  return {{"folder", folder_.string()},
          {"plants", plants},
          {"projects", projects},
          {"settings", settings},
          {"running", running}};
}

WebStart::Json WebStart::recent() const {
  Json paths = Json::array();
  std::error_code error;
  const fs::path top = fs::weakly_canonical(folder_, error);
  for (const std::string& path : module_settings::recent_projects()) {
    const fs::path real = fs::weakly_canonical(path, error);
    const bool is_below = !error && std::ranges::mismatch(top, real).in1 == top.end();
    const bool is_there = fs::is_regular_file(path, error) && path.ends_with(".xml");
    if (is_there && (is_below || access_.users.empty())) paths.push_back(path);
  }
  return {{"recent", paths}};
}

void WebStart::exit(const Done& done) {
  done(Json{{"exit", true}});
  exit_.expires_after(before_exit);
  exit_.async_wait([this](const boost::system::error_code& error) {
    if (!error) io_.stop();
  });
}

void WebStart::open(const std::string& path, Done done) {
  if (path.empty()) {
    fs::path files = write_example();
    if (files.empty()) return done(std::unexpected("the files of the built-in plant cannot be written"));
    const std::string plant = (files / "first-plant/plant.toml").string();
    return run_plant(plant, std::move(files), std::move(done));
  }
  const Json known = list();
  const auto has = [&](const char* kind) {
    return std::ranges::find(known[kind], Json(path)) != known[kind].end();
  };
  const Json recent_ones = recent()["recent"];
  const bool is_recent = std::ranges::find(recent_ones, Json(path)) != recent_ones.end();
  const std::string whole = (folder_ / path).string();
  for (auto& [number, child] : children_) {
    // A project that was made here was opened by its folder.
    if (child.path != whole && fs::path(child.path) / "nodelist.cpj" != fs::path(whole)) continue;
    if (!child.url.empty()) return done(Json{{"url", child.url}});
    if (child.done.size() >= most_openers) return done(std::unexpected("it is being opened; try again"));
    return child.done.push_back(std::move(done));
  }
  if (has("plants")) return run_plant(whole, {}, std::move(done));
  if (has("projects") || has("settings") || is_recent) return run_project(whole, std::move(done));
  done(std::unexpected(fmt::format("there is no plant or project {}", text::printable(path))));
}

void WebStart::end(std::uint64_t number, const Done& done) {
  const auto child = std::ranges::find_if(
      children_, [&](const auto& one) { return one.first == number && !one.second.url.empty(); });
  if (child == children_.end()) return done(std::unexpected("nothing runs under this number"));
  child->second.process->interrupt();
  done(Json{{"ended", fs::path(child->second.path).lexically_relative(folder_).string()}});
}

void WebStart::make_project(const std::string& name, Done done) {
  make(name, "", {"project", "new", "--json"}, "", std::move(done));
}

void WebStart::make_settings(const std::string& name, const std::string& model, Done done) {
  make(name, name.ends_with(".xml") ? "" : ".xml", {"configure", "new", "--model=" + model}, "",
       std::move(done));
}

void WebStart::save_settings_as(const std::string& path, const std::string& name, Done done) {
  const Json known = list()["settings"];
  if (std::ranges::find(known, Json(path)) == known.end())
    return done(std::unexpected(fmt::format("there are no settings {}", text::printable(path))));
  make(name, name.ends_with(".xml") ? "" : ".xml", {"configure", "export"}, (folder_ / path).string(),
       std::move(done));
}

/// `words`: of the command that makes it.
void WebStart::make(const std::string& name, const std::string& extension, std::vector<std::string> words,
                    const std::string& from, Done done) {
  const bool is_name = !name.empty() && name.size() <= 100 &&
                       name.find_first_of("/\\") == std::string::npos && !name.starts_with('.') &&
                       name == text::printable(name);
  if (!is_name) return done(std::unexpected("expected a name without / and \\"));
  const std::string path = (folder_ / (name + extension)).string();
  std::error_code error;
  if (fs::symlink_status(path, error).type() != fs::file_type::not_found) {
    return done(
        std::unexpected(fmt::format("there is something with the name {}{} already", name, extension)));
  }
  if (children_.size() >= most_running) return done(std::unexpected(too_many()));
  auto said = std::make_shared<Done>(std::move(done));
  const unsigned number = next_++;
  words.emplace_back("--");
  if (!from.empty()) words.push_back(from);
  words.push_back(path);
  auto child = ChildProcess::start(io_, program_, words,
                                   {.ended = [this, number, path, said](int code, const std::string& errors) {
                                     children_.erase(number);
                                     if (code != 0) return (*said)(std::unexpected(errors));
                                     run_project(path, std::move(*said));
                                   }});
  if (!child) return (*said)(std::unexpected(child.error()));
  children_[number].process = std::move(*child);
}

void WebStart::run_plant(const std::string& plant, fs::path folder, Done done) {
  std::vector<std::string> words{"run", "--json", "--web", "--free-ports"};
  if (!access_.users.empty()) {
    words.push_back("--web-users=" + access_.users);
    words.push_back("--web-audit=" + access_.audit_file());
  }
  words.insert(words.end(), {"--", plant});
  const std::string path = folder.empty() ? plant : std::string();
  run(std::move(words), {.folder = std::move(folder), .path = path, .done = {std::move(done)}});
}

void WebStart::run_project(const std::string& project, Done done) {
  std::vector<std::string> words{"web", "--json"};
  if (!access_.users.empty()) {
    words.push_back("--users=" + access_.users);
    words.push_back("--audit=" + access_.audit_file());
  }
  words.insert(words.end(), {"--", project});
  run(std::move(words), {.path = project, .done = {std::move(done)}});
}

/// Its page's address is the row; it runs on until this ends.
void WebStart::run(std::vector<std::string> arguments, Child begun) {
  std::error_code ignored;
  if (children_.size() >= most_running) {
    if (!begun.folder.empty()) fs::remove_all(begun.folder, ignored);
    return begun.done.front()(std::unexpected(too_many()));
  }
  const unsigned number = next_++;
  auto child = ChildProcess::start(
      io_, program_, arguments,
      {.line =
           [this, number](const std::string& line) {
             Child& one = children_[number];
             if (one.done.empty()) return;
             const auto event = text::parse_json(line).value_or(Json());
             if (!event.is_object() || event.value("event", "") != "listen" ||
                 event.value("protocol", "") != "web")
               return;
             one.url = event.value("address", "");
             const Json row{{"url", one.url}};
             for (const Done& done : std::exchange(one.done, {})) done(row);
           },
       .ended =
           [this, number](int code, const std::string& errors) {
             const Child one = std::move(children_[number]);
             children_.erase(number);
             std::error_code unknown;
             if (!one.folder.empty()) fs::remove_all(one.folder, unknown);
             for (const Done& done : one.done) {
               done(std::unexpected(errors.empty() ? fmt::format("it ended with exit code {}", code)
                                                   : errors));
             }
           },
       .folder = begun.folder});
  if (!child) {
    if (!begun.folder.empty()) fs::remove_all(begun.folder, ignored);
    return begun.done.front()(std::unexpected(child.error()));
  }
  begun.process = std::move(*child);
  children_[number] = std::move(begun);
}

}  // namespace canopus::web
