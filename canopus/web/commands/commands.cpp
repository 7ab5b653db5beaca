#include "canopus/web/commands/commands.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <utility>

#include <fmt/format.h>

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/text/shortened.hpp"
#include "canopus/text/version.hpp"
#include "canopus/web/state/view_fields.hpp"

namespace canopus::web {
namespace {

namespace fs = std::filesystem;
using ArmClock = std::chrono::steady_clock;

/// The last part of a name that the page sends, if it can be a file's name here.
std::string file_name_of(std::string_view given) {
  const std::size_t slash = given.find_last_of("/\\");
  const std::string name(slash == std::string_view::npos ? given : given.substr(slash + 1));
  return name.empty() || name == "." || name == ".." || name.size() > 200 ? "device.eds" : name;
}

/// An error for a field that the command does not have.
std::expected<void, std::string> check_fields(const text::Json& wish, std::string_view command,
                                              const std::vector<std::string_view>& known) {
  for (const auto& [key, value] : wish.items()) {
    if (key == "command" || std::ranges::find(known, key) != known.end()) continue;
    return std::unexpected(fmt::format("{}: unknown {}; expected {}", command, quoted_name(key),
                                       known.empty() ? "no field" : text::one_of(known)));
  }
  return {};
}

/// Whose commands take turns with those of others: without users all with the key, and all without it.
std::string fairness_key(const WebUser& user) {
  return user.name.empty() ? fmt::format("role {}", name_of(user.role)) : user.name;
}

/// What the wish names of `all` under `key`, the first one if it names none.
template <typename Place>
const Place* place_of(const std::vector<Place>& all, std::string Place::*name, const text::Json& wish,
                      const char* key) {
  const auto given = wish.find(key);
  if (given == wish.end()) return all.empty() ? nullptr : &all.front();
  const auto found = std::ranges::find_if(
      all, [&](const Place& one) { return given->is_string() && one.*name == given->string(); });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

WebCommands::~WebCommands() {
  if (running_) running_->stop();
  std::error_code ignored;
  for (const Job& job : jobs_) {
    if (!job.folder.empty()) fs::remove_all(job.folder, ignored);
  }
}

bool WebCommands::is_armed() const { return ArmClock::now() < armed_until_; }

/// Whole, from 0 to 600.
std::int64_t WebCommands::armed_seconds() const {
  return is_armed() ? std::chrono::ceil<std::chrono::seconds>(armed_until_ - ArmClock::now()).count() : 0;
}

WebCommands::Json WebCommands::event_of(std::uint32_t id) const {
  Json event = plant::event_line(use_.now(), "reply");
  event["id"] = id;
  return event;
}

void WebCommands::send(const WebReply& reply, Json event) const { reply(view_event(event)); }

void WebCommands::done(const WebUser& user, const std::string& line, int code, const std::string& message,
                       WebRole role) const {
  if (!use_.done) return;
  use_.done(user, text::shortened(line, longest_noted), code, text::shortened(message, longest_noted), role);
}

void WebCommands::refuse(const WebUser& user, const std::string& line, std::uint32_t id,
                         const WebReply& reply, int code, const std::string& message) const {
  Json event = event_of(id);
  event["code"] = code;
  event["message"] = message;
  if (!line.empty()) done(user, line, code, message);
  send(reply, std::move(event));
}

std::expected<WebCommands::Placed, std::string> WebCommands::place(const std::string& name,
                                                                   const text::Json& wish) const {
  const auto placed = [&](const auto* one, std::string_view kind,
                          const std::string& called) -> std::expected<Placed, std::string> {
    auto line = web_command_line(wish, *one);
    if (!line) return std::unexpected(line.error());
    return Placed{
        .line = std::move(*line), .is_live = one->is_live, .place = fmt::format("{} {}", called, kind)};
  };
  if (is_web_settings_command(name)) {
    const WebSettings* const settings = place_of(use_.settings, &WebSettings::file, wish, "settings");
    if (settings == nullptr) return std::unexpected("there are no such module settings");
    return placed(settings, "leads to a live module", settings->file);
  }
  const WebBus* const bus = place_of(use_.buses, &WebBus::name, wish, "bus");
  if (bus == nullptr) return std::unexpected("there is no such bus");
  return placed(bus, "is a live bus", bus->name);
}

void WebCommands::run(const WebUser& user, std::string_view command, std::uint32_t id, WebReply reply) {
  const auto wish = text::parse_json(command).value_or(Json());
  const auto name = wish.is_object() && wish.contains("command") && wish["command"].is_string()
                        ? wish["command"].get<std::string>()
                        : std::string();
  static const std::map<std::string, std::vector<std::string_view>, std::less<>> fields{
      {"hello", {}}, {"arm", {"on"}}, {"stop", {"id"}}};
  if (const auto own = fields.find(name); own != fields.end()) {
    if (auto good = check_fields(wish, name, own->second); !good)
      return refuse(user, name, id, reply, web_code::usage, good.error());
  }
  if (name == "hello") return hello(user, id, reply);
  if (name == "arm") return arm(user, wish, id, reply);
  if (name == "stop") return stop(user, wish, id, reply);
  if (const auto own = use_.own.find(name); own != use_.own.end()) {
    return run_own(user, name, own->second, wish, id, reply);
  }
  auto placed = place(name, wish);
  if (!placed) return refuse(user, name, id, reply, web_code::usage, placed.error());
  WebCommandLine& line = placed->line;
  const std::string shown = shown_command(line.arguments);
  if (user.role < line.role) {
    return refuse(user, shown, id, reply, web_code::not_allowed,
                  fmt::format("{}: the role {} is needed, yours is {}", line.title, name_of(line.role),
                              name_of(user.role)));
  }
  if (line.writes_to_bus && placed->is_live && !is_armed()) {
    return refuse(user, shown, id, reply, web_code::not_armed,
                  fmt::format("{}: {}; arm writing first", line.title, placed->place));
  }
  if (!has_room_for(user)) {
    return refuse(user, shown, id, reply, web_code::busy, "too many commands wait; try again");
  }
  jobs_.push_back({.user = user, .line = std::move(line), .id = id, .reply = std::move(reply)});
  if (jobs_.size() == 1) start_next();
}

/// Nobody takes all the room, and those who only look leave half of it to those who do something.
bool WebCommands::has_room_for(const WebUser& user) const {
  const auto count = [&](const auto& is_meant) {
    return static_cast<std::size_t>(std::ranges::count_if(jobs_, is_meant));
  };
  const auto is_of_role_look = [](const Job& job) { return job.user.role == WebRole::look; };
  const auto is_of_same = [party = fairness_key(user)](const Job& job) {
    return fairness_key(job.user) == party;
  };
  if (jobs_.size() >= most_waiting || count(is_of_same) >= most_of_user) return false;
  return user.role != WebRole::look || count(is_of_role_look) < most_of_role_look;
}

void WebCommands::hello(const WebUser& user, std::uint32_t id, const WebReply& reply) const {
  Json event = event_of(id);
  event["code"] = 0;
  event["user"] = user.name;
  event["role"] = name_of(user.role);
  event["version"] = text::program_version();
  event["armed_for"] = armed_seconds();
  event["offers"] = Json::array();  // commands of this run alone
  for (const auto& [name, own] : use_.own) event["offers"].push_back(name);
  event["buses"] = Json::array();
  for (const WebBus& bus : use_.buses) {
    event["buses"].push_back({{"bus", bus.name},
                              {"project", bus.project},
                              {"joins", !bus.address.empty()},
                              {"bit_rate", bus.bit_rate},
                              {"live", bus.is_live},
                              {"device_files", bus.device_files}});
  }
  event["settings"] = Json::array();
  for (const WebSettings& one : use_.settings) {
    event["settings"].push_back({{"file", one.file},
                                 {"model", one.model},
                                 {"setup", one.setup},
                                 {"plc", one.plc},
                                 {"live", one.is_live}});
  }
  send(reply, std::move(event));
}

void WebCommands::arm(const WebUser& user, const text::Json& wish, std::uint32_t id, const WebReply& reply) {
  const bool on = wish.contains("on") && wish["on"].is_boolean() && wish["on"].get<bool>();
  const std::string line = on ? "arm" : "disarm";
  if (user.role < WebRole::operate) {
    return refuse(user, line, id, reply, web_code::not_allowed,
                  line + ": the role operate is needed, yours is look");
  }
  armed_until_ = on ? ArmClock::now() + use_.armed_for : ArmClock::time_point{};
  Json event = event_of(id);
  event["code"] = 0;
  event["armed_for"] = armed_seconds();
  done(user, line, 0, {});
  send(reply, std::move(event));
}

void WebCommands::stop(const WebUser& user, const text::Json& wish, std::uint32_t id, const WebReply& reply) {
  const auto number = wish.find("id");
  const auto job = std::ranges::find_if(jobs_, [&](const Job& one) {
    return number != wish.end() && number->is_number_unsigned() && one.id == number->get<std::uint64_t>() &&
           one.user.name == user.name && one.user.address == user.address;
  });
  Json event = event_of(id);
  event["code"] = job == jobs_.end() ? web_code::usage : 0;
  if (job == jobs_.end()) event["message"] = "there is no such command of yours";
  send(reply, std::move(event));
  if (job == jobs_.end()) return;
  job->is_stopped = true;
  if (job == jobs_.begin() && running_) {
    running_->interrupt();
    return extend_timeouts(use_.grace);
  }
  const Job taken = std::move(*job);
  jobs_.erase(job);
  refuse(taken.user, shown_command(taken.line.arguments), taken.id, taken.reply, web_code::stopped,
         "stopped");
}

void WebCommands::run_own(const WebUser& user, const std::string& name, const Own& own,
                          const text::Json& wish, std::uint32_t id, const WebReply& reply) {
  if (user.role < own.role) {
    return refuse(
        user, name, id, reply, web_code::not_allowed,
        fmt::format("{}: the role {} is needed, yours is {}", name, name_of(own.role), name_of(user.role)));
  }
  if (auto good = check_fields(wish, name, own.fields); !good)
    return refuse(user, own.is_noted ? name : std::string(), id, reply, web_code::usage, good.error());
  const std::string line = text::shortened(wish.dump(), longest_noted);
  if (own.live_bus && !is_armed()) {
    if (const std::string bus = own.live_bus(wish); !bus.empty()) {
      return refuse(user, line, id, reply, web_code::not_armed,
                    fmt::format("{}: {} is a live bus; arm writing first", name, bus));
    }
  }
  own.run(wish, [this, user, line, id, reply, role = own.role,
                 is_noted = own.is_noted](std::expected<Json, std::string> row) {
    if (!row) return refuse(user, is_noted ? line : std::string(), id, reply, web_code::refused, row.error());
    Json event = event_of(id);
    event["code"] = 0;
    event["rows"] = Json::array({std::move(*row)});
    if (is_noted) done(user, line, 0, {}, role);
    send(reply, std::move(event));
  });
}

/// Its file in a folder of its own. The error is a sentence, empty: none.
std::string WebCommands::make_file(Job& job) const {
  if (!job.line.file_text && !job.line.makes_file) return {};
  job.folder = ChildProcess::make_folder();
  if (job.folder.empty()) return "there is no folder for temporary files";
  const fs::path file = job.folder / file_name_of(job.line.file_name);
  if (job.line.file_text) {
    std::ofstream out(file, std::ios::binary);
    out << *job.line.file_text;
    if (!out.flush()) return fmt::format("{} cannot be written", file.string());
    job.line.file_text.reset();
  }
  std::ranges::replace(job.line.arguments, std::string("{file}"), file.string());
  return {};
}

/// To the front: the oldest of the user whose last turn is longest ago.
void WebCommands::choose_next() {
  const auto turn_of = [this](const Job& job) {
    const auto found = turns_.find(fairness_key(job.user));
    return found == turns_.end() ? 0 : found->second;
  };
  const auto next = std::ranges::min_element(jobs_, {}, turn_of);
  std::rotate(jobs_.begin(), next, next + 1);
  turns_[fairness_key(jobs_.front().user)] = ++turn_;
}

std::expected<std::shared_ptr<RunningCommand>, std::string> WebCommands::start(const Job& job) {
  RunningCommand::Use use{.line =
                              [this](std::string line) {
                                if (text::parse_json(line)) jobs_.front().rows.push_back(std::move(line));
                                send_rows(false);
                              },
                          .ended = [this](int code, const std::string& errors) { ended(code, errors); }};
  if (use_.on_bus) {
    if (auto running = use_.on_bus(job.line, use)) return running;
  }
  return ChildProcess::start(io_, use_.program, job.line.arguments,
                             {.line = std::move(use.line),
                              .ended = std::move(use.ended),
                              .most_output = use_.most_output,
                              .folder = job.folder});
}

/// Then it is asked to end, and after some grace ended.
void WebCommands::extend_timeouts(std::chrono::milliseconds time) {
  patience_.expires_after(time);
  patience_.async_wait([this, turn = turn_](const boost::system::error_code& error) {
    if (error || !running_ || turn != turn_) return;
    Job& job = jobs_.front();
    if (job.is_stopped || job.is_late) return running_->kill();
    job.is_late = true;
    running_->interrupt();
    extend_timeouts(use_.grace);
  });
}

void WebCommands::start_next() {
  while (!jobs_.empty()) {
    choose_next();
    Job& job = jobs_.front();
    std::string wrong = make_file(job);
    if (wrong.empty()) {
      auto running = start(job);
      if (running) {
        running_ = std::move(*running);
        return extend_timeouts(job.line.joins_bus ? use_.longest_on_bus : use_.longest_with_files);
      }
      wrong = running.error();
    }
    const Job failed = std::move(job);
    jobs_.pop_front();
    std::error_code ignored;
    if (!failed.folder.empty()) fs::remove_all(failed.folder, ignored);
    refuse(failed.user, shown_command(failed.line.arguments), failed.id, failed.reply, 1, wrong);
  }
}

/// What has come so far, not more than ten times a second.
void WebCommands::send_rows(bool at_once) {
  if (!at_once && std::exchange(is_batched_, true)) return;
  if (!at_once) {
    batch_.expires_after(std::chrono::milliseconds(100));
    batch_.async_wait([this](const boost::system::error_code& error) {
      if (error) return;
      is_batched_ = false;
      if (!jobs_.empty() && !jobs_.front().rows.empty()) send_rows(true);
    });
    return;
  }
  Job& job = jobs_.front();
  std::string rows;
  for (const std::string& row : std::exchange(job.rows, {})) rows += (rows.empty() ? "" : ",") + row;
  Json event = event_of(job.id);
  event["more"] = true;
  // Rows are JSON already; they are not read and written again.
  std::string text = view_event(event);
  text.pop_back();
  job.reply(text + ",\"rows\":[" + rows + "]}");
}

void WebCommands::ended(int code, const std::string& errors) {
  if (!jobs_.front().rows.empty()) send_rows(true);
  Job job = std::move(jobs_.front());
  jobs_.pop_front();
  running_.reset();
  patience_.cancel();
  Json event = event_of(job.id);
  if (job.is_stopped || job.is_late) code = web_code::stopped;
  event["code"] = code;
  event["command"] = shown_command(job.line.arguments);
  std::string message = errors;
  while (message.ends_with('\n')) message.pop_back();
  // The page's file is called as the page called it, wherever it lay.
  const std::string folder = job.folder.string() + '/';
  for (std::size_t at = 0; !job.folder.empty() && (at = message.find(folder, at)) != std::string::npos;)
    message.erase(at, folder.size());
  if (job.is_late) message = "it took too long and was stopped";
  if (!message.empty()) event["message"] = message;
  if (job.line.makes_file) {
    if (auto text = text::read_file((job.folder / job.line.file_name).string()))
      event["file"] = std::move(*text);
  }
  std::error_code ignored;
  if (!job.folder.empty()) fs::remove_all(job.folder, ignored);
  done(job.user, shown_command(job.line.arguments), code, message, job.line.role);
  send(job.reply, std::move(event));
  start_next();
}

}  // namespace canopus::web
