#include "canopus/web/state/traffic.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/can/frame_bits.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/sim/bus/controller/bit_controller.hpp"
#include "canopus/sim/bus/controller/bit_stream.hpp"
#include "canopus/web/state/view_fields.hpp"

namespace canopus::web {
namespace {

using Json = text::Json;

/// The field of a bit of a whole frame: by its number without stuff bits up to the CRC, then by its place before the end.
can::FrameField field_of(unsigned payload, unsigned header, std::size_t data, std::size_t bits_left,
                         bool extended) {
  if (bits_left <= 7) return can::FrameField::end_of_frame;
  if (bits_left == 8) return can::FrameField::ack_delimiter;
  if (bits_left == 9) return can::FrameField::ack_slot;
  if (bits_left == 10) return can::FrameField::crc_delimiter;
  if (payload < header) return sim::field_of_bit(payload, extended);
  return payload < header + data ? can::FrameField::data : can::FrameField::crc;
}

/// The place of a bit that is counted without stuff bits.
std::size_t place_of(const sim::BitStream& stream, unsigned plain) {
  std::size_t place = 0;
  for (unsigned seen = 0; place < stream.size; ++place) {
    if (!stream.bits[place].stuff && seen++ == plain) break;
  }
  return place;
}

/// The CAN-ID behind can::arbitration(), as people write it.
std::string identifier_of(std::uint32_t arbitration) {
  constexpr std::uint32_t substitute_and_ide = 3U << 19;
  const std::uint32_t base = arbitration >> 21;
  if ((arbitration & substitute_and_ide) != substitute_and_ide) return fmt::format("{:03X}", base);
  return fmt::format("{:08X}", base << 18 | (arbitration >> 1 & 0x3FFFF));
}

}  // namespace

void add_bits(Json& event, const can::Frame& frame) {
  const sim::BitStream stream(frame);
  const unsigned header = frame.extended ? 39 : 19;
  unsigned payload = 0;
  can::FrameField field = can::FrameField::start_of_frame;
  event["bits"] = Json::array();
  for (std::size_t i = 0; i < stream.size; ++i) {
    const sim::BitStream::Bit& bit = stream.bits[i];
    // A stuff bit belongs to the field of the bit before it.
    if (!bit.stuff) field = field_of(payload++, header, 8 * frame.length(), stream.size - i, frame.extended);
    // The transmitter sends the ACK slot recessive; the frame was completed, so a node acknowledged it.
    const bool dominant = bit.dominant || i == stream.ack_slot;
    Json one{{"level", dominant ? "d" : "r"}, {"field", name(field)}};
    if (bit.stuff) one["stuff"] = true;
    event["bits"].push_back(std::move(one));
  }
}

std::string_view name(FrameClass frame_class) noexcept {
  switch (frame_class) {
    case FrameClass::nmt: return "NMT";
    case FrameClass::sync: return "SYNC";
    case FrameClass::emcy: return "EMCY";
    case FrameClass::time: return "TIME";
    case FrameClass::pdo: return "PDO";
    case FrameClass::sdo: return "SDO";
    case FrameClass::error_control: return "error control";
    case FrameClass::lss: return "LSS";
    case FrameClass::other: return "other";
  }
  return "other";
}

// [CiA 301 7.3.5]
FrameClass class_of(const can::Frame& frame) noexcept {
  if (frame.extended) return FrameClass::other;
  const std::uint32_t id = frame.identifier;
  if (id == 0) return FrameClass::nmt;
  if (id == 0x080) return FrameClass::sync;
  if (id == 0x100) return FrameClass::time;
  if (id > 0x080 && id < 0x100) return FrameClass::emcy;
  if (id > 0x180 && id < 0x580) return FrameClass::pdo;
  if (id > 0x580 && id < 0x680) return FrameClass::sdo;
  if (id > 0x700 && id < 0x780) return FrameClass::error_control;
  if (id == 0x7E4 || id == 0x7E5) return FrameClass::lss;
  return FrameClass::other;
}

WebTraffic::WebTraffic(plant::Plant& plant) : plant_(plant) {
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    taps_.push_back(std::make_unique<Tap>());
    plant.bus(i).add_observer(*taps_.back());
  }
}

