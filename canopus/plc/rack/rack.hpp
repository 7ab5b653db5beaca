#pragma once
// The PLC around the modules: a rack with slots, the CPU's devices (X Y M D W R SM SD ...) and its RUN/STOP
// state. One Rack lives on one event loop; every access is a direct call.
//
// Without a PLC program (execution/program_execution.hpp) clients that access the rack act as one. X is the modules' state at this moment, a
// written Y is a signal edge at once, and everything else is memory. With a scan of its own, X and Y are
// refreshed between two scans, as by a CPU: X stays what it was then, and a written Y reaches its module
// then. Clients are answered between the two (end_processing.hpp), so all that they see is of that moment. A
// device number or buffer memory address outside of the range is refused as a whole, before anything is
// written.
//
// Modules get the CPU's state by cpu_changed(), and after every access that a module may react to, the
// timeline reads its deadline again.

#include <array>
#include <chrono>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/module_types.hpp"
#include "canopus/plc/cpu/device.hpp"
#include "canopus/plc/cpu/device_bits.hpp"
#include "canopus/plc/cpu/device_words.hpp"
#include "canopus/plc/rack/end_processing.hpp"
#include "canopus/plc/rack/special_devices.hpp"

namespace canopus::module {
class BufferMemoryAccess;
class Module;
class RegisterAccess;
class SignalAccess;
}  // namespace canopus::module

namespace canopus::plc {

/// Why an access was refused; nothing has happened then.
enum class AccessError : std::uint8_t {
  no_device,     ///< the CPU has no such device (0 points)
  wrong_unit,    ///< single bits of a word device
  out_of_range,  ///< device numbers beyond the CPU's last one
  no_module,     ///< no module at this head address
  beyond_buffer  ///< buffer memory addresses beyond the module's last one
};

/// Callbacks of the CPU's state: for the built-in PLC program.
class RackListener {
 public:
  /// The supply came on, with the CPU in cpu_state(), or went off. Called after the modules.
  virtual void supply_changed(bool on, can::Time now) = 0;
  /// The CPU went to RUN, Y as before the STOP, or to STOP, Y OFF. Called after the modules.
  virtual void cpu_changed(module::CpuState state, can::Time now) = 0;
  /// The CPU, in RUN, went to PAUSE or came back from it: no program runs, Y stay. Modules are not notified.
  virtual void cpu_paused(bool /*paused*/, can::Time /*now*/) {}
  /// A scan of the rack's own ends, in STOP, too: X are not yet refreshed, clients not yet answered.
  virtual void scan_ended(can::Time /*now*/) {}
  /// In RUN, a scan of the rack's own begins: X and Y have been refreshed, and it is the program's turn.
  virtual void scan_begins(can::Time /*now*/) {}

 protected:
  ~RackListener() = default;
};

class Rack final : private can::Ticker {
 public:
  using Access = std::expected<void, AccessError>;

  /// Off, empty, the CPU's switch at RUN. `scan`: X and Y are refreshed once a scan; without it at once, and scans
  /// of the usual length are only counted.
  explicit Rack(can::Timeline& timeline, const CpuModel& model = r04cpu(),
                std::optional<can::Duration> scan = std::nullopt);
  Rack(const Rack&) = delete;
  Rack& operator=(const Rack&) = delete;

  /// Puts a module at a head I/O number (0, 10H, 20H ... FF0H, in points; a multiple of 16), or at 16 times its
  /// position, unit number or card slot (FX3 0 to 7, FX5 1 to 16, AS300 1 and 2). The module must outlive the
  /// rack. False when there is no such place, or it is taken, or the
  /// points reach beyond X/Y FFFH, or the rack has supply: modules are not changed online.
  bool insert(std::uint16_t head_address, module::Module& module);
  /// `listener` must outlive the rack.
  void add_listener(RackListener& listener) { listeners_.push_back(&listener); }
  /// The module whose points begin at head_address, or nullptr.
  [[nodiscard]] module::Module* module_at(std::uint16_t head_address) const noexcept;

  [[nodiscard]] const CpuModel& model() const noexcept { return model_; }

  /// One slot in the programming tool's product list.
  struct ProductListRow {
    unsigned slot = 0;            ///< in the order of insertion
    std::uint16_t io_number = 0;  ///< head address
    module::ProductInformation product;
  };
  [[nodiscard]] std::vector<ProductListRow> product_list() const;

