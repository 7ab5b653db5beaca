#include "canopus/module/me3can1_q/me3can1_q.hpp"

#include <utility>

#include "canopus/module/me3can1_q/buffer_table.hpp"
#include "canopus/module/me3can1_q/data_sheet.hpp"
#include "canopus/module/me3can1_q/firmware.hpp"

namespace canopus::module::me3can1_q {

Me3can1Q::Me3can1Q(can::Controller& controller, NonVolatileMemory& memory, Profile profile)
    : firmware_(std::make_unique<Firmware>(controller, memory, std::move(profile))) {}
Me3can1Q::~Me3can1Q() = default;

ProductInformation Me3can1Q::product() const noexcept {
  return {.type = data_sheet.type,
          .series = data_sheet.series,
          .model = data_sheet.model,
          .points = data_sheet.points,
          .serial_number = profile().serial_number,
          .version = profile().function_version};
}

bool Me3can1Q::preset_word(BufferAddress address, std::uint16_t value) {
  return firmware_->preset_word(address, value);
}
bool Me3can1Q::preset_bit_rate(std::uint32_t bit_rate) {
  const std::uint32_t kbps = bit_rate / 1000;
  return bit_rate % 1000 == 0 && kbps <= 1000 && preset_word(g::baud_rate, static_cast<std::uint16_t>(kbps));
}
bool Me3can1Q::preset_node_id(std::uint8_t node_id) { return preset_word(g::node_address, node_id); }
canopen::AbortCode Me3can1Q::preset_object(std::uint16_t index, std::uint8_t sub,
                                           std::span<const std::uint8_t> value) {
  return firmware_->preset_object(index, sub, value);
}

std::optional<BufferAddress> Me3can1Q::layer2_preset_error() const {
  return firmware_->layer2_preset_error();
}

const ProgramInterface& Me3can1Q::program_interface() const noexcept { return me3can1_q::program_interface; }

bool Me3can1Q::takes_word(BufferAddress address, std::uint16_t value) const {
  return firmware_->takes_word(address, value);
}

std::uint16_t Me3can1Q::read_word(BufferAddress address, can::Time now) {
  return firmware_->read(address, now);
}
void Me3can1Q::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  firmware_->write(address, value, now);
}
std::uint32_t Me3can1Q::inputs() const noexcept { return firmware_->signals().inputs(); }
std::uint32_t Me3can1Q::outputs() const noexcept { return firmware_->signals().outputs(); }
void Me3can1Q::set_output(unsigned signal, bool on, can::Time now) { firmware_->set_output(signal, on, now); }
void Me3can1Q::power_on(can::Time now) { firmware_->power_on(now); }
void Me3can1Q::power_off(can::Time now) { firmware_->power_off(now); }
void Me3can1Q::cpu_changed(CpuState state, can::Time now) { firmware_->cpu_changed(state, now); }
void Me3can1Q::cpu_failed(can::Time now) { firmware_->cpu_failed(now); }
void Me3can1Q::inject(ModuleFault fault, can::Time now) { firmware_->inject(fault, now); }
void Me3can1Q::set_observer(ModuleObserver* observer) { firmware_->set_observer(observer); }

void Me3can1Q::receive(const can::Frame& frame, can::Time now) { firmware_->receive(frame, now); }
void Me3can1Q::transmitted(const can::Frame& frame, can::Time now) { firmware_->transmitted(frame, now); }
void Me3can1Q::controller_changed(can::Time now) { firmware_->controller_changed(now); }
void Me3can1Q::tick(can::Time now) { firmware_->tick(now); }
can::Time Me3can1Q::deadline() const noexcept { return firmware_->deadline(); }

const Profile& Me3can1Q::profile() const noexcept { return firmware_->profile(); }
std::vector<Led> Me3can1Q::leds(can::Time now) const { return firmware_->leds(now); }
std::uint32_t Me3can1Q::flash_writes() const noexcept { return firmware_->flash_writes(); }
const canopen::Node& Me3can1Q::node() const noexcept { return firmware_->node(); }
const manager::NmtMaster* Me3can1Q::master() const noexcept { return &firmware_->master(); }
Layer2State Me3can1Q::layer2_state() const noexcept { return firmware_->layer2_state(); }

}  // namespace canopus::module::me3can1_q
