#include "canopus/sim/bus/waveform.hpp"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <utility>

#include "canopus/can/frame_bits.hpp"

namespace canopus::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t flush_size = 64 * 1024;

/// The longest of 1 ns to 1 us that is at most a tenth of every bit, and of which every bit is a multiple.
can::Duration resolution_for(const Bus& bus) {
  std::vector<std::uint32_t> rates = {bus.bit_rate()};
  for (const Port* port : bus.ports()) rates.push_back(port->bit_rate());
  const auto fits = [&](can::Duration resolution) {
    return std::all_of(rates.begin(), rates.end(), [&](std::uint32_t rate) {
      const can::Duration bit = can::bit_time(1, rate);
      return resolution * 10 <= bit && bit % resolution == can::Duration{};
    });
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

Waveform::Waveform(Bus& bus, can::Time now, Sink sink)
    : bus_(bus),
      sink_(std::move(sink)),
      ports_(bus.ports()),
      far_(bus.can_be_cut() ? 1 + (std::size_t{signals_per_port} + values_per_port) * ports_.size() : 0),
      values_(1 + (std::size_t{signals_per_port} + values_per_port) * ports_.size() + (far_ > 0 ? 1 : 0)),
      resolution_(resolution_for(bus)) {
  write_head();
  write_time(now);
  text_ += "$dumpvars\n";
  for (std::size_t signal = 0; signal < values_.size(); ++signal) {
    // The wire and what is driven are recessive, nobody sends a flag, all are outside of a frame.
    if (signal < signals() || signal == far_) {
      values_[signal] = signal == 0 || signal == far_ || (signal - 1) % signals_per_port == tx ? 1 : 0;
    } else {
      const Port& port = *ports_[(signal - signals()) / values_per_port];
      const std::size_t kind = (signal - signals()) % values_per_port;
      values_[signal] = kind == tec   ? port.transmit_error_counter()
                        : kind == rec ? port.receive_error_counter()
                                      : std::uint16_t{0};
    }
    write_value(signal);
  }
  text_ += "$end\n";
  bus_.add_observer(*this);
}

Waveform::~Waveform() {
  bus_.remove_observer(static_cast<WireObserver&>(*this));
  if (!text_.empty()) sink_(text_);
}

void Waveform::write_head() {
  const auto nanoseconds = resolution_.count();
  // Piece by piece: gcc 12 warns of its own std::string where literals are added to strings.
  const auto write = [this](std::initializer_list<std::string_view> pieces) {
    for (const std::string_view piece : pieces) text_ += piece;
  };
  write({"$version Canopus $end\n$timescale ",
         nanoseconds == 1000  ? "1 us"
         : nanoseconds == 100 ? "100 ns"
         : nanoseconds == 10  ? "10 ns"
                              : "1 ns",
         " $end\n$scope module ", word(bus_.name()), " $end\n$var wire 1 ", code(0), " can $end\n"});
  std::vector<std::string> names;
  for (std::size_t number = 0; number < ports_.size(); ++number) {
    std::string name = word(ports_[number]->name());
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      name += '_';
      name += std::to_string(number);
    }
    const std::size_t signal = 1 + signals_per_port * number;
    write({"$var wire 1 ", code(signal + tx), " ", name, "_tx $end\n"});
    write({"$var wire 1 ", code(signal + flag), " ", name, "_flag $end\n"});
    write({"$var wire 1 ", code(signal + arbitration_part), " ", name, "_arb $end\n"});
    names.push_back(std::move(name));
  }
  for (std::size_t number = 0; number < ports_.size(); ++number) {
    const std::size_t value = signals() + values_per_port * number;
    write({"$var real 64 ", code(value + tec), " ", names[number], "_tec $end\n"});
    write({"$var real 64 ", code(value + rec), " ", names[number], "_rec $end\n"});
    write({"$var real 64 ", code(value + field), " ", names[number], "_field $end\n"});
  }
  if (far_ > 0) write({"$var wire 1 ", code(far_), " can_far $end\n"});
  write({"$upscope $end\n$comment fields:"});
  for (unsigned number = 0; number < can::frame_fields; ++number) {
    write({number == 0 ? " " : ", ", std::to_string(number), " ",
           can::name(static_cast<can::FrameField>(number))});
  }
  write({" $end\n$enddefinitions $end\n"});
}

std::string Waveform::code(std::size_t signal) {
  constexpr std::size_t digits = '~' - '!' + 1;
  std::string code;
  do {
    code += static_cast<char>('!' + signal % digits);
    signal /= digits;
  } while (signal > 0);
  return code;
}

// For every bit the bus reports port after port, in their order: the search begins where the last one ended.
std::size_t Waveform::number_of(const Port& port) const noexcept {
  for (std::size_t looked = 0; looked < ports_.size(); ++looked) {
    if (ports_[last_] == &port) return last_;
    if (++last_ == ports_.size()) last_ = 0;
  }
  return ports_.size();
}

std::size_t Waveform::first_signal(const Port& port) const noexcept {
  const std::size_t number = number_of(port);
  return number == ports_.size() ? 0 : 1 + signals_per_port * number;
}

std::size_t Waveform::first_value(const Port& port) const noexcept {
  const std::size_t signal = first_signal(port);
  return signal == 0 ? 0 : signals() + values_per_port * ((signal - 1) / signals_per_port);
}

void Waveform::write_time(can::Time now) {
  const std::int64_t time = now.time_since_epoch() / resolution_;
  if (time <= written_time_) return;
  written_time_ = time;
  text_ += '#';
  text_ += std::to_string(time);
  text_ += '\n';
}

void Waveform::write_value(std::size_t signal) {
  const unsigned value = values_[signal];
  if (signal < signals() || signal == far_) {
    text_ += value != 0 ? '1' : '0';
  } else {
    text_ += 'r';  // libsigrok 0.5.2 stops at a vector
    text_ += std::to_string(value);
    text_ += ' ';
  }
  text_ += code(signal);
  text_ += '\n';
}

void Waveform::change(std::size_t signal, unsigned value, can::Time now) {
  if (values_[signal] == value) return;
  values_[signal] = static_cast<std::uint16_t>(value);
  write_time(now);
  write_value(signal);
  if (text_.size() >= flush_size) {
    sink_(text_);
    text_.clear();
  }
}

void Waveform::flush(can::Time now) {
  write_time(now);
  sink_(text_);
  text_.clear();
}

void Waveform::level_changed(bool dominant, can::Time now) { change(0, dominant ? 0 : 1, now); }

void Waveform::field_changed(const Port& port, can::FrameField place, can::Time now) {
  const std::size_t value = first_value(port);
  if (value != 0) change(value + field, static_cast<unsigned>(place), now);
}

void Waveform::bit_sampled(const Port& port, can::Time now) {
  const std::size_t value = first_value(port);
  if (value == 0) return;
  change(value + tec, port.transmit_error_counter(), now);
  change(value + rec, port.receive_error_counter(), now);
}

void Waveform::far_level_changed(bool dominant, can::Time now) {
  if (far_ > 0) change(far_, dominant ? 0 : 1, now);
}

void Waveform::transmit_changed(const Port& port, bool dominant, can::Time now) {
  if (const std::size_t signal = first_signal(port); signal != 0) change(signal + tx, dominant ? 0 : 1, now);
}

void Waveform::activity_changed(const Port& port, bool flagging, bool arbitrating, can::Time now) {
  const std::size_t signal = first_signal(port);
  if (signal == 0) return;
  change(signal + flag, flagging ? 1 : 0, now);
  change(signal + arbitration_part, arbitrating ? 1 : 0, now);
}

}  // namespace canopus::sim