  /// Supply on: devices and the CPU's own buffer memory cleared, modules started, then notified of the CPU's state.
  void power_on(can::Time now, module::CpuState state = module::CpuState::run);
  void power_off(can::Time now);

  /// It has supply.
  [[nodiscard]] bool is_on() const noexcept { return on_; }
  [[nodiscard]] module::CpuState cpu_state() const noexcept { return condition_.state; }
  /// Remote RUN/STOP. RUN to STOP turns all Y off, STOP to RUN restores them as they were before the STOP
  /// ("previous state", the default of the CPU parameter). Every module is notified.
  void set_cpu_state(module::CpuState state, can::Time now);
  /// Remote PAUSE: no program runs, while Y and everything else stay as they are, so modules see no change.
  /// set_cpu_state(), the supply and reset end it. In STOP nothing happens.
  void pause(can::Time now);
  [[nodiscard]] bool is_paused() const noexcept { return condition_.is_paused; }
  /// The CPU's scans.
  [[nodiscard]] const Scan& scan() const noexcept { return condition_.scan; }
  /// X and Y are refreshed once a scan.
  [[nodiscard]] bool has_own_scan() const noexcept { return refreshes_by_scan_; }
  /// Requests of clients have to wait() in end_processing(): the rack has a scan of its own, and supply. Without
  /// supply there is no END, and they are answered at once.
  [[nodiscard]] bool answers_at_end() const noexcept {
    return has_own_scan() && on_ && !end_processing_.is_open();
  }
  [[nodiscard]] EndProcessing& end_processing() noexcept { return end_processing_; }
  /// The CPU finds an error and stops: every module is notified, then as RUN to STOP. RUN again is possible at
  /// once, and clears the error, as the supply does.
  void fail_cpu(can::Time now, CpuError error = {});
  /// The error that has stopped the CPU; none: it has not been stopped by one.
  [[nodiscard]] const std::optional<CpuError>& cpu_error() const noexcept { return condition_.error; }
  /// Like the RESET switch: clears devices and restarts all modules.
  void reset_cpu(can::Time now);
  /// The clear modes of remote RUN: all devices but L (`latched` = false) or with L. SM SD R ZR stay, and so
  /// do Z and the CPU buffer memory; Y of modules go off.
  void clear_devices(bool latched, can::Time now);
  /// L only: remote latch clear.
  void clear_latched() noexcept;

  /// Sets the CPU's clock (SD210...). A new rack's clock starts at 2000-01-01 00:00:00.
  void set_clock(std::chrono::local_seconds clock, can::Time now) noexcept;

  /// Word devices: one word per point. Bit devices: 16 points per word, the first in bit 0; `first` may be
  /// any number.
  Access read_words(Device device, std::uint32_t first, std::span<std::uint16_t> words, can::Time now);
  /// X of a module's points keep the module's state; SM and SD that the system sets likewise.
  Access write_words(Device device, std::uint32_t first, std::span<const std::uint16_t> words, can::Time now);
  /// Bit devices only: 0 or 1 per point.
  Access read_bits(Device device, std::uint32_t first, std::span<std::uint8_t> bits, can::Time now);
  /// Bit devices only: 0 is OFF, anything else ON. Y act in the order of their numbers.
  Access write_bits(Device device, std::uint32_t first, std::span<const std::uint8_t> bits, can::Time now);

  /// Where the program of this rack may read and write a point itself: one that is memory and nothing else. 0 or 1, at a place that stays
  /// while no module is inserted. nullptr: by the accesses above only.
  [[nodiscard]] std::uint8_t* bit_in_memory(Device device, std::uint32_t number) noexcept;
  /// The same of `count` words in a row.
  [[nodiscard]] std::uint16_t* words_in_memory(Device device, std::uint32_t first, std::uint32_t count);
  /// `count` X of modules become those of this moment, or as many Y go out to the modules, within a scan. Of other points nothing
  /// changes.
  Access refresh(Device device, std::uint32_t first, std::uint32_t count, can::Time now);

