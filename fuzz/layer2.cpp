// An ME3CAN1-Q in a Layer 2 mode, with any settings, frames, signals and times. What it sends is well formed
// and of the mode's format, offline it is silent, its words stay in range, its deadlines lead somewhere.

#include <array>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"

#include "input.hpp"

namespace {

using namespace canopus;
using fuzz::expect;
using fuzz::Input;
using module::BufferAddress;
using module::Layer2State;

struct NoMemory final : module::NonVolatileMemory {
  Content read(std::string_view) override { return {}; }
  bool write(std::string_view, std::span<const std::uint8_t>) override { return true; }
  bool erase(std::string_view) override { return true; }
};

struct Controller final : can::Controller {
  bool send(const can::Frame& frame) override {
    fuzz::expect_well_formed(frame);
    expect(frame.extended == extended);
    expect(may_send || stopping);
    if (!has_room()) {
      ++overflows;
      return false;
    }
    waiting[count++] = frame;
    return true;
  }
  std::uint16_t transmit_error_counter() const override { return errors; }
  std::uint16_t receive_error_counter() const override { return 0; }
  can::ErrorState error_state() const override {
    return errors == 256 ? can::ErrorState::bus_off : can::ErrorState::error_active;
  }
  std::uint32_t bit_rate() const override { return 250'000; }
  void restart(std::uint32_t) override { count = 0; }
  std::uint32_t transmit_overflows() const override { return overflows; }
  bool has_room() const override { return count < waiting.size(); }
  void abort_transmissions() override { count = 0; }

  bool extended = false;
  bool may_send = false;  // the module is online, or is being brought there
  bool stopping = false;  // RUN to STOP messages may be on their way
  std::uint16_t errors = 0;
  std::uint32_t overflows = 0;
  std::array<can::Frame, 5> waiting;
  std::size_t count = 0;
};

class Run {
 public:
  explicit Run(Input& input) : input_(input) {
    controller_.extended = input.flag();
    expect(module_.preset_word(21, controller_.extended ? 29 : 11));
    module_.power_on(now_);
    fuzz::pass_time(module_, now_, now_ + std::chrono::seconds(1));
  }

  void step() {
    switch (input_.choice(10)) {
      case 0: write(6000 + input_.choice(168), word()); break;
      case 1: write(10000 + 7 * input_.choice(42) + input_.choice(7), word()); break;
      case 2: write(8450 + input_.choice(28), word()); break;
      case 3: write(8400 + input_.choice(3), word()); break;
      case 4:
        set_output(input_.one_of({0x01U, 0x03U, 0x04U, 0x0FU, 0x17U, 0x1FU, 0x02U}), input_.flag());
        break;
      case 5: {  // settings that are good, in one step
        const BufferAddress slot = input_.choice(42);
        write(6000 + 4 * slot, 0xFFFF);
        write(6001 + 4 * slot, word());
        write(10000 + 7 * slot, 0x0181);
        write(10001 + 7 * slot, 0);
        break;
      }
      case 6: {
        can::Frame frame = input_.frame(0x180 + input_.choice(4), input_.flag());
        module_.receive(frame, now_);
        break;
      }
      case 7: {
        const unsigned steps = input_.choice(64);
        fuzz::pass_time(module_, now_, now_ + std::chrono::milliseconds(steps));
        break;
      }
      case 8: complete(); break;
      default:
        switch (input_.choice(4)) {
          case 0:
            module_.cpu_changed(module::CpuState::stop, now_);
            controller_.stopping = true;
            set_output(0x03, false);  // as the CPU does
            complete();
            module_.cpu_changed(module::CpuState::run, now_);
            break;
          case 1:
            controller_.errors = input_.flag() ? 256 : 0;
            module_.controller_changed(now_);
            break;
          case 2: write(1000 + input_.choice(9), word()); break;
          default: write(static_cast<BufferAddress>(input_.number(2)), word()); break;
        }
    }
    check();
  }

 private:
  std::uint16_t word() {
    static constexpr std::uint16_t likely[] = {0,      1,      2,      3,      4,      8,     0x000C,
                                               0x0181, 0x5FFF, 0x6FFF, 0x7FFF, 0xFFFF, 0x1008};
    return input_.flag() ? input_.one_of(likely) : static_cast<std::uint16_t>(input_.number(2));
  }
  void write(BufferAddress address, std::uint16_t value) { module_.write_word(address, value, now_); }
  void set_output(unsigned number, bool on) {
    if (number == 0x03 && on) controller_.may_send = true;
    module_.set_output(number, on, now_);
  }
  void complete() {
    if (controller_.count == 0) return;
    const can::Frame frame = controller_.waiting[--controller_.count];
    module_.transmitted(frame, now_);
  }
  void check() {
    const auto read = [&](BufferAddress address) { return module_.program_read(address, now_); };
    const std::uint32_t x = module_.inputs();
    constexpr std::uint16_t sum = 0x817A;
    if ((read(25) & 0x80) == 0) expect((x >> 0x0F & 1U) == ((read(29) & sum) != 0 ? 1U : 0U));
    const bool online = module_.layer2_state() == Layer2State::online;
    expect((x >> 0x03 & 1U) == (online ? 1U : 0U));
    if (online) expect((module_.outputs() >> 0x03 & 1U) == 1U);
    controller_.may_send = (module_.outputs() >> 0x03 & 1U) == 1U;  // also at the end of a restart
    if (controller_.count == 0) controller_.stopping = false;
    expect((read(8352) & 0xFC00) == 0);
    for (BufferAddress slot = 0; slot < 42; ++slot) {
      expect((read(10002 + 7 * slot) & 0x00FF) <= 8);
      expect(read(5001 + slot) == 0 || read(5001 + slot) == 0x2000);
    }
    for (BufferAddress message = 0; message < 4; ++message) expect(read(8452 + 7 * message) <= 8);
  }

  Input& input_;
  NoMemory memory_;
  Controller controller_;
  module::me3can1_q::Me3can1Q module_{controller_, memory_, {.restart_time = std::chrono::milliseconds(10)}};
  can::Time now_{};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  Run run(input);
  for (unsigned steps = 0; steps < 2000 && !input.empty(); ++steps) run.step();
  return 0;
}
