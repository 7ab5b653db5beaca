#include "canopus/web/commands/start_page.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "canopus/module_settings/recent_projects.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/web/access/inside_folder.hpp"
#include "canopus/web/commands/example_files.hpp"

namespace canopus::web {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_verdicts = 20000;
constexpr std::uintmax_t largest_shown = 256U << 10;  // bytes of a plant that is read to show what it has

/// Its folders are made, too.
bool write_file(const fs::path& path, const std::string& content) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  std::ofstream out(path, std::ios::binary);
  out << content;
  return static_cast<bool>(out.flush());
}

/// What there is in a plant: {"name", "buses"}, or {"problem"}.
text::Json plant_row(const std::string& text, const std::string& file) {
  const plant::PlantReading reading = plant::read_plant(text, file);
  if (!reading.errors.empty()) {
    const text::FileError& first = reading.errors.front();
    return text::Json{{"problem", fmt::format("{}: {}", text::describe(first.place, file), first.message)}};
  }
  text::Json buses = text::Json::array();
  for (const plant::BusSection& bus : reading.plant.buses) {
    text::Json modules = text::Json::array();
    for (const plant::PlcSection& plc : reading.plant.plcs) {
      for (const plant::ModuleSection& module : plc.modules)
        if (module.bus == bus.name) modules.push_back(module.model);
    }
    text::Json devices = text::Json::array();
    for (const plant::DeviceSection& device : reading.plant.devices) {
      if (device.bus == bus.name)
        devices.push_back(device.name.empty() ? fmt::format("node {}", device.node) : device.name);
    }
    buses.push_back({{"bus", bus.name},
                     {"bit_rate", bus.bit_rate},
                     {"live", bus.is_linked() && bus.replay.empty()},
                     {"modules", std::move(modules)},
                     {"devices", std::move(devices)}});
  }
  return {{"name", reading.plant.name}, {"buses", std::move(buses)}};
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
    if (write_file(name / file.path, std::string(file.content))) continue;
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
const WebStart::Verdict& WebStart::verdict_of(const fs::path& file, std::uintmax_t& to_read) {
  static const Verdict none;
  std::error_code error;
  constexpr std::uintmax_t largest = 4U << 20;
  const std::uintmax_t size = fs::file_size(file, error);
  const bool may_be_plant = file.extension() == ".toml";
  if ((!may_be_plant && file.extension() != ".xml") || error || size > largest) return none;
  const auto written = fs::last_write_time(file, error);
  if (verdicts_.size() >= most_verdicts) verdicts_.clear();
  Verdict& verdict = verdicts_[file.string()];
  if (verdict.written == written && verdict.size == size && size != 0) return verdict;
  if (size > to_read) return none;
  to_read -= size;
  const auto text = text::read_file(file.string());
  verdict = {.written = written,
             .size = size,
             .is_ours = text && text->contains(may_be_plant ? "[[bus]]" : "<canopus-module")};
  if (verdict.is_ours && may_be_plant && size <= largest_shown)
    verdict.plant = plant_row(*text, file.filename().string());
  return verdict;
}

WebStart::Json WebStart::list() {
  std::map<std::string, Json> plants;
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
    const Verdict& verdict = verdict_of(path, to_read);
    if (!verdict.is_ours) continue;
    if (path.extension() == ".xml" && settings.size() < most_listed) settings.push_back(shown);
    if (path.extension() == ".toml" && plants.size() < most_listed) plants.emplace(shown, verdict.plant);
  }
  Json plant_rows = Json::array();
  for (const auto& [path, plant] : plants) {
    Json row{{"path", path}};
    if (plant.is_object()) row.update(plant);  // else it was too large to be read
    plant_rows.push_back(std::move(row));
  }
  std::ranges::sort(projects);
  std::ranges::sort(settings);
  Json running = Json::array();
  for (const auto& [number, child] : children_) {
    if (child.url.empty()) continue;
    running.push_back(
        {{"number", number}, {"path", fs::path(child.path).lexically_relative(folder_).string()}});
  }
  return {{"folder", shown_folder(folder_)},
          {"plants", std::move(plant_rows)},
          {"models", module_models()},
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
    return std::ranges::any_of(known[kind], [&](const Json& one) {
      return (one.is_object() ? one["path"].string() : one.string()) == path;
    });
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

std::expected<std::string, std::string> WebStart::new_path(const std::string& name,
                                                           const std::string& extension) const {
  const bool is_name = !name.empty() && name.size() <= 100 &&
                       name.find_first_of("/\\") == std::string::npos && !name.starts_with('.') &&
                       name == text::printable(name);
  if (!is_name) return std::unexpected("expected a name without / and \\");
  std::string path = (folder_ / (name + extension)).string();
  std::error_code error;
  if (fs::symlink_status(path, error).type() != fs::file_type::not_found)
    return std::unexpected(fmt::format("there is something with the name {}{} already", name, extension));
  return path;
}

void WebStart::make_plant(const Json& wish, Done done) {
  const std::string name = wish.value("name", "");
  const auto path = new_path(name, "");
  if (!path) return done(std::unexpected(path.error()));
  const auto plant = NewPlant::parse(wish, true);
  if (!plant) return done(std::unexpected(plant.error()));
  const auto text = plant->plant_text(name);
  if (!text) return done(std::unexpected(text.error()));
  const fs::path folder(*path);
  const std::string file = (folder / "plant.toml").string();
  std::error_code error;
  bool is_written = fs::create_directory(folder, error) && write_file(file, *text);
  for (const NewDevice& device : plant->devices)
    is_written = is_written && write_file(folder / device.file, device.text);
  if (!is_written) return done(std::unexpected(fmt::format("{} cannot be written", folder.string())));
  make({.path = *path,
        .is_made = true,
        .steps = {{"check", "--", file}},
        .open = [this, file](Done opened) { run_plant(file, {}, std::move(opened)); },
        .done = std::move(done)});
}

void WebStart::make_project(const Json& wish, Done done) {
  const auto path = new_path(wish.value("name", ""), "");
  if (!path) return done(std::unexpected(path.error()));
  const auto project = NewPlant::parse(wish, false);
  if (!project) return done(std::unexpected(project.error()));
  Making making{.path = *path,
                .steps = {{"project", "new", "--json", "--", *path}},
                .open = [this, folder = *path](Done opened) { run_project(folder, std::move(opened)); },
                .done = std::move(done)};
  if (!project->devices.empty()) making.files = ChildProcess::make_folder();
  for (const NewDevice& device : project->devices) {
    const std::string file = (making.files / device.file).string();
    if (making.files.empty() || !write_file(file, device.text))
      return making.done(std::unexpected("the device files cannot be written"));
    std::vector<std::string> words{"project", "add", "--json", fmt::format("--node-id={}", device.node),
                                   fmt::format("--bit-rate={}k", project->bit_rate / 1000)};
    if (!device.name.empty()) words.push_back("--name=" + device.name);
    words.insert(words.end(), {"--", *path, file});
    making.steps.push_back(std::move(words));
  }
  make(std::move(making));
}

void WebStart::make_settings(const std::string& name, const std::string& model, Done done) {
  const auto path = new_path(name, name.ends_with(".xml") ? "" : ".xml");
  if (!path) return done(std::unexpected(path.error()));
  make({.path = *path,
        .steps = {{"configure", "new", "--module=" + model, "--", *path}},
        .open = [this, file = *path](Done opened) { run_project(file, std::move(opened)); },
        .done = std::move(done)});
}

void WebStart::save_settings_as(const std::string& from, const std::string& name, Done done) {
  const Json known = list()["settings"];
  if (std::ranges::find(known, Json(from)) == known.end())
    return done(std::unexpected(fmt::format("there are no settings {}", text::printable(from))));
  const auto path = new_path(name, name.ends_with(".xml") ? "" : ".xml");
  if (!path) return done(std::unexpected(path.error()));
  make({.path = *path,
        .steps = {{"configure", "export", "--", (folder_ / from).string(), *path}},
        .open = [this, file = *path](Done opened) { run_project(file, std::move(opened)); },
        .done = std::move(done)});
}

void WebStart::make(Making making) {
  std::ranges::reverse(making.steps);
  make_next(std::make_shared<Making>(std::move(making)));
}

/// The next step, the last of those that are left. What was made goes again when one fails; what another program has put there
/// meanwhile stays.
void WebStart::make_next(const std::shared_ptr<Making>& making) {
  const auto fail = [making](const std::string& why) {
    std::error_code ignored;
    if (making->is_made) fs::remove_all(making->path, ignored);
    if (!making->files.empty()) fs::remove_all(making->files, ignored);
    making->done(std::unexpected(why));
  };
  if (making->steps.empty()) {
    std::error_code ignored;
    if (!making->files.empty()) fs::remove_all(making->files, ignored);
    return making->open(std::move(making->done));
  }
  if (children_.size() >= most_running) return fail(too_many());
  const std::vector<std::string> words = std::move(making->steps.back());
  making->steps.pop_back();
  const unsigned number = next_++;
  auto child = ChildProcess::start(
      io_, program_, words, {.ended = [this, number, making, fail](int code, const std::string& errors) {
        children_.erase(number);
        if (code != 0) return fail(errors);
        making->is_made = true;
        make_next(making);
      }});
  if (!child) return fail(child.error());
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
