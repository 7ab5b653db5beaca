#include "canopus/web/web_page.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/text/shortened.hpp"
#include "canopus/web/access/secret.hpp"
#include "canopus/web/access/users.hpp"
#include "canopus/web/commands/program_commands.hpp"
#include "canopus/web/state/node_detail_view.hpp"
#include "canopus/web/state/view_fields.hpp"

namespace canopus::web {
namespace {

/// Whoever knows the key may do what the one may who runs the program: other users of this machine do not.
WebServerOptions options_of(const WebAccess& access, const std::expected<PageFiles, std::string>& files) {
  WebServerOptions options{
      .role = WebRole::configure, .key = new_secret(), .gate = {}, .origin = access.origin};
  if (files) options.files = std::make_shared<const PageFiles>(*files);
  if (!access.users.empty()) {
    options.gate.read_users = [file = access.users] { return read_web_users(file); };
  }
  return options;
}

/// As much of a message as a line has room for.
std::string one_line(std::string message) {
  constexpr std::size_t longest = 300;
  std::ranges::replace(message, '\n', ' ');
  return text::shortened(text::printable(message), longest);
}

using OwnCommands = std::map<std::string, WebCommands::Own, std::less<>>;

/// {"command": "pace", "speed": 2}, 0: plant time stands still; {"command": "pace", "run": "100ms"}: it goes on for so long.
std::expected<text::Json, std::string> change_pace(const WebPace& pace, const text::Json& wish) {
  if (const std::string time = wish.value("run", ""); !time.empty()) {
    const auto duration = text::parse_duration(time);
    if (!duration) return std::unexpected("run: " + duration.error());
    pace.set_speed(pace.speed() == 0 ? 1 : pace.speed(), *duration);
    return text::Json{{"speed", pace.speed()}};
  }
  const auto speed = wish.find("speed");
  const bool is_number = speed != wish.end() && speed->is_number();
  const double value = is_number ? speed->get<double>() : -1;
  if (value != 0 && !(value >= WebPage::slowest && value <= WebPage::fastest)) {
    return std::unexpected(
        fmt::format("speed: expected 0 (stand still) or {} to {}", WebPage::slowest, WebPage::fastest));
  }
  pace.set_speed(value, can::Duration::max());
  return text::Json{{"speed", value}};
}

using Done = WebCommands::Own::Done;

void add_fault_commands(OwnCommands& own, WebFaults& faults) {
  own["faults"] = {.role = WebRole::look,
                   .run = [&faults](const text::Json&, const Done& done) { done(faults.list()); }};
  own["run faults"] = {
      .role = WebRole::operate,
      .fields = {"bus", "seed", "faults"},
      .run = [&faults](const text::Json& wish, const Done& done) { done(faults.run(wish)); }};
  own["end fault"] = {.role = WebRole::operate,
                      .fields = {"bus", "number"},
                      .run = [&faults](const text::Json& wish, const Done& done) { done(faults.end(wish)); }};
}

void add_module_commands(OwnCommands& own, WebModules& modules) {
  const auto live_bus = [&modules](const text::Json& wish) { return modules.live_bus(wish); };
  own["clear errors"] = {
      .role = WebRole::operate,
      .fields = {"number"},
      .run = [&modules](const text::Json& wish, Done done) { modules.clear_errors(wish, std::move(done)); },
      .live_bus = live_bus};
  own["reset module"] = {
      .role = WebRole::operate,
      .fields = {"number"},
      .run = [&modules](const text::Json& wish, Done done) { modules.restart(wish, std::move(done)); },
      .live_bus = live_bus};
  own["write word"] = {
      .role = WebRole::operate,
      .fields = {"number", "address", "value"},
      .run = [&modules](const text::Json& wish, const Done& done) { done(modules.write_word(wish)); },
      .live_bus = live_bus};
}

void add_sending_commands(OwnCommands& own, FrameSending& sending) {
  own["send frames"] = {
      .role = WebRole::configure,
      .fields = {"bus", "frames", "interval", "repeat"},
      .run = [&sending](const text::Json& wish, Done done) { sending.send(wish, std::move(done)); },
      .live_bus = [&sending](const text::Json& wish) { return sending.live_bus(wish); }};
  own["stop frames"] = {.role = WebRole::configure,
                        .run = [&sending](const text::Json&, const Done& done) { done(sending.stop()); }};
}

/// Of the run, or with "file" of a recorded trace.
void add_trace_commands(OwnCommands& own, WebTrace& trace, TraceFiles& files) {
  own["trace"] = {.role = WebRole::look,
                  .is_noted = false,
                  .fields = {"filter", "fold", "from", "at", "count", "frames", "statistics", "file"},
                  .run = [&trace, &files](const text::Json& wish, Done done) {
                    if (wish.contains("file")) return files.query(wish, std::move(done));
                    trace.query(wish, std::move(done));
                  }};
  own["export trace"] = {.role = WebRole::look,
                         .is_noted = false,
                         .fields = {"filter", "format", "part", "file"},
                         .run = [&trace, &files](const text::Json& wish, Done done) {
                           if (wish.contains("file")) return files.export_part(wish, std::move(done));
                           trace.export_part(wish, std::move(done));
                         }};
  own["trace files"] = {.role = WebRole::operate,
                        .is_noted = false,
                        .run = [&files](const text::Json&, const Done& done) { done(files.list()); }};
  own["open trace"] = {
      .role = WebRole::operate,
      .fields = {"path", "upload"},
      .run = [&files](const text::Json& wish, Done done) { files.open(wish, std::move(done)); }};
  own["upload trace"] = {
      .role = WebRole::operate,
      .fields = {"name", "size"},
      .run = [&files](const text::Json& wish, const Done& done) { done(files.begin_upload(wish)); }};
  own["upload part"] = {
      .role = WebRole::operate,
      .is_noted = false,
      .fields = {"upload", "data"},
      .run = [&files](const text::Json& wish, Done done) { files.add_part(wish, std::move(done)); }};
  own["close trace"] = {
      .role = WebRole::operate,
      .is_noted = false,
      .fields = {"file"},
      .run = [&files](const text::Json& wish, const Done& done) { done(files.close(wish)); }};
}

void add_pace_command(OwnCommands& own, const WebPace& pace) {
  if (!pace.set_speed) return;
  own["pace"] = {.role = WebRole::operate,
                 .fields = {"speed", "run"},
                 .run = [pace](const text::Json& wish, const Done& done) { done(change_pace(pace, wish)); }};
}

void add_start_commands(OwnCommands& own, WebStart& start) {
  own["plants"] = {.role = WebRole::look,
                   .run = [&start](const text::Json&, const Done& done) { done(start.list()); }};
  own["open"] = {
      .role = WebRole::configure, .fields = {"path"}, .run = [&start](const text::Json& wish, Done done) {
        start.open(wish.value("path", ""), std::move(done));
      }};
  own["end"] = {.role = WebRole::configure,
                .fields = {"number"},
                .run = [&start](const text::Json& wish, const Done& done) {
                  const auto number = wish.find("number");
                  const bool is_number = number != wish.end() && number->is_number_unsigned();
                  start.end(is_number ? number->get<std::uint64_t>() : UINT64_MAX, done);
                }};
  own["new plant"] = {
      .role = WebRole::configure,
      .fields = {"name", "model", "bit_rate", "devices"},
      .run = [&start](const text::Json& wish, Done done) { start.make_plant(wish, std::move(done)); }};
  own["new project"] = {
      .role = WebRole::configure,
      .fields = {"name", "bit_rate", "devices"},
      .run = [&start](const text::Json& wish, Done done) { start.make_project(wish, std::move(done)); }};
  own["recent projects"] = {.role = WebRole::configure,
                            .is_noted = false,
                            .run = [&start](const text::Json&, const Done& done) { done(start.recent()); }};
  own["exit"] = {.role = WebRole::configure,
                 .run = [&start](const text::Json&, const Done& done) { start.exit(done); }};
  own["save as"] = {.role = WebRole::configure,
                    .fields = {"path", "name"},
                    .run = [&start](const text::Json& wish, Done done) {
                      start.save_settings_as(wish.value("path", ""), wish.value("name", ""), std::move(done));
                    }};
  own["new settings"] = {.role = WebRole::configure,
                         .fields = {"name", "model"},
                         .run = [&start](const text::Json& wish, Done done) {
                           start.make_settings(wish.value("name", ""), wish.value("model", ""),
                                               std::move(done));
                         }};
}

}  // namespace

WebPage::WebPage(boost::asio::io_context& io, plant::Plant& plant, link::LoopClock& clock, WebEvents& events,
                 std::vector<WebBus> buses, std::vector<WebSettings> settings, const WebFolders& folders,
                 WebAccess access, WebPace pace, const link::ClientReport& report)
    : plant_(plant),
      access_(std::move(access)),
      files_(PageFiles::of_program(ChildProcess::itself)),
      report_(report),
      events_(events),
      messages_(plant),
      views_(plant, events.boots()),
      trace_(io, plant, messages_.names()),
      trace_files_(io, folders.traces, messages_.names()),
      start_(folders.start.empty()
                 ? std::nullopt
                 : std::optional<WebStart>(std::in_place, io, folders.start, ChildProcess::itself, access_)),
      faults_(plant, clock),
      modules_(plant, clock),
      bus_commands_(io, plant, clock),
      frame_sending_(io, plant, clock),
      commands_(
          io,
          {.buses = std::move(buses),
           .settings = std::move(settings),
           .own = own_commands(pace, clock),
           .on_bus = [this](const WebCommandLine& line,
                            RunningCommand::Use use) { return bus_commands_.start(line, std::move(use)); },
           .now = [&plant] { return plant.timeline().now(); },
           .done = [this](const WebUser& user, const std::string& line, int code, const std::string& message,
                          WebRole role) { note(user, line, code, message, role); }}),
      server_(io, clock,
              {.state =
                   [this, &plant, pace] {
                     return state_event(plant, &views_.traffic(), &events_.boots(),
                                        pace.speed ? pace.speed() : 1);
                   },
               .lost = [&events](std::uint64_t count) { return events.lost(count); },
               .messages = [this](bool wanted) { return messages_.new_messages(wanted); },
               .view = [this](std::string_view view) { return views_.event_of(view); },
               .command = [this](const WebUser& user, std::string_view command, std::uint32_t id,
                                 WebReply reply) { commands_.run(user, command, id, std::move(reply)); },
               .note = [this](const WebUser& user, const std::string& what,
                              int code) { write(user, what, code, {}, WebRole::operate); }},
              options_of(access_, files_), report) {}

/// Those of docs/web.md that are no command line of the program.
std::map<std::string, WebCommands::Own, std::less<>> WebPage::own_commands(const WebPace& pace,
                                                                           link::LoopClock& clock) {
  OwnCommands own;
  own["domain words"] = {
      .role = WebRole::operate,
      .is_noted = false,
      .fields = {"bus", "object", "bytes"},
      .run = [this](const text::Json& wish, const Done& done) { done(domain_in_words(plant_, wish)); }};
  add_fault_commands(own, faults_);
  add_module_commands(own, modules_);
  add_sending_commands(own, frame_sending_);
  add_trace_commands(own, trace_, trace_files_);
  add_pace_command(own, pace);
  add_program_commands(own, plant_, clock);
  if (start_) add_start_commands(own, *start_);
  return own;
}

std::expected<void, std::string> WebPage::open_access() {
  if (!access_.users.empty()) {
    const auto users = read_web_users(access_.users);
    if (!users) return std::unexpected(users.error());
    if (users->empty()) {
      return std::unexpected(
          fmt::format("{}: expected a user; `canopus web-users add` makes one", access_.users));
    }
  }
  if (access_.audit_file().empty()) return {};
  auto audit = WebAudit::open(access_.audit_file());
  if (!audit) return std::unexpected(audit.error());
  audit_ = std::move(*audit);
  return {};
}

std::expected<void, std::string> WebPage::listen(const text::HostAndPort& place) {
  if (auto opened = open_access(); !opened) return opened;
  auto result = server_.listen(place.host, place.port);
  if (!result) return result;
  events_.set_listener([this](std::string_view event) { server_.event(event); });
  if (report_ && !files_) report_(fmt::format("{} ({})", PageFiles::missing, files_.error()));
  const auto address = link::parse_internet_address(place.host);
  const bool leaves_machine = address && !link::is_loopback(*address);
  if (report_ && leaves_machine && !access_.origin.starts_with("https://")) {
    report_("passwords and the page go over the network unencrypted; docs/web.md has TLS proxies and ssh");
  }
  return result;
}

void WebPage::note(const WebUser& user, const std::string& what, int code, const std::string& message,
                   WebRole role) {
  // Who may nothing would fill the log, and push everything else off the page, with what is refused.
  if (user.role == WebRole::look && code != 0) {
    const auto present = std::chrono::steady_clock::now();
    if (present - refused_since_ > std::chrono::seconds(1)) {
      refused_since_ = present;
      if (left_out_ != 0) {
        write({.name = "?"}, fmt::format("{} more that were refused", left_out_), code, {}, role);
      }
      refused_ = left_out_ = 0;
    }
    if (++refused_ > most_refused_a_second) {
      ++left_out_;
      return;
    }
  }
  write(user, what, code, message, role);
}

void WebPage::write(const WebUser& user, const std::string& what, int code, const std::string& message,
                    WebRole role) {
  const can::Time now = plant_.timeline().now();
  if (audit_) {
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    audit_->add(
        audit_line({.plant_time = can::seconds(now),
                    .milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(since).count(),
                    .user = user,
                    .what = what,
                    .code = code,
                    .message = one_line(message)}));
    if (const std::string trouble = audit_->next_trouble(); !trouble.empty() && report_) report_(trouble);
  }
  if (role == WebRole::look) return;
  text::Json event = plant::event_line(now, "audit");
  event["user"] = user.name;
  event["role"] = name_of(user.role);
  event["address"] = user.address;
  event["do"] = what;
  event["code"] = code;
  if (!message.empty()) event["message"] = one_line(message);
  server_.event(view_event(event));
}

void WebPage::close() {
  if (left_out_ != 0) {
    write({.name = "?"}, fmt::format("{} more that were refused", std::exchange(left_out_, 0)),
          web_code::not_allowed, {}, WebRole::operate);
  }
  events_.set_listener([](std::string_view) {});
  server_.stop();
}

}  // namespace canopus::web
