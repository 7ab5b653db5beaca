#include "canopus/trace/print/message_printer.hpp"

#include <algorithm>
#include <chrono>

#include "canopus/ascii/hex.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/local_time.hpp"
#include "canopus/trace/decode/value_text.hpp"

namespace canopus::trace {
namespace {

constexpr std::size_t widest_column = 32;

/// A colour for important messages.
std::string_view colour_of(const Message& message) {
  if (message.is_malformed) return "31";
  switch (message.service) {
    case Service::emcy: return message.emcy_code.value_or(0) == 0 ? "32" : "31";
    case Service::error_frame: return "31";
    case Service::sdo:
      return message.abort_code || (message.is_transfer && message.end != TransferEnd::done) ? "31" : "";
    case Service::nmt: return "33";
    case Service::error_control: return message.kind == "boot-up" ? "33" : "2";
    case Service::sync: return "2";
    default: return "";
  }
}

std::string identifier_text(const can::Frame& frame) {
  return frame.extended ? fmt::format("{:08X}", frame.identifier) : fmt::format("{:03X}", frame.identifier);
}

std::string bytes_text(const can::Frame& frame) {
  if (frame.remote) return fmt::format("[{}] remote", frame.dlc);
  return fmt::format("[{}] {}", frame.length(), hexadecimal(frame.bytes()));
}

/// The text filled up with blanks; the column grows with what comes, up to a limit.
std::string padded(std::string_view text, std::size_t& width) {
  std::string printable = text::printable(text);
  std::size_t columns = text::columns_of(printable);
  if (columns > widest_column) {
    printable = std::string(text::clipped(printable, widest_column - 2)) + "..";
    columns = text::columns_of(printable);
  }
  width = std::max(width, columns);
  return printable + std::string(width - columns, ' ');
}

std::string date_text(can::Time time) {
  const auto since = std::chrono::sys_time<std::chrono::nanoseconds>(time.time_since_epoch());
  const auto whole = std::chrono::floor<std::chrono::seconds>(since);
  const auto local = text::local_time(whole);
  const auto day = std::chrono::floor<std::chrono::days>(local);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(local - day);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}.{:06}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     (since - whole).count() / 1000);
}

}  // namespace

std::string service_text(const Message& message) {
  switch (message.service) {
    case Service::nmt: return "NMT";
    case Service::failsafe: return "failsafe";
    case Service::flying_master: return "flying master";
    case Service::sync: return "SYNC";
    case Service::time: return "TIME";
    case Service::emcy: return "EMCY";
    case Service::pdo:
      return fmt::format("{}{}", message.kind.starts_with('T') ? "TPDO" : "RPDO", message.pdo);
    case Service::mpdo: return fmt::format("MPDO {}", message.kind);
    case Service::sdo: return "SDO";
    case Service::error_control:
      return message.kind.starts_with("guarding") ? "guarding" : std::string(message.kind);
    case Service::lss: return "LSS";
    case Service::layer2: return "Layer 2";
    case Service::error_frame: return "error frame";
  }
  return "?";
}

std::string object_text(const Message& message) {
  if (!message.index) return {};
  std::string text = canopen::object_text(*message.index, message.sub);
  if (!message.object_name.empty()) text += ' ' + message.object_name;
  return text;
}

std::string searched_text(const Message& message, std::string_view bus) {
  return fmt::format("{} {} {} {} {} {}{}", bus, service_text(message), node_text(message),
                     object_text(message), message.kind, message.is_malformed ? "malformed " : "",
                     message.text);
}

std::string MessagePrinter::time_text(can::Time time) {
  const can::Time before = last_.value_or(time);
  last_ = time;
  switch (options_.time) {
    case TimeColumn::date: return date_text(time);
    case TimeColumn::absolute: return fmt::format("{:.6f}", can::seconds(time));
    case TimeColumn::delta:
      return fmt::format("{:11.6f}", std::chrono::duration<double>(time - before).count());
    case TimeColumn::zero: break;
  }
  return fmt::format("{:11.6f}", std::chrono::duration<double>(time - zero_).count());
}

void MessagePrinter::print(const Message& message, std::string_view channel) {
  if (options_.json) return out_.json(to_json(message, channel));
  text::Line line("{}  ", time_text(message.time));
  if (!channel.empty()) line.add("{}  ", padded(channel, channel_width_));
  line.add("{:>3}  {:<13}  {}  ", identifier_text(message.frame), service_text(message),
           padded(node_text(message), node_width_));
  if (options_.frames && !message.is_transfer) line.add("{:<27}  ", bytes_text(message.frame));
  std::string text = message.is_malformed ? "malformed: " + message.text : message.text;
  if (message.is_copy) text += " (recorded twice)";
  line.add("{}", text::paint(text, colour_of(message), options_.colour && !colour_of(message).empty()));
  out_.line(line);
}

text::Json to_json(const Message& message, std::string_view channel) {
  text::Json json;
  json["time"] = can::seconds(message.time);
  if (!channel.empty()) json["channel"] = channel;
  json["id"] = identifier_text(message.frame);
  if (message.frame.remote) json["remote"] = true;
  json["service"] = name(message.service);
  json["kind"] = message.kind;
  if (message.node != 0 || message.service == Service::nmt) json["node"] = message.node;
  if (!message.node_name.empty()) json["name"] = message.node_name;
  if (message.pdo != 0) json["pdo"] = message.pdo;
  if (message.index) {
    json["index"] = fmt::format("{:04X}", *message.index);
    json["sub"] = message.sub;
  }
  if (!message.object_name.empty()) json["object"] = message.object_name;
  if (!message.data.empty()) json["data"] = ascii::hex_bytes(message.data);
  for (const Signal& signal : message.signals) {
    text::Json one;
    one["object"] = canopen::object_text(signal.index, signal.sub);
    if (!signal.name.empty()) one["name"] = signal.name;
    if (signal.number) {
      one["value"] = *signal.number;
    } else {
      one["value"] = signal.value;
    }
    if (!signal.unit.empty()) one["unit"] = signal.unit;
    if (!signal.words.empty()) one["words"] = signal.words;
    json["signals"].push_back(std::move(one));
  }
  if (message.emcy_code) json["emcy"] = fmt::format("{:04X}", *message.emcy_code);
  if (message.abort_code) {
    json["abort"] = fmt::format("{:08X}", *message.abort_code);
    json["abort_text"] = canopen::describe(static_cast<canopen::AbortCode>(*message.abort_code));
  }
  if (message.is_transfer) {
    json["end"] = name(message.end);
    json["size"] = message.size;
    json["frames"] = message.frames;
    json["duration_ms"] = static_cast<double>(message.duration.count()) / 1e6;
  }
  if (message.is_copy) json["copy"] = true;
  if (message.is_malformed) json["malformed"] = true;
  json["text"] = message.text;
  return json;
}

}  // namespace canopus::trace
