#include "canopus/client/plc_module.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"

namespace canopus::client {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;
template <typename Value>
using Result = module_settings::ModuleAccess::Result<Value>;

// Command interface [FX3U-CAN 10].
constexpr std::uint32_t status_word = 25;
constexpr std::uint32_t command_word = 1000;
constexpr std::uint32_t command_words = 67;
constexpr std::uint16_t busy = 0xFFFF;
constexpr std::uint16_t refused = 0x000F;
constexpr std::uint16_t sdo_error = 0x0003;
constexpr std::uint16_t no_further = 0xFFFF;
constexpr std::size_t most_objects = 8;
constexpr std::size_t most_bytes = 124;
constexpr auto patience = 40s;  // longer than the longest SDO time-out

// Y and X of the same number belong together [RJ71CN91 App.1].
constexpr std::uint32_t restart_signal = 0x02, error_clear_signal = 0x0F, command_signal = 0x17,
                        save_signal = 0x1F;

std::string abort_text(std::uint32_t code) {
  return fmt::format("abort {:08X}H, {}", code, canopen::describe(static_cast<canopen::AbortCode>(code)));
}

/// The meaning of #1001 when #1000 is 000FH.
std::string reason_of(std::span<const std::uint16_t> words) {
  if (words[0] != refused) return fmt::format("the command interface answers #1000 = {:04X}H", words[0]);
  switch (words[1]) {
    case sdo_error: return abort_text(static_cast<std::uint32_t>(words[4]) << 16 | words[3]);
    case 0x0064: return "the module does not know this command in its function mode";
    case 0x0F0F: return "the module's state does not allow it";
    case 0x8FFF: return "the module's transmit queue is full: too much load on the bus";
    case 0xB0FF: return "the module is bus-off";
    case 0xFFFF: return "another program wrote to the command interface at the same time";
    default: return fmt::format("error class {:04X}H", words[1]);
  }
}

PlcPoint buffer_word(std::uint16_t unit, std::uint32_t address) {
  PlcPoint point;
  point.at.is_buffer = true;
  point.at.head_address = static_cast<std::uint16_t>(unit * 16);
  point.at.number = address;
  return point;
}

PlcPoint signal(plc::Device device, std::uint16_t unit, std::uint32_t number) {
  PlcPoint point;
  point.at.device = device;
  point.at.number = unit * 16U + number;
  return point;
}

}  // namespace

Result<void> PlcModule::set_signal(std::uint32_t number, bool on) {
  const std::uint8_t bit = on ? 1 : 0;
  return client_.write_bits(signal(plc::Device::y, unit_, number), std::span(&bit, 1));
}

Result<void> PlcModule::wait_for_signal(std::uint32_t number, bool on, const char* what) {
  const auto end = Clock::now() + patience;
  while (true) {
    const auto bits = client_.read_bits(signal(plc::Device::x, unit_, number), 1);
    if (!bits) return std::unexpected(bits.error());
    if ((bits->front() != 0) == on) return {};
    if (Clock::now() > end) {
      return std::unexpected(
          fmt::format("{}: X{:02X} of the module stays {}", what, number, on ? "OFF" : "ON"));
    }
    std::this_thread::sleep_for(1ms);
  }
}

template <typename Work>
Result<void> PlcModule::handshake(std::uint32_t number, const char* what, Work work) {
  if (const auto set = set_signal(number, true); !set) return set;
  if (const auto ended = wait_for_signal(number, true, what); !ended) {
    (void)set_signal(number, false);
    return ended;
  }
  const Result<void> worked = work();
  if (const auto set = set_signal(number, false); !set) return set;
  if (const auto ready = wait_for_signal(number, false, what); !ready) return ready;
  return worked;
}

Result<std::vector<std::uint16_t>> PlcModule::read_words(std::uint32_t address, std::uint32_t count) {
  return client_.read_words(buffer_word(unit_, address), count);
}

Result<void> PlcModule::write_words(std::uint32_t address, std::span<const std::uint16_t> words) {
  return client_.write_words(buffer_word(unit_, address), words);
}

