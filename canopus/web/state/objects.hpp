#pragma once
// The object dictionary of a simulated device or module node as rows for the page. The values are read where they are: no
// SDO, no handler of an object is asked, nothing on the bus.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"

namespace canopus::web {

inline constexpr std::size_t most_objects = 256;  ///< of one view

/// The node of that place in Plant::nodes(), modules first; nullptr: there is none.
[[nodiscard]] const canopen::Node* node_at(plant::Plant& plant, std::size_t place);

/// The event of a view {"objects": NODE, "find": "...", "from": 0, "count": 100}: sub-indexes of the node of that number in
/// `state` whose name or index holds this text; empty: there is no such node.
[[nodiscard]] std::string objects_event(plant::Plant& plant, const text::Json& wish);

/// The event of a view {"meaning": "1017:00"}: what this object of CiA 301, 302 or 402 is for, as far as it is known; empty:
/// that is no object.
[[nodiscard]] std::string meaning_event(plant::Plant& plant, const text::Json& wish);

/// The value of an object of variable length of that node; of a module the concise DCFs that it keeps for its slaves, too.
[[nodiscard]] std::span<const std::uint8_t> bytes_of_object(plant::Plant& plant, std::size_t place,
                                                            const canopen::ObjectDictionary& objects,
                                                            const canopen::Entry& entry);

/// "1f22:05", in lower-case letters; nothing: it is no object.
struct ViewedObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
};
[[nodiscard]] std::optional<ViewedObject> object_of_view(std::string_view text);

/// Adds `of` (sub-indexes that hold the text) and `rows`, `count` of them from number `from` on. `lower_find` is in lower-case
/// letters; `node_id` is for defaults. `bytes`: the value of an object of variable length, where it is not that in `objects`.
using BytesOfEntry = std::function<std::span<const std::uint8_t>(const canopen::Entry&)>;
void add_objects(text::Json& event, const canopen::ObjectDictionary& objects, std::uint8_t node_id,
                 std::string_view lower_find, std::size_t from, std::size_t count,
                 const BytesOfEntry& bytes = {});

}  // namespace canopus::web
