#include "scenarios/engine/as_fcopm_sketch.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "canopus/module/canopen/object_rows.hpp"

namespace canopus::scenario::sketch {

using namespace module;
using canopen::Access;
using canopen::DataType;

namespace {

constexpr Modes master_mode = 1;
constexpr std::array mode_rows = std::to_array<FunctionModeRow>({
    {0, master_mode, FunctionModeRow::Kind::canopen},
});

constexpr std::uint16_t pdos = 25;
constexpr BufferAddress words = 4 * pdos;  // the first 100 of its 947
constexpr BufferAddress request = 25000;
constexpr BufferAddress response = 24000;
constexpr BufferAddress abnormal_nodes = 826;
constexpr BufferAddress node_codes = 830;

constexpr auto rw = WordAccess::read_write;
constexpr auto ro = WordAccess::read;
// clang-format off
constexpr std::array register_rows = std::to_array<BufferRow>({
    {  826,   829, "SR826-829: abnormal nodes", ro, 0, any_value, Stored::no, master_mode, "10.5.1"},
    {  830,   893, "SR830-893: node codes",     ro, 0, any_value, Stored::no, master_mode, "10.5.1"},
    {24000, 24031, "Response",                  ro, 0, any_value, Stored::no, master_mode, "10.1.2"},
    {24032, 24131, "TPDO data of the slaves",   ro, 0, any_value, Stored::no, master_mode, "10.1.2"},
    {25000, 25031, "Request",                   rw, 0, any_value, Stored::no, master_mode, "10.1.2"},
    {25032, 25131, "RPDO data of the slaves",   rw, 0, any_value, Stored::no, master_mode, "10.1.2"},
});
constexpr std::array registers = std::to_array<RegisterRange>({
    {RegisterKind::special, 826, 893},
    {RegisterKind::data, 24000, 24131},
    {RegisterKind::data, 25000, 25131},
});

constexpr auto u8 = DataType::unsigned8;
constexpr auto u16 = DataType::unsigned16;
constexpr auto u32 = DataType::unsigned32;
using enum ObjectRow::Kind;
using enum ObjectRow::Flag;
constexpr std::array objects = std::to_array<ObjectRow>({
    {0x1000, 0x1000, variable, 0, 0,   "Device type",        u32, Access::read_only,  405,        plain},
    {0x1001, 0x1001, variable, 0, 0,   "Error register",     u8,  Access::read_only,  0,          plain},
    {0x1014, 0x1014, variable, 0, 0,   "COB-ID EMCY",        u32, Access::read_only,  0x80,       adds_node_id},
    {0x1016, 0x1016, array,    1, 64,  "Consumer heartbeat", u32, Access::read_write, 0,          plain},
    {0x1017, 0x1017, variable, 0, 0,   "Producer heartbeat", u16, Access::read_write, 0,          plain},
    {0x1018, 0x1018, sub,      1, 1,   "Vendor-ID",          u32, Access::read_only,  0x1DD,      plain},
    {0x1028, 0x1028, sub,      1, 127, "Emergency consumer", u32, Access::read_write, 0x80,       adds_sub_index},
    {0x1400, 0x1418, sub,      1, 1,   "RPDO: COB-ID",       u32, Access::read_write, 0x80000000, plain},
    {0x1400, 0x1418, sub,      2, 2,   "RPDO: type",         u8,  Access::read_write, 0xFF,       plain},
    {0x1600, 0x1618, sub,      0, 0,   "RPDO mapping",       u8,  Access::read_write, 4,          plain},
    {0x1600, 0x1618, sub,      1, 8,   "RPDO mapping",       u32, Access::read_write, 0,          plain},
    {0x1800, 0x1818, sub,      1, 1,   "TPDO: COB-ID",       u32, Access::read_write, 0xC0000000, plain},
    {0x1800, 0x1818, sub,      2, 2,   "TPDO: type",         u8,  Access::read_write, 0xFF,       plain},
    {0x1800, 0x1818, sub,      3, 3,   "TPDO: inhibit time", u16, Access::read_write, 0,          plain},
    {0x1800, 0x1818, sub,      5, 5,   "TPDO: event timer",  u16, Access::read_write, 0,          plain},
    {0x1A00, 0x1A18, sub,      0, 0,   "TPDO mapping",       u8,  Access::read_write, 4,          plain},
    {0x1A00, 0x1A18, sub,      1, 8,   "TPDO mapping",       u32, Access::read_write, 0,          plain},
    {0x1F80, 0x1F80, variable, 0, 0,   "NMT start-up",       u32, Access::read_write, 0,          plain},
});
// TPDO1 of node 2, and its RPDO1.
constexpr std::array slave_pdos = std::to_array<ObjectRow>({
    {0x1400, 0x1400, sub, 1, 1, "RPDO: COB-ID", u32, Access::read_write, 0x00000182, plain},
    {0x1800, 0x1800, sub, 1, 1, "TPDO: COB-ID", u32, Access::read_write, 0x40000202, plain},
});
// clang-format on

std::shared_ptr<const canopen::DictionaryDescription> dictionary() {
  canopen::DictionaryBuilder builder;
  add_rows(builder, objects);
  add_rows(builder, slave_pdos);
  add_default_mappings(builder, pdos);
  add_network_variables(builder, 2 * words);
  return builder.build();
}

/// Requests by registers: an area of the model's own, and its port. Process data go both ways with every scan of
/// the CPU; a changed ReqID asks.
class RegisterPort final : public RequestPort, public BufferArea {
 public:
  RegisterPort(ModuleEngine& engine, BufferMemory& memory) : engine_(engine), memory_(memory) {
    memory.attach(request, request, *this);
  }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) const override {
    return memory_.word(address);
  }
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time) override {
    const bool asks = value >> 8 != memory_.word(address) >> 8;
    memory_.store(address, value);
    if (asks) answer(value);
    return WriteResult::done;
  }

