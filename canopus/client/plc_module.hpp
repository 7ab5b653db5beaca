#pragma once
// A communication module in a PLC's rack as its configuration tool reaches it: buffer memory through the CPU, objects of the
// module and of other nodes through its command interface [FX3U-CAN 10] [RJ71CN91 App.2].

#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "canopus/client/plc_client.hpp"
#include "canopus/module/interface/configuration_tool.hpp"
#include "canopus/module_settings/module_transfer.hpp"

namespace canopus::client {

class PlcModule final : public module_settings::ModuleAccess {
 public:
  /// `unit`: the number behind U: the module's number (FX), or its head address / 16.
  PlcModule(PlcClient& client, std::uint16_t unit, module::RequestMethod method) noexcept
      : client_(client), unit_(unit), method_(method) {}

  [[nodiscard]] module::RequestMethod request_method() const noexcept { return method_; }

  // module_settings::ModuleAccess
  Result<std::uint16_t> read_word(std::uint32_t address) override;
  Result<void> write_word(std::uint32_t address, std::uint16_t value) override;
  Result<std::vector<std::uint32_t>> read_objects(
      std::uint8_t node, std::span<const module_settings::ObjectNumber> objects) override;
  Result<void> write_object(std::uint8_t node, module_settings::ObjectNumber object, std::uint32_t value,
                            std::uint8_t bytes) override;
  Result<void> save_words() override;

  /// Waits for the end of its initialisation (#25 bit 7), before which nothing else may be read or written.
  Result<void> wait_until_ready();
  /// Any object up to 124 bytes.
  Result<std::vector<std::uint8_t>> read_bytes(std::uint8_t node, module_settings::ObjectNumber object);
  Result<void> write_bytes(std::uint8_t node, module_settings::ObjectNumber object,
                           std::span<const std::uint8_t> bytes);
  /// Restarts the module, and with it the NMT master; waits until it is ready again.
  Result<void> restart();
  /// Clears its error display; errors that still exist appear again at once.
  Result<void> clear_errors();
  /// Whether the CPU module is in STOP (or PAUSE): SD203, of an FX3 M8000.
  Result<bool> cpu_stands_still();
  /// Words from an address on.
  Result<std::vector<std::uint16_t>> read_words(std::uint32_t address, std::uint32_t count);

 private:
  Result<void> write_words(std::uint32_t address, std::span<const std::uint16_t> words);
  /// A Y signal of the module.
  Result<void> set_signal(std::uint32_t number, bool on);
  Result<void> wait_for_signal(std::uint32_t number, bool on, const char* what);
  /// Y on, X on: done; Y off, X off: ready for the next one. `work` is done while both are on.
  template <typename Work>
  Result<void> handshake(std::uint32_t number, const char* what, Work work);
  /// Parameters to #1001 on, then the code; the words from #1000 on when it is no longer busy.
  Result<std::vector<std::uint16_t>> command(std::uint16_t code, std::span<const std::uint16_t> parameters);
  /// Polls until the bits of a word are 0.
  Result<void> wait_for_zero(std::uint32_t address, std::uint16_t bits, const char* what);

  PlcClient& client_;
  std::uint16_t unit_;
  module::RequestMethod method_;
};

}  // namespace canopus::client
