#include "canopus/web/commands/frame_sending.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/can/bus.hpp"
#include "canopus/client/sdo_transfer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/text/shortened.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/file/candump_log.hpp"
#include "canopus/web/commands/bus_command.hpp"
#include "canopus/web/commands/wish_fields.hpp"

namespace canopus::web {
namespace {

std::expected<can::Frame, std::string> parse_frame(const std::string& text) {
  constexpr std::string_view before = "(0.000000) page ";
  if (text.contains(' ')) return std::unexpected("expected a frame without blanks");
  auto entry = trace::read_candump_line(fmt::format("{}{}", before, text));
  if (!entry) {
    const std::size_t column =
        entry.error().column > before.size() ? entry.error().column - before.size() : 1;
    return std::unexpected(fmt::format("character {}: expected {}, found {}", column, entry.error().expected,
                                       entry.error().found));
  }
  if (entry->error_frame || !entry->log_form)
    return std::unexpected("expected a frame as candump writes it, for example 601#4018100100000000");
  return entry->frame;
}

/// Lines of a command, each "canopus: SENTENCE", as sentences.
std::string in_one_line(std::string errors) {
  constexpr std::string_view begin = "canopus: ";
  while (errors.ends_with('\n')) errors.pop_back();
  if (errors.starts_with(begin)) errors.erase(0, begin.size());
  for (std::size_t at = 0; (at = errors.find("\ncanopus: ", at)) != std::string::npos; at += 2)
    errors.replace(at, begin.size() + 1, "; ");
  return errors;
}

class FramesCommand final : public BusCommand {
 public:
  /// A frame that is not on the bus by then is not acknowledged, or the bus is full of others.
  static constexpr can::Duration longest_wait = std::chrono::seconds(2);

  template <typename... Rest>
  FramesCommand(std::string bus, FrameList list, Rest&&... rest)
      : BusCommand(std::forward<Rest>(rest)...), bus_(std::move(bus)), list_(std::move(list)) {
    alarm().add_part(next_at_);
    alarm().add_part(late_at_);
  }

 private:
  void begin(can::Time now) override {
    began_ = due_ = now;
    send_next(now);
  }
  void received(const can::Frame&, can::Time) override {}
  void ticked(can::Time now) override {
    if (now >= late_at_) return fail("a frame is not on the bus after 2 s", now);
    if (now >= next_at_) send_next(now);
  }
  void frame_sent(can::Time now) override {
    ++sent_;
    late_at_ = can::never;
    if (sent_ == list_.frames.size() * list_.repeat) return succeed(now);
    due_ = std::max(can::later(due_, list_.interval), list_.interval > can::Duration{} ? can::Time{} : now);
    if (due_ <= now) return send_next(now);
    next_at_ = due_;
  }
  void give_up(std::string_view why, can::Time now) override { fail(why, now); }

  void send_next(can::Time now) {
    next_at_ = can::never;
    late_at_ = can::later(now, longest_wait);
    if (!send(list_.frames[sent_ % list_.frames.size()])) fail(client::bus_takes_no_frame, now);
  }
  void succeed(can::Time now) {
    print({{"bus", bus_}, {"frames", sent_}, {"seconds", can::seconds(can::Time{now - began_})}});
    conclude(done, now);
  }
  void fail(std::string_view why, can::Time now) {
    next_at_ = can::never;
    late_at_ = can::never;
    complain(text::Line("{}: {} (sent: {} of {})", bus_, why, sent_,
                        ascii::counted(list_.frames.size() * list_.repeat, "frame")));
    conclude(failed, now);
  }

