#include "canopus/sim/bus/waveform/waveform.hpp"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <numeric>
#include <string>
#include <utility>

#include "canopus/can/frame_bits.hpp"

namespace canopus::sim {
namespace {

using namespace std::chrono_literals;

/// The longest of 1 ns to 1 us that is at most a tenth of every bit, and of which all times are multiples.
can::Duration resolution_for(const Bus& bus, can::Duration grid) {
  const can::Duration of_all(std::gcd(bus.time_grid().count(), grid.count()));
  can::Duration shortest_bit = can::bit_time(1, bus.bit_rate());
  for (const Port* port : bus.ports()) {
    shortest_bit = std::min(shortest_bit, can::bit_time(1, port->bit_rate()));
  }
  const auto fits = [&](can::Duration resolution) {
    return resolution * 10 <= shortest_bit && of_all % resolution == can::Duration{};
  };
  can::Duration resolution = 1us;
  while (resolution > 1ns && !fits(resolution)) resolution /= 10;
  return resolution;
}

std::string word(std::string name) {
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name.empty() ? "_" : name;
}

}  // namespace

Waveform::Waveform(Bus& bus, can::Time now, Sink sink, can::Duration grid)
    : bus_(bus),
      ports_(bus.ports()),
      has_far_side_(bus.can_be_cut()),
      values_(far_side() + 1),
      text_(std::move(sink), resolution_for(bus, grid)),
      fields_(ports_.size()),
      moment_(now) {
  for (std::size_t number = 0; number < values_.size(); ++number) {
    codes_.push_back(WaveformText::code(number));
  }
  write_head();
  text_.time(now);
  write_first_values();
  bus_.add_observer(*this);
}

Waveform::~Waveform() {
  bus_.remove_observer(static_cast<WireObserver&>(*this));
  text_.hand_over();
}

/// The wire and what is driven are recessive, no port sends a flag, all are outside of a frame.
void Waveform::write_first_values() {
  text_.write("$dumpvars\n");
  const auto level = [this](std::size_t signal, bool high) {
    values_[signal] = high ? 1 : 0;
    text_.level(high, codes_[signal]);
  };
  const auto number = [this](std::size_t signal, unsigned value) {
    values_[signal] = static_cast<std::uint16_t>(value);
    text_.number(static_cast<int>(value), codes_[signal]);
  };
  level(0, true);
  for (std::size_t port = 0; port < ports_.size(); ++port) {
    level(signal(port, tx), true);
    level(signal(port, flag), false);
    level(signal(port, arbitration_part), false);
  }
  number(bus_field(), 0);
  for (std::size_t port = 0; port < ports_.size(); ++port) {
    number(value(port, tec), ports_[port]->transmit_error_counter());
    number(value(port, rec), ports_[port]->receive_error_counter());
    text_.number(WaveformFields::as_bus, codes_[value(port, field)]);
  }
  if (has_far_side_) level(far_side(), true);
  text_.write("$end\n");
}

void Waveform::write_head() {
  const auto nanoseconds = resolution().count();
  // Piece by piece: gcc 12 warns of its own std::string where literals are added to strings.
  const auto write = [this](std::initializer_list<std::string_view> pieces) {
    for (const std::string_view piece : pieces) text_.write(piece);
  };
  write({"$version Canopus $end\n$timescale ",
         nanoseconds == 1000  ? "1 us"
         : nanoseconds == 100 ? "100 ns"
         : nanoseconds == 10  ? "10 ns"
                              : "1 ns",
         " $end\n$scope module ", word(bus_.name()), " $end\n$var wire 1 ", codes_[0].name(), " can $end\n"});
  std::vector<std::string> names;
  for (std::size_t number = 0; number < ports_.size(); ++number) {
    std::string name = word(ports_[number]->name());
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      name += '_';
      name += std::to_string(number);
    }
    const auto declare = [&](Signal kind, std::string_view suffix) {
      write({"$var wire 1 ", codes_[signal(number, kind)].name(), " ", name, suffix, " $end\n"});
    };
    declare(tx, "_tx");
    declare(flag, "_flag");
    declare(arbitration_part, "_arb");
    names.push_back(std::move(name));
  }
  write({"$var real 64 ", codes_[bus_field()].name(), " field $end\n"});
  for (std::size_t number = 0; number < ports_.size(); ++number) {
    const auto declare = [&](Value kind, std::string_view suffix) {
      write({"$var real 64 ", codes_[value(number, kind)].name(), " ", names[number], suffix, " $end\n"});
    };
    declare(tec, "_tec");
    declare(rec, "_rec");
    declare(field, "_field");
  }
  if (has_far_side_) write({"$var wire 1 ", codes_[far_side()].name(), " can_far $end\n"});
  write({"$upscope $end\n$comment fields: -1 as field,"});
  for (unsigned number = 0; number < can::frame_fields; ++number) {
    write({number == 0 ? " " : ", ", std::to_string(number), " ",
           can::name(static_cast<can::FrameField>(number))});
  }
  write({" $end\n$enddefinitions $end\n"});
}

