#include "canopus/text/json_fields.hpp"

namespace canopus::text {

const Json& field(const Json& object, std::string_view key) {
  static const Json none;
  const auto found = object.find(key);
  return found == object.end() ? none : *found;
}

std::string field_text(const Json& object, std::string_view key) {
  const Json& value = field(object, key);
  if (value.is_null()) return "";
  return value.is_string() ? value.string() : value.dump();
}

double field_number(const Json& object, std::string_view key) {
  const Json& value = field(object, key);
  return value.is_number() ? value.get<double>() : 0;
}

const Json& field_list(const Json& object, std::string_view key) {
  static const Json none = Json::array();
  const Json& value = field(object, key);
  return value.is_array() ? value : none;
}

}  // namespace canopus::text