Result<std::uint16_t> PlcModule::read_word(std::uint32_t address) {
  const auto words = read_words(address, 1);
  if (!words) return std::unexpected(words.error());
  return words->front();
}

Result<void> PlcModule::write_word(std::uint32_t address, std::uint16_t value) {
  if (const auto written = write_words(address, std::span(&value, 1)); !written) return written;
  const auto found = read_word(address);
  if (!found) return std::unexpected(found.error());
  if (*found != value) return std::unexpected(fmt::format("the module shows {} afterwards", *found));
  return {};
}

Result<void> PlcModule::wait_for_zero(std::uint32_t address, std::uint16_t bits, const char* what) {
  const auto end = Clock::now() + patience;
  while (true) {
    const auto word = read_word(address);
    if (!word) return std::unexpected(word.error());
    if ((*word & bits) == 0) return {};
    if (Clock::now() > end)
      return std::unexpected(fmt::format("{} does not end: #{} = {:04X}H", what, address, *word));
    std::this_thread::sleep_for(2ms);
  }
}

Result<std::vector<std::uint16_t>> PlcModule::command(std::uint16_t code,
                                                      std::span<const std::uint16_t> parameters) {
  if (method_ == module::RequestMethod::signals) {
    // One that was broken off may have left its request.
    if (const auto set = set_signal(command_signal, false); !set) return std::unexpected(set.error());
    if (const auto ready = wait_for_signal(command_signal, false, "the command interface"); !ready)
      return std::unexpected(ready.error());
  }
  const auto before = read_word(command_word);
  if (!before) return std::unexpected(before.error());
  if (*before == busy)
    return std::unexpected("the command interface is busy (#1000 = FFFFH): put the CPU into STOP");
  if (const auto written = write_words(command_word + 1, parameters); !written)
    return std::unexpected(written.error());
  if (const auto written = write_words(command_word, std::span(&code, 1)); !written)
    return std::unexpected(written.error());
  if (method_ == module::RequestMethod::signals) {
    Result<std::vector<std::uint16_t>> words;
    const auto done = handshake(command_signal, "the command interface", [&]() -> Result<void> {
      words = read_words(command_word, command_words);
      return {};
    });
    if (!done) return std::unexpected(done.error());
    return words;
  }
  const auto end = Clock::now() + patience;
  while (true) {
    auto words = read_words(command_word, command_words);
    if (!words) return std::unexpected(words.error());
    if (words->front() != busy) return words;
    if (Clock::now() > end) return std::unexpected("the command interface stays busy (#1000 = FFFFH)");
    std::this_thread::sleep_for(1ms);
  }
}

Result<std::vector<std::uint32_t>> PlcModule::read_objects(
    std::uint8_t node, std::span<const module_settings::ObjectNumber> objects) {
  constexpr std::uint16_t multi_read = 0x0008, all_read = 0x0009, not_all_read = 0x00F9;
  std::vector<std::uint32_t> values;
  while (!objects.empty()) {
    const auto now = objects.first(std::min(objects.size(), most_objects));
    objects = objects.subspan(now.size());
    std::vector<std::uint16_t> parameters;
    for (const module_settings::ObjectNumber& object : now) {
      parameters.insert(parameters.end(), {node, object.index, object.sub, 0, 0, 0, 0, 0});
    }
    if (now.size() < most_objects) parameters.push_back(no_further);
    const auto words = command(multi_read, parameters);
    if (!words) return std::unexpected(words.error());
    if (words->front() != all_read && words->front() != not_all_read)
      return std::unexpected(reason_of(*words));
    for (std::size_t i = 0; i < now.size(); ++i) {
      const std::span<const std::uint16_t> slot = std::span(*words).subspan(1 + 8 * i, 8);
      const std::uint32_t value = static_cast<std::uint32_t>(slot[5]) << 16 | slot[4];
      if ((slot[0] & 0xFF00) != 0) {
        return std::unexpected(canopen::object_text(now[i].index, now[i].sub) + ": " + abort_text(value));
      }
      values.push_back(slot[3] >= 4 ? value : value & ((1U << 8 * slot[3]) - 1));
    }
  }
  return values;
}

