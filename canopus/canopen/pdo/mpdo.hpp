#pragma once
// Multiplex PDOs [CiA 301 7.2.2.4]: eight bytes that carry the address of one value of up to 4 bytes: byte 0
// bit 7 = destination addressing, bits 0-6 node-ID; bytes 1-2 index, 3 sub-index, 4-7 data.
//
//   Destination (mapping sub-index 00H = FFH): node-ID of the consumer, 0 = all; index and sub-index are the
//   consumer's, which writes them. One that does not exist there is EMCY 8230H.
//   Source (mapping sub-index 00H = FEH): node-ID, index and sub-index of the producer. The producer may send
//   the objects of its scanner list 1FA0H-1FCFH (bits 24-31 block size, 8-23 index, 0-7 first sub-index); a
//   consumer looks them up in its dispatching list 1FD0H-1FFFH (bits 56-63 block size, 40-55 local index,
//   32-39 local sub-index, 16-31 producer's index, 8-15 its first sub-index, 0-7 its node-ID) and ignores
//   what is not there.
//
// The block size says how many sub-indexes in a row an entry stands for; 0 acts as 1. Both lists are sorted
// once, so that a frame costs a binary search.

#include <cstdint>
#include <optional>
#include <vector>

#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

inline constexpr std::uint8_t source_addressing = 0xFE;       ///< mapping sub-index 00H
inline constexpr std::uint8_t destination_addressing = 0xFF;  ///< mapping sub-index 00H

/// May mapping sub-index 00H become FEH or FFH with this transmission type? 06040043H below FEH, 08000022H
/// while the PDO is valid.
[[nodiscard]] AbortCode check_mpdo(std::uint8_t transmission_type, bool valid) noexcept;

class MpdoConsumer final : public ObjectHandler {
 public:
  explicit MpdoConsumer(NodeContext& node);

  /// Reads the dispatching lists.
  void start();
  /// True when the frame put a value into the dictionary. `addressing`: the RPDO's.
  bool receive(const can::Frame& frame, std::uint8_t addressing, can::Time now);

  void after_write(ObjectDictionary&, const Entry&, can::Time) override { start(); }

 private:
  struct Dispatch {
    std::uint32_t producer = 0;  // node-ID, index, first sub-index
    std::uint16_t local_index = 0;
    std::uint8_t local_sub = 0;
    std::uint8_t block_size = 1;
  };
  [[nodiscard]] AbortCode put(std::uint16_t index, std::uint8_t sub, const can::Frame& frame, can::Time now);

  NodeContext& node_;
  std::vector<Dispatch> dispatches_;  // in order of producer
  bool destination_missing_ = false;
};

class MpdoScanner final : public ObjectHandler {
 public:
  explicit MpdoScanner(NodeContext& node);

  /// Reads the scanner lists.
  void start();
  [[nodiscard]] bool holds(std::uint16_t index, std::uint8_t sub) const noexcept;

  void after_write(ObjectDictionary&, const Entry&, can::Time) override { start(); }

 private:
  struct Range {
    std::uint32_t first = 0;  // index, sub-index
    std::uint32_t last = 0;
  };
  NodeContext& node_;
  std::vector<Range> ranges_;  // in order
};

/// The data bytes of an MPDO; `value` of up to 4 bytes.
[[nodiscard]] std::uint64_t mpdo_data(std::uint8_t addressing, std::uint8_t node_id, std::uint16_t index,
                                      std::uint8_t sub, std::span<const std::uint8_t> value) noexcept;

}  // namespace canopus::canopen
