// A postdissector for Wireshark and tshark: tables of this plant's names before one fixed piece of Lua.

#include <algorithm>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/trace/decode/object_facts.hpp"
#include "canopus/trace/report/bus_model.hpp"
#include "canopus/trace/report/names_of_others.hpp"

namespace canopus::trace {
namespace {

// The fields of Wireshark's own CANopen dissector are there with `-d can.subdissector,canopen`. The bytes of
// a frame follow four octets behind the beginning of can.len, for every link type.
constexpr std::string_view program = R"lua(
local plant = Proto("canopus", title)
local field_node = ProtoField.uint8("canopus.node", "Node-ID")
local field_name = ProtoField.string("canopus.name", "Node")
local field_pdo = ProtoField.string("canopus.pdo", "PDO")
local field_object = ProtoField.string("canopus.object", "Object")
local fields = { field_node, field_name, field_pdo, field_object }
for _, pdo in pairs(pdos) do
  for _, signal in ipairs(pdo.signals) do
    signal.field = ProtoField.double("canopus.signal." .. signal.id, signal.name)
    table.insert(fields, signal.field)
  end
end
plant.fields = fields

local can_id = Field.new("can.id")
local can_len = Field.new("can.len")
local can_extended = Field.new("can.flags.xtd")
local can_remote = Field.new("can.flags.rtr")
local sdo_index = Field.new("canopen.sdo.main_idx")
local sdo_sub = Field.new("canopen.sdo.sub_idx")

local function number_in(payload, signal)
  local first, bits = signal.first, signal.bits
  if first + bits > payload:len() * 8 then return nil end
  if signal.kind == "real" then
    if first % 8 ~= 0 then return nil end
    return payload:range(math.floor(first / 8), math.floor(bits / 8)):le_float()
  end
  local value, factor = 0, 1
  for bit = first, first + bits - 1 do
    local byte = payload:range(math.floor(bit / 8), 1):uint()
    if math.floor(byte / 2 ^ (bit % 8)) % 2 == 1 then value = value + factor end
    factor = factor * 2
  end
  if signal.kind == "signed" and value >= factor / 2 then value = value - factor end
  return value
end

local function node_of(id)
  if emcy[id] then return emcy[id] end
  local function_code, node = math.floor(id / 128), id % 128
  if node ~= 0 and (function_code == 1 or (function_code >= 3 and function_code <= 12) or function_code == 14) then
    return node
  end
  return nil
end

function plant.dissector(buffer, pinfo, tree)
  local id, length = can_id(), can_len()
  if not id or not length then return end
  local key = id.value
  local extended, remote = can_extended(), can_remote()
  if extended and extended.value then key = key + 0x20000000 end
  local pdo = pdos[key]
  local node = pdo and pdo.node or not (extended and extended.value) and node_of(key)
  if not node or not (nodes[node] or pdo) then return end
  local branch = tree:add(plant)
  branch:add(field_node, node):set_generated()
  if nodes[node] then
    branch:add(field_name, nodes[node]):set_generated()
    branch:append_text(", " .. nodes[node])
  end
  if pdo then
    branch:add(field_pdo, pdo.name):set_generated()
    branch:append_text(", " .. pdo.name)
    if not (remote and remote.value) and length.value > 0 and length.offset + 4 + length.value <= buffer:len() then
      local payload = buffer:range(length.offset + 4, length.value)
      for _, signal in ipairs(pdo.signals) do
        local value = number_in(payload, signal)
        if value then branch:add(signal.field, payload, value) end
      end
    end
  end
  local index, sub = sdo_index(), sdo_sub()
  if index and sub and objects[node] then
    local name = objects[node][index.value * 256 + sub.value]
    if name then
      branch:add(field_object, name):set_generated()
      branch:append_text(", " .. name)
    end
  end
end

register_postdissector(plant)
)lua";

std::string_view kind_of(const Signal& signal) {
  const bool real = (signal.type == canopen::DataType::real32 && signal.bits == 32) ||
                    (signal.type == canopen::DataType::real64 && signal.bits == 64);
  return real ? "real" : canopen::is_signed(signal.type) ? "signed" : "unsigned";
}

std::string objects_table(const NodeDescription& node) {
  std::string table;
  if (!node.dictionary) return table;
  for (const canopen::ObjectDescription& object : node.dictionary->objects()) {
    // Equal sub-indexes share a name: the first ones are enough.
    const unsigned highest = object.uniform ? std::min<unsigned>(object.highest_sub, 64) : object.highest_sub;
    for (unsigned sub = 0; sub <= highest; ++sub) {
      const auto entry = node.dictionary->find(object, static_cast<std::uint8_t>(sub));
      if (!entry) continue;
      const ObjectFacts facts = object_facts(node.dictionary.get(), object.index, entry.sub);
      table += fmt::format("    [0x{:04X}{:02X}] = {},\n", object.index, sub, lua_string(facts.name));
    }
  }
  return table;
}

}  // namespace

std::string lua_dissector(const BusModel& model, std::string_view title) {
  std::string lua =
      "-- Names of a CANopen plant for Wireshark: tshark -X lua_script:FILE -d can.subdissector,canopen\n";
  lua += fmt::format("local title = {}\nlocal nodes = {{\n",
                     lua_string(title.empty() ? "CANopen plant" : title));
  for (const NodeDescription* const node : model.nodes) {
    if (!node->name.empty()) lua += fmt::format("  [{}] = {},\n", node->node_id, lua_string(node->name));
  }
  lua += "}\nlocal emcy = {\n";
  for (const NodeDescription* const node : model.nodes) {
    const auto cob_id =
        std::ranges::find_if(node->settings, [](const Setting& one) { return one.index == 0x1014; });
    if (cob_id != node->settings.end() && (cob_id->value >> 29) == 0)
      lua += fmt::format("  [0x{:X}] = {},\n", cob_id->value & 0x7FFU, node->node_id);
  }
  lua += "}\nlocal pdos = {\n";
  Identifiers identifiers;
  for (const ModelPdo& pdo : model.pdos) {
    const std::string name = fmt::format("{}PDO{}", pdo.transmit ? "T" : "R", pdo.number);
    lua += fmt::format("  [0x{:X}] = {{ node = {}, name = {}, signals = {{\n", pdo.key, pdo.node,
                       lua_string(name));
    for (const Signal& signal : pdo.signals) {
      const std::string shown =
          signal.name.empty() ? canopen::object_text(signal.index, signal.sub) : signal.name;
      const std::string id = identifiers.make(ascii::lower(fmt::format("n{}_{}", pdo.node, shown)), "signal");
      lua += fmt::format("    {{ id = \"{}\", name = {}, first = {}, bits = {}, kind = \"{}\" }},\n", id,
                         lua_string(shown), signal.first_bit, signal.bits, kind_of(signal));
    }
    lua += "  } },\n";
  }
  lua += "}\nlocal objects = {}\n";
  for (const NodeDescription* const node : model.nodes) {
    const std::string table = objects_table(*node);
    if (!table.empty()) lua += fmt::format("objects[{}] = {{\n{}}}\n", node->node_id, table);
  }
  return lua + std::string(program);
}

}  // namespace canopus::trace
