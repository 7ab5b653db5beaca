#pragma once
// What the page offers before there is a plant or project: those of a folder, a new project, and a built-in plant to try. Each
// is run as a process of its own with a page of its own.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/text/json.hpp"
#include "canopus/web/access/access_files.hpp"
#include "canopus/web/commands/child_process.hpp"
#include "canopus/web/commands/new_plant.hpp"

namespace canopus::web {

class WebStart {
 public:
  static constexpr std::size_t most_listed = 200;
  static constexpr std::size_t most_running = 8;
  static constexpr std::size_t most_openers = 32;  ///< that wait for one page to be there
  static constexpr std::uintmax_t most_read = 64U
                                              << 20;  ///< bytes of files, each time it is asked what there is
  using Json = text::Json;
  /// Called once: a row, or a sentence.
  using Done = std::function<void(std::expected<Json, std::string>)>;

  /// `folder`: where plants and projects are looked for, and new ones made. `program`: a path. Users and audit log of `access` are
  /// those of the pages that are opened, too.
  WebStart(boost::asio::io_context& io, std::filesystem::path folder,
           std::string program = ChildProcess::itself, WebAccess access = {})
      : io_(io), folder_(std::move(folder)), program_(std::move(program)), access_(std::move(access)) {
    ChildProcess::remove_left_folders();
  }
  ~WebStart();
  WebStart(const WebStart&) = delete;
  WebStart& operator=(const WebStart&) = delete;

  static constexpr std::chrono::milliseconds before_exit{200};  ///< time for the answer to leave
  /// {"plants": [...], "projects": [...], "settings": [...]}: paths below the folder, up to two folders down; settings are those of
  /// modules. Links that lead out of it are left out. A plant is {"path", "name", "buses": [{"bus", "bit_rate", "live", "modules": [models],
  /// "devices": [names]}]}, or {"path", "problem"}; of a large file there is the path alone. And "running": [{"number": 3, "path": "..."}], without a path the built-in plant;
  /// "models": of make_plant().
  [[nodiscard]] Json list();
  /// {"recent": [...]}: the module projects used last that are still there (recent_projects()). Where there are users, who may be on other
  /// machines, those of the folder alone.
  [[nodiscard]] Json recent() const;
  /// Ends the program, and with it what it runs: {"exit": true}.
  void exit(const Done& done);
  /// Runs what is listed under this path, or is recent, or with an empty path the built-in plant: {"url": "http://..."}. What runs already is shown again: two
  /// runs of one plant would be two masters on its real bus.
  void open(const std::string& path, Done done);
  /// Ends one of those that run: {"ended": "its path"}.
  void end(std::uint64_t number, const Done& done);
  /// {"name", and the fields of NewPlant::parse()}: makes a plant of this name, a folder with its file and its device files, and runs it.
  /// One that `canopus check` finds wrong is not kept.
  void make_plant(const Json& wish, Done done);
  /// Likewise a project, without a module, and opens it.
  void make_project(const Json& wish, Done done);
  /// Likewise the settings of a module: NAME.xml.
  void make_settings(const std::string& name, const std::string& model, Done done);
  /// A copy of listed settings under a new name: NAME.xml in the folder, and opens it.
  void save_settings_as(const std::string& path, const std::string& name, Done done);

 private:
  struct Child {
    std::shared_ptr<ChildProcess> process{};
    std::filesystem::path folder{};  ///< of the built-in plant's files; empty: none
    std::string path{};              ///< of what it runs; empty: the built-in plant
    std::string url{};               ///< of its page, once that is there
    std::vector<Done> done{};        ///< until then
  };
  /// What is known of a file as long as it stays as it is.
  struct Verdict {
    std::filesystem::file_time_type written{};
    std::uintmax_t size = 0;
    bool is_ours = false;
    Json plant{};  ///< what there is in it, without its path
  };
  [[nodiscard]] const Verdict& verdict_of(const std::filesystem::path& file, std::uintmax_t& to_read);
  /// Something new of the folder: made by commands, one after the other, then opened.
  struct Making {
    std::string path{};    ///< of the new thing, which was not there before
    bool is_made = false;  ///< by this
    std::vector<std::vector<std::string>> steps{};
    std::filesystem::path files{};  ///< folder of temporary files; empty: none
    std::function<void(Done)> open{};
    Done done{};
  };
  /// Where something of this name is made; the error is a sentence.
  [[nodiscard]] std::expected<std::string, std::string> new_path(const std::string& name,
                                                                 const std::string& extension) const;
  void make(Making making);
  void make_next(const std::shared_ptr<Making>& making);
  void run_plant(const std::string& plant, std::filesystem::path folder, Done done);
  void run_project(const std::string& project, Done done);
  /// `begun`: what is known of it already.
  void run(std::vector<std::string> arguments, Child begun);

  boost::asio::io_context& io_;
  std::filesystem::path folder_;
  std::string program_;
  WebAccess access_;
  std::map<std::string, Verdict> verdicts_;
  std::map<unsigned, Child> children_;
  unsigned next_ = 0;
  boost::asio::steady_timer exit_{io_};
};

}  // namespace canopus::web