  std::string bus_;
  FrameList list_;
  can::Time began_{};
  can::Time due_{};  // of the frame that is sent next, or was last
  std::uint64_t sent_ = 0;
  can::Alarm next_at_;
  can::Alarm late_at_;
};

}  // namespace

std::expected<FrameList, std::string> FrameList::parse(const text::Json& wish) {
  FrameList list;
  const auto frames = wish.find("frames");
  if (frames == wish.end() || !frames->is_array() || frames->size() == 0 || frames->size() > most_frames)
    return std::unexpected(fmt::format("frames: expected a list of 1 to {} frames", most_frames));
  for (const text::Json& one : *frames) {
    const auto frame = one.is_string() ? parse_frame(one.get<std::string>())
                                       : std::unexpected(std::string("expected a text"));
    if (!frame) {
      const std::string shown = one.is_string() ? text::shortened(text::printable(one.string()), 40) : "";
      return std::unexpected(fmt::format("frame {} ({}): {}", list.frames.size() + 1, shown, frame.error()));
    }
    list.frames.push_back(*frame);
  }
  if (const auto interval = wish.find("interval"); interval != wish.end()) {
    const auto time = interval->is_string()
                          ? text::parse_duration(interval->get<std::string>())
                          : std::unexpected(std::string("expected a time, for example 10ms"));
    if (!time) return std::unexpected("interval: " + time.error());
    if (*time > longest_interval || *time < can::Duration{})
      return std::unexpected("interval: expected up to 60s");
    list.interval = *time;
  }
  if (wish.contains("repeat")) {
    const auto repeat = number_field(wish, "repeat", 1, most_repeats);
    if (!repeat) return std::unexpected(fmt::format("repeat: expected 1 to {}", most_repeats));
    list.repeat = *repeat;
  }
  if (list.frames.size() * list.repeat > most_sent) {
    return std::unexpected(fmt::format("{} frames, {} times: expected at most {} in all", list.frames.size(),
                                       list.repeat, most_sent));
  }
  return list;
}

FrameSending::~FrameSending() {
  for (const auto& one : started_)
    if (const auto command = one.lock()) command->stop();
}

std::expected<std::size_t, std::string> FrameSending::bus_of(const text::Json& wish) const {
  const std::string name = wish.value("bus", "");
  for (std::size_t i = 0; i < plant_.bus_count(); ++i)
    if (plant_.bus(i).name() == name) return i;
  return std::unexpected(fmt::format("there is no bus \"{}\"", text::printable(name)));
}

std::string FrameSending::live_bus(const text::Json& wish) const {
  const auto bus = bus_of(wish);
  if (!bus) return {};
  const plant::BusSection& section = plant_.bus_section(*bus);
  return section.is_linked() && section.replay.empty() ? section.name : std::string();
}

void FrameSending::send(const text::Json& wish, Done done) {
  const auto bus = bus_of(wish);
  if (!bus) return done(std::unexpected(bus.error()));
  const plant::BusSection& section = plant_.bus_section(*bus);
  if (!section.replay.empty())
    return done(std::unexpected(fmt::format("{} plays a recording, and takes no frames", section.name)));
  auto list = FrameList::parse(wish);
  if (!list) return done(std::unexpected(list.error()));
  std::erase_if(started_, [](const auto& one) { return one.expired(); });
  if (started_.size() >= most_at_once)
    return done(std::unexpected("other frames are being sent; stop them first, or wait"));
  serve::ClientPorts& ports = ports_
                                  .try_emplace(*bus, plant_.bus(*bus), plant_.timeline_of_bus(*bus),
                                               plant_.simulated_bus(*bus) != nullptr)
                                  .first->second;
  const auto row = std::make_shared<text::Json>();
  const auto command = std::make_shared<FramesCommand>(
      section.name, std::move(*list), io_, clock_, standstill_,
      RunningCommand::Use{
          .line = [row](const std::string& line) { *row = text::parse_json(line).value_or(text::Json()); },
          .ended =
              [row, done](int code, std::string errors) {
                if (code == 0) return done(std::move(*row));
                done(std::unexpected(in_one_line(std::move(errors))));
              }});
  started_.push_back(command);
  command->start(ports);
}

text::Json FrameSending::stop() {
  std::uint64_t stopped = 0;
  for (const auto& one : started_) {
    if (const auto command = one.lock()) {
      command->interrupt();
      ++stopped;
    }
  }
  return {{"stopped", stopped}};
}

}  // namespace canopus::web