WebTraffic::~WebTraffic() {
  for (std::size_t i = 0; i < taps_.size(); ++i) plant_.bus(i).remove_observer(*taps_[i]);
}

/// The place of an identifier; nullptr: of 29 bits, and there is no room for another one.
WebTraffic::Seen* WebTraffic::seen_of(Bus& bus, std::uint32_t identifier, bool extended) noexcept {
  if (!extended) return &bus.seen[identifier & can::max_base_identifier];
  const auto place = std::ranges::find_if(bus.extended, [identifier](const Seen& one) {
    return one.frames == 0 || one.frame.identifier == identifier;
  });
  return place == bus.extended.end() ? nullptr : &*place;
}

ArbitrationProbe* WebTraffic::wire_of(std::size_t bus) {
  sim::Bus* const simulated = plant_.simulated_bus(bus);
  return simulated == nullptr ? nullptr : &wires_.try_emplace(bus, *simulated).first->second;
}

void WebTraffic::add_frame(Json& event, std::size_t bus, const Seen& seen) {
  event["frame"] = {{"can_id", fmt::format("{:0{}X}", seen.frame.identifier, seen.frame.extended ? 8 : 3)},
                    {"at", plant::event_seconds(seen.at)},
                    {"dlc", seen.frame.dlc},
                    {"remote", seen.frame.remote},
                    {"data", ascii::hex_bytes(seen.frame.bytes())}};
  add_bits(event["frame"], seen.frame);
  ArbitrationProbe* const wire = wire_of(bus);
  if (wire == nullptr) return;
  const ArbitrationProbe::Arbitration& arbitration =
      wire->arbitration_of(seen.frame.identifier, seen.frame.extended);
  if (arbitration.start != seen.start) return;  // the wire was not observed then
  const sim::BitStream stream(seen.frame);
  const auto ports = plant_.bus(bus).ports();
  event["frame"]["lost"] = Json::array();
  for (const sim::WireFrame::Sender& sender : arbitration.senders) {
    if (sender.lost_at == sim::WireFrame::Sender::won || sender.port >= ports.size()) continue;
    const std::size_t place = place_of(stream, sender.lost_at);
    if (place == stream.size) continue;
    event["frame"]["lost"].push_back({{"name", ports[sender.port]->name()},
                                      {"can_id", identifier_of(sender.arbitration)},
                                      {"bit", place}});
  }
}

/// The newest first; of that one the bits, as long as they are known: of the frame, of the flags, of the delimiter.
void WebTraffic::add_error_frames(Json& event, std::size_t bus) {
  const Bus& seen = taps_[bus]->bus;
  ArbitrationProbe* const wire = wire_of(bus);
  const can::Time now = plant_.timeline().now();
  event["error_frames"] = Json::array();
  for (std::size_t i = 1; i <= std::min(seen.next_error_frame, most_error_frames); ++i) {
    const ErrorFrame& one = seen.error_frames[(seen.next_error_frame - i) % most_error_frames];
    Json line{{"at", plant::event_seconds(one.at)},
              {"error", name(one.first.error)},
              {"field", name(one.first.field)},
              {"bit", one.first.bit},
              {"finders", one.finders},
              {"transmitter", one.first.transmitter}};
    if (one.first.port != nullptr) line["name"] = one.first.port->name();
    const bool is_in_frame =
        one.first.field > can::FrameField::idle && one.first.field <= can::FrameField::end_of_frame;
    if (i == 1 && wire != nullptr && is_in_frame) {
      const can::Duration bit = can::bit_time(1, plant_.bus(bus).bit_rate());
      constexpr unsigned delimiter = 8;
      constexpr int most_behind = 40;
      unsigned recessive = 0;
      Json bits = Json::array();
      for (int place = -static_cast<int>(one.first.bit); place <= most_behind && recessive < delimiter;
           ++place) {
        const can::Time at = one.at + place * bit;
        const auto dominant = at > now ? std::nullopt : wire->is_dominant(at);
        if (!dominant) break;
        recessive = *dominant ? 0 : recessive + 1;
        bits.push_back({{"level", *dominant ? "d" : "r"},
                        {"part", place <= 0  ? "frame"
                                 : *dominant ? "error flag"
                                             : "error delimiter"}});
      }
      if (recessive == delimiter) line["bits"] = std::move(bits);
    }
    event["error_frames"].push_back(std::move(line));
  }
}

