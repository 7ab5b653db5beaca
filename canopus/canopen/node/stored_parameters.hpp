#pragma once
// Store and restore parameters [CiA 301 7.5.2.13, 7.5.2.14]. Writing "save" (65766173H) to 1010H:n keeps the
// present values of a group over power-off and resets, "load" (64616F6CH) to 1011H:n forgets them: from the
// next reset on the defaults count. Groups: 01H all, 02H communication (1000H-1FFFH), 03H application
// (6000H-9FFFH), 04H.. manufacturer (2000H-5FFFH). Read, 1010H:n has bit 0 set (saves on command), and bit 1
// if its default has (then every write to a stored object saves it, too); 1011H:n has bit 0 set.
//
// Stored are the entries that the dictionary marks as such; in a dictionary that marks none, every one that
// can be read and written, but 1003H, 1010H, 1011H, DOMAINs and process data (what can be mapped). How they
// lie in the store: stored_values.hpp. Of an image that does not decode nothing is used.
//
// Checks: another signature 08000020H; save between "load" and the reset 08000022H, if the node's options do
// not allow it; a value too long to be stored 08000020H.

#include <vector>

#include "canopus/canopen/dictionary/parameter_store.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class StoredParameters final : public ObjectHandler {
 public:
  explicit StoredParameters(NodeContext& node);

  /// nullptr: kept in this object's own memory, for as long as it lives.
  void set_store(ParameterStore* store) noexcept { store_ = store; }
  [[nodiscard]] ParameterStore* store() const noexcept { return store_; }
  /// Puts the stored values of first..last into the dictionary.
  void apply(std::uint16_t first, std::uint16_t last);
  /// 1010:01 says "autonomously".
  [[nodiscard]] bool saves_at_once() const noexcept {
    return has_save_all_ && (node_.dictionary.block()[save_all_] & autonomously) != 0;
  }
  /// A value was written: saves it if 1010:01 says so.
  void object_written(const Entry& entry) {
    if (saves_at_once()) save_written(entry);
  }

  AbortCode before_read(ObjectDictionary&, const Entry&, can::Time) override;
  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time) override;

 private:
  static constexpr std::uint8_t autonomously = 2;  // of 1010H, in its lowest byte
  using Image = std::vector<std::uint8_t>;
  [[nodiscard]] Image load();
  [[nodiscard]] Image load_others(std::uint8_t group);
  AbortCode store(Image image);
  AbortCode save(std::uint8_t group);
  AbortCode restore(std::uint8_t group);
  void save_written(const Entry& entry);
  [[nodiscard]] bool is_stored(const Entry& entry) const noexcept;

  NodeContext& node_;
  ParameterStore* store_ = nullptr;
  Image own_image_;
  std::uint32_t save_all_ = 0;  // where 1010:01 lies in the value block
  std::uint32_t value_before_ = 0;
  bool marks_entries_ = false;  // the dictionary says what is stored
  bool restore_pending_ = false;
  bool has_save_all_ = false;
};

}  // namespace canopus::canopen
