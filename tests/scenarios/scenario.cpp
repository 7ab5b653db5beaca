#include "scenarios/scenario.hpp"

#include <cstdio>
#include <tuple>

#include "canopus/module/interface/communication_module.hpp"

namespace canopus::scenario {

namespace {

std::string hex(unsigned value, int digits) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%0*X", digits, value);
  return text.data();
}

}  // namespace

std::string text(const can::Frame& frame) {
  std::string result = hex(frame.identifier, frame.extended ? 8 : 3);
  if (frame.remote) return result + " RTR";
  result += " [";
  for (std::size_t i = 0; i < frame.length(); ++i) result += (i == 0 ? "" : " ") + hex(frame.data[i], 2);
  return result + "]";
}

module::NonVolatileMemory::Content RamMemory::read(std::string_view name) {
  const auto found = blobs.find(name);
  return found == blobs.end() ? Content{} : found->second;
}

bool RamMemory::write(std::string_view name, std::span<const std::uint8_t> bytes) {
  if (!writable) return false;
  ++writes;
  blobs[std::string(name)] = {Content::State::good, {bytes.begin(), bytes.end()}};
  return true;
}

bool RamMemory::erase(std::string_view name) {
  if (!writable) return false;
  if (const auto found = blobs.find(name); found != blobs.end()) blobs.erase(found);
  return true;
}

bool FreeBus::send(const can::Frame& frame) {
  if (!accepts) {
    ++overflows;
    return false;
  }
  sent.push_back(frame);
  if (completes) completing.push_back(frame);
  return true;
}

can::ErrorState FreeBus::error_state() const {
  if (transmit_errors >= 256) return can::ErrorState::bus_off;
  return transmit_errors >= 128 || receive_errors >= 128 ? can::ErrorState::error_passive
                                                         : can::ErrorState::error_active;
}

void FreeBus::restart(std::uint32_t bit_rate) {
  rate = bit_rate;
  transmit_errors = receive_errors = 0;
  overflows = lost = 0;
  completing.clear();
}

ModuleScenario::~ModuleScenario() {
  if (!bus_->sent.empty()) {
    ADD_FAILURE() << "at the end: the module sent " << text(bus_->sent.front())
                  << (bus_->sent.size() > 1 ? " and more" : "") << ", which no step expected";
  }
}

void ModuleScenario::failed(const Where& where, const std::string& what) const {
  ADD_FAILURE_AT(where.file_name(), static_cast<int>(where.line()))
      << "at " << std::to_string(can::seconds(now_)) << " s, step " << steps_ << ": " << what;
}

// What the module's last call caused at this very moment: frames complete, deadlines that are now.
void ModuleScenario::settle() {
  ++steps_;
  step_to(now_);
}

void ModuleScenario::step_to(can::Time end) {
  for (unsigned rounds = 0;; ++rounds) {
    if (rounds > 1'000'000) {
      failed(Where::current(), "the module's deadline does not move on");
      return;
    }
    if (!bus_->completing.empty()) {
      const auto frames = std::exchange(bus_->completing, {});
      for (const can::Frame& frame : frames) module_->transmitted(frame, now_);
      continue;
    }
    const can::Time deadline = module_->deadline();
    if (deadline > end) break;
    now_ = std::max(now_, deadline);
    module_->tick(now_);
  }
  now_ = end;
}

template <typename Condition>
bool ModuleScenario::run_until(Condition condition, can::Duration at_most) {
  ++steps_;
  const can::Time end = now_ + at_most;
  step_to(now_);
  while (!condition()) {
    const can::Time next = module_->deadline();
    if (next > end) {
      now_ = end;
      return false;
    }
    step_to(std::max(now_, next));
  }
  return true;
}

ModuleScenario& ModuleScenario::write(module::BufferAddress address, std::uint16_t value) {
  words_->write_word(address, value, now_);
  settle();
  return *this;
}

ModuleScenario& ModuleScenario::write(module::BufferAddress first, const Words& values) {
  for (const std::uint16_t value : values) words_->write_word(first++, value, now_);
  settle();
  return *this;
}

ModuleScenario& ModuleScenario::y(unsigned number, bool on) {
  signals_->set_output(number, on, now_);
  settle();
  return *this;
}

ModuleScenario& ModuleScenario::expect(module::BufferAddress address, std::uint16_t value, Where where) {
  const std::uint16_t found = read(address);
  if (found != value) {
    failed(where, "G" + std::to_string(address) + " reads " + hex(found, 4) + "H (" + std::to_string(found) +
                      "), expected " + hex(value, 4) + "H (" + std::to_string(value) + ")");
  }
  return *this;
}

ModuleScenario& ModuleScenario::expect(module::BufferAddress first, const Words& values, Where where) {
  for (const std::uint16_t value : values) expect(first++, value, where);
  return *this;
}