void WebTraffic::Tap::frame_completed(const can::Frame& frame, can::Time start, can::Time end) {
  const auto place = static_cast<std::size_t>(class_of(frame));
  bus.busy[place] += end - start;
  ++bus.frames[place];
  bus.figures.frame_completed(frame, end);
  Seen* const seen = seen_of(bus, frame.identifier, frame.extended);
  if (seen == nullptr) return;
  ++seen->frames;
  seen->start = start;
  seen->at = end;
  seen->frame = frame;
}

void WebTraffic::Tap::errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) {
  for (const can::BusErrorReport& report : reports) {
    if (!report.first) continue;
    ++bus.errors[static_cast<std::size_t>(report.error)][static_cast<std::size_t>(report.field)];
    bus.error_frames[bus.next_error_frame++ % most_error_frames] = {now, report, reports.size()};
  }
}

const BusStatisticsView* WebTraffic::figures(std::string_view bus) const noexcept {
  for (std::size_t i = 0; i < taps_.size(); ++i) {
    if (plant_.bus(i).name() == bus) return &taps_[i]->bus.figures;
  }
  return nullptr;
}

std::string WebTraffic::event_of(const text::Json& wish) {
  const std::size_t number = view_number(wish, "traffic", SIZE_MAX);
  if (number >= taps_.size()) return {};
  const Bus& bus = taps_[number]->bus;
  Json event = plant::event_line(plant_.timeline().now(), "traffic");
  event["number"] = number;
  event["bus"] = plant_.bus(number).name();
  event["classes"] = Json::array();
  for (std::size_t i = 0; i < frame_classes; ++i) {
    event["classes"].push_back({{"class", name(static_cast<FrameClass>(i))},
                                {"frames", bus.frames[i]},
                                {"busy", can::seconds(can::Time{bus.busy[i]})}});
  }
  if (bus.figures.sync().count() != 0) event["sync"] = time_fields(bus.figures.sync());
  event["errors"] = Json::array();
  for (std::size_t error = 0; error < bus.errors.size(); ++error) {
    for (std::size_t field = 0; field < can::frame_fields; ++field) {
      if (bus.errors[error][field] == 0) continue;
      event["errors"].push_back({{"error", name(static_cast<can::BusError>(error))},
                                 {"field", name(static_cast<can::FrameField>(field))},
                                 {"count", bus.errors[error][field]}});
    }
  }
  add_error_frames(event, number);
  event["can_ids"] = Json::array();
  for (std::size_t id = 0; id < bus.seen.size(); ++id) {
    if (bus.seen[id].frames != 0) event["can_ids"].push_back(fmt::format("{:03X}", id));
  }
  std::vector<std::uint32_t> extended;
  for (const Seen& one : bus.extended) {
    if (one.frames != 0) extended.push_back(one.frame.identifier);
  }
  std::ranges::sort(extended);
  for (const std::uint32_t id : extended) event["can_ids"].push_back(fmt::format("{:08X}", id));
  const auto wanted = wish.find("can_id");
  if (wanted == wish.end() || !wanted->is_number_unsigned()) return view_event(event);
  const auto id = wanted->get<std::uint64_t>();
  const auto is_extended = wish.find("extended");
  if (is_extended != wish.end() && is_extended->is_boolean() && is_extended->get<bool>()) {
    const auto seen = std::ranges::find_if(
        bus.extended, [id](const Seen& one) { return one.frames != 0 && one.frame.identifier == id; });
    if (seen != bus.extended.end()) add_frame(event, number, *seen);
    return view_event(event);
  }
  if (id < bus.seen.size() && bus.seen[id].frames != 0) add_frame(event, number, bus.seen[id]);
  return view_event(event);
}

}  // namespace canopus::web
