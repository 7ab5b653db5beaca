#pragma once
// Data exchange between the PLC's process data words and the network variables of the object dictionary (CiA
// 405). Received values gather in a block of their own, written by RPDOs and SDOs as they come; the PLC sees
// them when it requests an exchange. What the PLC has to send is latched in the same moment, and only into
// objects that a TPDO maps [ME3CAN1-Q 3.5.1, 3.5.19], or into all that show the same words [FX2N-32CAN 5.1].
//
// What the mappings mean is worked out once, into copies between the dictionary's value block and the two
// blocks here, and again when the node has read its PDO parameters anew.

#include <cstdint>
#include <span>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/module/canopen/network_variables.hpp"
#include "canopus/module/interface/program_interface.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

class DataExchange final : public canopen::ObjectHandler {
 public:
  DataExchange(const DataExchangeLayout& layout, BufferMemory& memory)
      : layout_(layout), memory_(&memory), received_(layout.words * 2), to_send_(layout.words * 2) {}

  /// Hears SDO writes to the output variables from now on.
  void attach(canopen::Node& node) { node.attach(0xA480, 0xA6FF, *this); }

  /// An RPDO put values into its mapped objects: they become the latest received data.
  void rpdo_received(canopen::Node& node, std::uint16_t number);
  /// Takes what the PLC has written now; exchange() will use it.
  void snapshot();
  /// Words to send into the mapped objects, received data into the words.
  void exchange(canopen::Node& node);
  /// As from power-on.
  void reset();
  /// The same, and the program's words both ways are 0.
  void clear();

  // Output variables written by SDO.
  void after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                   can::Time now) override;

 private:
  /// A copy between the dictionary's value block and one of the blocks below.
  struct Copy {
    std::uint32_t offset = 0;  // in the dictionary's block
    std::uint16_t place = 0;   // in received_ or to_send_
    std::uint16_t bytes = 0;
  };
  /// Of each frame: the mappings are those that the copies below were made of, or they are made anew.
  void follow(const canopen::Node& node) {
    if (node.identifiers_revision() != revision_ || receive_first_.empty()) check_mappings(node);
  }
  void check_mappings(const canopen::Node& node);
  void find_areas(const canopen::DictionaryDescription& description);
  /// Received bytes into every network variable that shows them.
  void show_in_all(std::span<std::uint8_t> block, std::size_t place, std::size_t bytes) const noexcept;
  void put_words(BufferAddress first, std::span<const std::uint8_t> bytes);
  void add_copies(const canopen::ObjectDictionary& dictionary, std::uint16_t mapping_index,
                  VariableDirection direction, std::size_t first, std::vector<Copy>& copies) const;

  DataExchangeLayout layout_;
  BufferMemory* memory_;
  std::vector<std::uint8_t> received_;
  std::vector<std::uint8_t> to_send_;
  std::uint32_t revision_ = 0;                // of the node's PDO parameters that the copies belong to
  std::vector<Copy> receive_;                 // of RPDO n: receive_first_[n] .. receive_first_[n + 1] - 1
  std::vector<std::uint32_t> receive_first_;  // empty: not worked out yet
  std::vector<Copy> transmit_;
  std::vector<std::uint32_t>
      output_areas_;  // where they begin in the dictionary's block, if all show the words
  std::vector<std::uint32_t> input_areas_;
};

}  // namespace canopus::module