ModuleScenario& ModuleScenario::expect_bit(module::BufferAddress address, unsigned bit, bool on,
                                           Where where) {
  if ((read(address) >> bit & 1U) != (on ? 1U : 0U)) {
    failed(where, "G" + std::to_string(address) + "." + std::to_string(bit) + " is " + (on ? "0" : "1") +
                      ", expected " + (on ? "1" : "0"));
  }
  return *this;
}

ModuleScenario& ModuleScenario::expect_x(unsigned number, bool on, Where where) {
  if (x(number) != on) failed(where, "X" + hex(number, 2) + " is " + (on ? "OFF" : "ON"));
  return *this;
}

ModuleScenario& ModuleScenario::wait_x(unsigned number, bool on, can::Duration at_most, Where where) {
  if (!run_until([&] { return x(number) == on; }, at_most)) {
    failed(where, "X" + hex(number, 2) + " did not go " + (on ? "ON" : "OFF"));
  }
  return *this;
}

ModuleScenario& ModuleScenario::wait_bit(module::BufferAddress address, unsigned bit, bool on,
                                         can::Duration at_most, Where where) {
  if (!run_until([&] { return (read(address) >> bit & 1U) == (on ? 1U : 0U); }, at_most)) {
    failed(where,
           "G" + std::to_string(address) + "." + std::to_string(bit) + " did not become " + (on ? "1" : "0"));
  }
  return *this;
}

ModuleScenario& ModuleScenario::rx(std::uint32_t identifier, const Bytes& bytes) {
  return rx(can::data_frame(identifier, bytes));
}

ModuleScenario& ModuleScenario::rx(const can::Frame& frame) {
  using module::CommunicationModule;
  auto* const module = dynamic_cast<CommunicationModule*>(module_);
  if (module == nullptr) {
    module_->receive(frame, now_);
  } else {
    const auto shown = [&] {
      return std::tuple(module->node().state(), module->layer2_state(), module->start_up());
    };
    const auto before = shown();
    const std::uint64_t changes = module->change_count();
    module->receive(frame, now_);
    if (module->change_count() == changes) {
      EXPECT_EQ(shown(), before) << text(frame) << ": nobody would look at it";
    }
  }
  settle();
  return *this;
}

ModuleScenario& ModuleScenario::rx_remote(std::uint32_t identifier, std::uint8_t dlc) {
  return rx(can::remote_frame(identifier, dlc));
}

void ModuleScenario::expect_frame(const can::Frame& expected, const Where& where) {
  if (bus_->sent.empty()) return failed(where, "expected the frame " + text(expected) + ", nothing was sent");
  const can::Frame frame = bus_->sent.front();
  bus_->sent.pop_front();
  if (frame != expected) failed(where, "sent " + text(frame) + ", expected " + text(expected));
}

ModuleScenario& ModuleScenario::tx(std::uint32_t identifier, const Bytes& bytes, Where where) {
  expect_frame(can::data_frame(identifier, bytes), where);
  return *this;
}

ModuleScenario& ModuleScenario::tx(const can::Frame& frame, Where where) {
  expect_frame(frame, where);
  return *this;
}

ModuleScenario& ModuleScenario::tx_remote(std::uint32_t identifier, Where where) {
  if (bus_->sent.empty()) {
    failed(where, "expected the remote frame " + hex(identifier, 3) + ", nothing was sent");
    return *this;
  }
  const can::Frame frame = bus_->sent.front();
  bus_->sent.pop_front();
  if (!frame.remote || frame.identifier != identifier) {
    failed(where, "sent " + text(frame) + ", expected the remote frame " + hex(identifier, 3));
  }
  return *this;
}

ModuleScenario& ModuleScenario::wait_tx(std::uint32_t identifier, const Bytes& bytes, can::Duration at_most,
                                        Where where) {
  run_until([&] { return !bus_->sent.empty(); }, at_most);
  expect_frame(can::data_frame(identifier, bytes), where);
  return *this;
}

ModuleScenario& ModuleScenario::no_tx(Where where) {
  if (!bus_->sent.empty()) failed(where, "sent " + text(bus_->sent.front()) + ", expected no frame");
  return *this;
}

ModuleScenario& ModuleScenario::ignore_tx() {
  bus_->sent.clear();
  return *this;
}

ModuleScenario& ModuleScenario::error_counters(std::uint16_t transmit, std::uint16_t receive) {
  bus_->transmit_errors = transmit;
  bus_->receive_errors = receive;
  module_->controller_changed(now_);
  settle();
  return *this;
}

ModuleScenario& ModuleScenario::advance(can::Duration duration) {
  ++steps_;
  step_to(now_ + duration);
  return *this;
}

ModuleScenario& ModuleScenario::supply_on() {
  module_->power_on(now_);
  settle();
  return *this;
}

ModuleScenario& ModuleScenario::supply_off() {
  module_->power_off(now_);
  settle();
  return *this;
}

ModuleScenario& ModuleScenario::cpu(module::CpuState state) {
  module_->cpu_changed(state, now_);
  settle();
  return *this;
}

}  // namespace canopus::scenario