// For every bit the bus reports port after port, in their order: the search begins where the last one ended.
std::size_t Waveform::number_of(const Port& port) const noexcept {
  for (std::size_t looked = 0; looked < ports_.size(); ++looked) {
    if (ports_[last_] == &port) return last_;
    if (++last_ == ports_.size()) last_ = 0;
  }
  return ports_.size();
}

void Waveform::advance(can::Time now) {
  if (now >= idle_at_) {
    if (idle_at_ > moment_) settle_fields();
    moment_ = std::exchange(idle_at_, can::never);
    fields_.set_all(can::FrameField::idle);
  }
  if (now <= moment_) return;
  settle_fields();
  moment_ = now;
}

/// In an intermission that was reported as a whole, too: it is reported bit by bit from here on.
void Waveform::begin_change(can::Time now) {
  if (now < idle_at_) idle_at_ = can::never;
  advance(now);
}

void Waveform::settle_fields() {
  fields_.settle(
      [this](can::FrameField of_bus) {
        text_.time(moment_);
        text_.number(static_cast<int>(of_bus), codes_[bus_field()]);
      },
      [this](std::size_t port, int of_port) {
        text_.time(moment_);
        text_.number(of_port, codes_[value(port, field)]);
      });
}

void Waveform::change_level(std::size_t signal, bool high, can::Time now) {
  if ((values_[signal] != 0) == high) return;
  begin_change(now);
  values_[signal] = high ? 1 : 0;
  text_.time(now);
  text_.level(high, codes_[signal]);
}

void Waveform::change_number(std::size_t signal, unsigned value, can::Time now) {
  if (values_[signal] == value) return;
  begin_change(now);
  values_[signal] = static_cast<std::uint16_t>(value);
  text_.time(now);
  text_.number(static_cast<int>(value), codes_[signal]);
}

void Waveform::flush(can::Time now) {
  bus_.report_wire();
  advance(now);
  settle_fields();
  text_.time(now);
  text_.hand_over();
}

void Waveform::level_changed(bool dominant, can::Time now) { change_level(0, !dominant, now); }

void Waveform::far_level_changed(bool dominant, can::Time now) {
  if (has_far_side_) change_level(far_side(), !dominant, now);
}

void Waveform::field_changed(const Port& port, can::FrameField entered, can::Time now) {
  const std::size_t number = number_of(port);
  if (number == ports_.size() || (fields_.of(number) == entered && now < idle_at_)) return;
  begin_change(now);
  if (fields_.of(number) != entered) fields_.set(number, entered);
}

void Waveform::counters_changed(const Port& port, can::Time now) {
  const std::size_t number = number_of(port);
  if (number == ports_.size()) return;
  change_number(value(number, tec), port.transmit_error_counter(), now);
  change_number(value(number, rec), port.receive_error_counter(), now);
}

void Waveform::transmit_changed(const Port& port, bool dominant, can::Time now) {
  const std::size_t number = number_of(port);
  if (number < ports_.size()) change_level(signal(number, tx), !dominant, now);
}

void Waveform::activity_changed(const Port& port, bool flagging, bool arbitrating, can::Time now) {
  const std::size_t number = number_of(port);
  if (number == ports_.size()) return;
  change_level(signal(number, flag), flagging, now);
  change_level(signal(number, arbitration_part), arbitrating, now);
}

}  // namespace canopus::sim