  /// FROM and TO, U\G: words of the module whose points include `head_address`. Racks whose modules have no points
  /// (FX, AS300) take 16 times the module's number. What FROM reads need not be what TO has written.
  Access read_buffer(std::uint16_t head_address, module::BufferAddress first, std::span<std::uint16_t> words,
                     can::Time now);
  Access write_buffer(std::uint16_t head_address, module::BufferAddress first,
                      std::span<const std::uint16_t> words, can::Time now);
  /// DFROM and DTO: 32-bit values in two words each, the low one first, as one access.
  Access read_double_words(std::uint16_t head_address, module::BufferAddress first,
                           std::span<std::uint32_t> values, can::Time now);
  Access write_double_words(std::uint16_t head_address, module::BufferAddress first,
                            std::span<const std::uint32_t> values, can::Time now);

  /// The CPU's own buffer memory; empty when it has none.
  [[nodiscard]] std::span<std::uint16_t> own_buffer() noexcept { return own_buffer_; }

  /// Whether an access to `count` points (words of a word device, else bits) would be refused, without doing
  /// it.
  [[nodiscard]] Access check(Device device, std::uint32_t first, std::uint32_t count) const noexcept;
  [[nodiscard]] Access check_buffer(std::uint16_t head_address, module::BufferAddress first,
                                    std::uint32_t count) const noexcept;

 private:
  struct Slot {
    std::uint16_t head = 0;
    module::Module* module = nullptr;
    module::BufferMemoryAccess* buffer = nullptr;  // nullptr: the module has none; likewise
    module::SignalAccess* signals = nullptr;
    module::RegisterAccess* registers = nullptr;
    std::uint32_t inputs = 0;  // X of the present scan
  };
  static constexpr std::size_t block_count = 256;  // of 16 points: X/Y 000H to FFFH
  static constexpr std::uint8_t empty = 0xFF;

  // can::Ticker: between two scans.
  void tick(can::Time now) override;

  [[nodiscard]] const Slot* slot_of_point(std::uint32_t point) const noexcept;
  [[nodiscard]] DeviceWords& words_of(Device device) noexcept;
  [[nodiscard]] DeviceBits& bits_of(Device device) noexcept {
    return bits_[static_cast<std::size_t>(device)];
  }
  [[nodiscard]] const DeviceBits& bits_of(Device device) const noexcept {
    return bits_[static_cast<std::size_t>(device)];
  }
  /// A module's state is read there, not memory.
  [[nodiscard]] bool is_module_input(Device device, std::uint32_t number) const noexcept;
  [[nodiscard]] bool is_module_register(Device device, std::uint32_t first,
                                        std::uint32_t count) const noexcept;
  /// 16 points from number 16 * block on, as they read.
  [[nodiscard]] std::uint16_t bit_block(Device device, std::uint32_t block, can::Time now);
  [[nodiscard]] std::uint32_t inputs_of(const Slot& slot) const noexcept;
  [[nodiscard]] bool output(std::uint32_t number) const noexcept;
  /// Y of the memory and of the module, independent of the scan.
  void set_output(std::uint32_t number, bool on, can::Time now);
  void outputs_to_module(const Slot& slot, can::Time now);
  /// D and SR that are a module's, among `words`, which begin with number `first`.
  void read_registers(Device device, std::uint32_t first, std::span<std::uint16_t> words, can::Time now);
  void write_registers(Device device, std::uint32_t first, std::span<const std::uint16_t> words,
                       can::Time now);
  void write_bit(Device device, std::uint32_t number, bool on, can::Time now);
  void output_to_module(std::uint32_t number, bool on, can::Time now);
  void notify_cpu_state(can::Time now);
  /// The program's turn, if one runs.
  void begin_scan(can::Time now);

  CpuModel model_;
  bool refreshes_by_scan_;  // X and Y
  std::vector<Slot> slots_;
  std::vector<RackListener*> listeners_;
  std::array<std::uint8_t, block_count> slot_of_block_{};  // number in slots_, or empty
  std::array<DeviceWords, device_count> words_;
  std::array<DeviceBits, device_count> bits_;
  std::vector<std::uint16_t> own_buffer_;
  std::vector<std::uint8_t> outputs_before_stop_;
  CpuCondition condition_;
  bool on_ = false;
  EndProcessing end_processing_;
};

}  // namespace canopus::plc
