#pragma once
// Requests by bits of words: what is written as 1 requests, and goes back to 0 when it is done [FX3U-CAN 6.4, 6.6,
// 6.8, 6.19, 10.1]. Which word is for what is the model's table.
//
// The port is registered for the words of its table, in front of the areas that own them: an area keeps saying
// what its word reads and what a write does to it; the port adds what the write requests.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "canopus/module/engine/request_port.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

class ModuleEngine;

/// One row of a module's table of requests by words. A word may have several.
struct RequestWordRow {
  BufferAddress word = 0;
  RequestUse use = RequestUse::none;
  /// A write with any of them 1 requests; without bits every write does. `online`: lasts until all of them are
  /// written as 0, and reads what was requested. `nmt_error`: requests with a 0. `read_clock`: reading the word
  /// requests.
  std::optional<std::uint16_t> bits{};
  Modes modes = every_mode;  ///< function modes in which it means something
};

class WordPort final : public RequestPort, public BufferArea {
 public:
  WordPort(ModuleEngine& engine, BufferMemory& memory, std::span<const RequestWordRow> table);

  void serve(can::Time now) override;
  void initialization_begins(can::Time now) override;
  void went_offline() override { online_wanted_ = false; }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) const override;
  void program_reads(BufferAddress address, can::Time now) override;
  /// Ignored while the data exchange runs that this word requested [FX3U-CAN 6.4].
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

 private:
  struct Entry {
    const RequestWordRow* row;
    BufferArea* behind;  // nullptr: a plain word
  };
  [[nodiscard]] BufferArea* behind(BufferAddress address) const noexcept;
  [[nodiscard]] bool means_something(const RequestWordRow& row) const noexcept;
  void act(const RequestWordRow& row, std::uint16_t value, can::Time now);

  ModuleEngine& engine_;
  BufferMemory& memory_;
  std::vector<Entry> entries_;
  bool online_wanted_ = false;
  // Written, and not served yet.
  bool written_ = false;
  BufferAddress word_ = 0;
  std::uint16_t value_ = 0;
};

/// For a model's table: a port by its words.
[[nodiscard]] std::unique_ptr<RequestPort> requests_by_words(ModuleEngine& engine);

}  // namespace canopus::module