Result<void> PlcModule::write_object(std::uint8_t node, module_settings::ObjectNumber object,
                                     std::uint32_t value, std::uint8_t bytes) {
  std::vector<std::uint8_t> data;
  for (unsigned i = 0; i < bytes; ++i) data.push_back(static_cast<std::uint8_t>(value >> 8 * i));
  return write_bytes(node, object, data);
}

Result<std::vector<std::uint8_t>> PlcModule::read_bytes(std::uint8_t node,
                                                        module_settings::ObjectNumber object) {
  constexpr std::uint16_t sdo_read = 0x0004, success = 0x0005;
  const std::uint16_t parameters[] = {node, object.index, object.sub};
  const auto words = command(sdo_read, parameters);
  if (!words) return std::unexpected(words.error());
  if (words->front() != success) return std::unexpected(reason_of(*words));
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < std::min<std::size_t>((*words)[4], most_bytes); ++i) {
    bytes.push_back(static_cast<std::uint8_t>((*words)[5 + i / 2] >> 8 * (i % 2)));
  }
  return bytes;
}

Result<void> PlcModule::write_bytes(std::uint8_t node, module_settings::ObjectNumber object,
                                    std::span<const std::uint8_t> bytes) {
  constexpr std::uint16_t sdo_write = 0x0002, success = 0x0003;
  if (bytes.empty() || bytes.size() > most_bytes) {
    return std::unexpected(
        fmt::format("{} bytes: the command interface takes 1 to {}", bytes.size(), most_bytes));
  }
  std::vector<std::uint16_t> parameters{node, object.index, object.sub,
                                        static_cast<std::uint16_t>(bytes.size())};
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    const unsigned high = i + 1 < bytes.size() ? bytes[i + 1] : 0;
    parameters.push_back(static_cast<std::uint16_t>(bytes[i] | high << 8));
  }
  const auto words = command(sdo_write, parameters);
  if (!words) return std::unexpected(words.error());
  if (words->front() != success) return std::unexpected(reason_of(*words));
  return {};
}

Result<void> PlcModule::save_words() {
  constexpr std::uint32_t save_word = 22;
  constexpr std::uint16_t save = 1;
  if (const auto written = write_words(save_word, std::span(&save, 1)); !written) return written;
  if (method_ == module::RequestMethod::signals)
    return handshake(save_signal, "saving", [] { return Result<void>(); });
  return wait_for_zero(save_word, save, "saving");
}

Result<void> PlcModule::wait_until_ready() {
  constexpr std::uint16_t initialising = 0x80;
  return wait_for_zero(status_word, initialising, "the module's start");
}

Result<void> PlcModule::restart() {
  if (method_ == module::RequestMethod::signals)
    return handshake(restart_signal, "the restart", [&] { return wait_until_ready(); });
  constexpr std::uint16_t restart = 1;
  if (const auto written = write_words(status_word, std::span(&restart, 1)); !written) return written;
  std::this_thread::sleep_for(20ms);
  return wait_until_ready();
}

Result<void> PlcModule::clear_errors() {
  if (method_ == module::RequestMethod::signals) {
    if (const auto set = set_signal(error_clear_signal, true); !set) return set;
    return set_signal(error_clear_signal, false);
  }
  constexpr std::uint32_t error_word = 29;
  constexpr std::uint16_t nothing = 0;
  return write_words(error_word, std::span(&nothing, 1));
}

Result<bool> PlcModule::cpu_stands_still() {
  PlcPoint run;
  run.at.device = plc::Device::sd;
  run.at.number = 203;
  if (const auto words = client_.read_words(run, 1))
    return (words->front() & 0xF) != 0;  // 0 RUN, 2 STOP, 3 PAUSE
  run.at.device = plc::Device::m;
  run.at.number = 8000;
  const auto bits = client_.read_bits(run, 1);
  if (!bits) return std::unexpected(bits.error());
  return bits->front() == 0;
}

}  // namespace canopus::client