  void initialized(bool, can::Time now) override { alarm() = now; }
  void power_off(can::Time) override { alarm() = can::never; }
  void tick(can::Time now) override {
    if (now < alarm()) return;
    alarm() = can::never;
    engine_.begin_exchange(now);
  }
  void done(Request what, can::Time now) override {
    if (what == Request::data_exchange) alarm() = can::later(now, scan);
  }

  void emergency_received(const canopen::Emergency& message) {
    Messages& messages = messages_[message.node_id];
    ++messages.received;
    std::ranges::rotate(messages.latest, messages.latest.end() - 1);
    auto& bytes = messages.latest.front();
    bytes = {static_cast<std::uint8_t>(message.code), static_cast<std::uint8_t>(message.code >> 8),
             message.error_register};
    std::ranges::copy(message.manufacturer, bytes.begin() + 3);
    const bool is_fault = message.code != 0;
    memory_.set_word(node_codes + message.node_id - 1U, is_fault ? 0xE0 : 0);
    const BufferAddress word = abnormal_nodes + (message.node_id - 1U) / 16;
    const unsigned bit = 1U << (message.node_id - 1U) % 16;
    const unsigned others = memory_.word(word) & ~bit;
    memory_.set_word(word, static_cast<std::uint16_t>(others | (is_fault ? bit : 0U)));
  }
  void emergency_received(const canopen::Emergency& message, can::Time) override {
    emergency_received(message);
  }

 private:
  static constexpr can::Duration scan = std::chrono::milliseconds(1);
  static constexpr std::size_t most_shown = 5;
  struct Messages {
    unsigned received = 0;
    std::array<std::array<std::uint8_t, 8>, most_shown> latest{};  // the latest first
  };

  void answer(std::uint16_t header) {
    constexpr unsigned done = 1;
    constexpr unsigned illegal_command = 4;
    constexpr unsigned illegal_type = 8;
    const std::uint16_t what = memory_.word(request + 2);
    const auto node = static_cast<std::uint8_t>(what);
    unsigned status = done;
    if (what >> 8 != 4) status = illegal_type;
    if ((header & 0xFF) != 1) status = illegal_command;
    memory_.set_word(response, static_cast<std::uint16_t>((header & 0xFF00U) | status));
    if (status != done) return;
    const Messages& messages = messages_[node];
    const unsigned stored = std::min<unsigned>(messages.received, most_shown);
    memory_.set_word(response + 1, 2 + 8 * most_shown);
    memory_.set_word(response + 2, what);
    memory_.set_word(response + 3, static_cast<std::uint16_t>(messages.received << 8 | stored));
    for (std::size_t i = 0; i < most_shown; ++i) {
      memory_.set_words(static_cast<BufferAddress>(response + 4 + 4 * i), messages.latest[i]);
    }
  }

  ModuleEngine& engine_;
  BufferMemory& memory_;
  std::map<std::uint8_t, Messages> messages_;
};

std::unique_ptr<RequestPort> requests_by_registers(ModuleEngine& engine) {
  return std::make_unique<RegisterPort>(engine, engine.memory());
}

constexpr DataSheet sheet{.model = "AS-FCOPM", .word_prefix = "D"};

}  // namespace

constinit const ModuleModel as_fcopm_sketch{
    .data_sheet = &sheet,
    .buffer_memory = register_rows,
    .registers = registers,
    .function_modes = mode_rows,
    .request_port = requests_by_registers,
    .factory = {.bit_rate = 500, .node_id = 1},
    .program_interface =
        {.process_data = {.receive_first = 24032, .transmit_first = 25032, .words = words, .pdos = pdos}},
    .object_dictionary = dictionary,
    .node_options = [] { return canopen::NodeOptions{.send_tpdos_on_start = false}; },
    .master_options = [] { return manager::MasterOptions{}; },
};

}  // namespace canopus::scenario::sketch
