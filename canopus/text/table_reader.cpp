#include "canopus/text/table_reader.hpp"

namespace canopus::text {

namespace {

struct Synonym {
  std::string_view written;
  std::string_view meant;
};
constexpr Synonym synonyms[] = {
    {"baud", "bit_rate"}, {"baud_rate", "bit_rate"}, {"baudrate", "bit_rate"}, {"bitrate", "bit_rate"},
    {"dcf", "eds"},       {"eds_file", "eds"},       {"file", "eds"},          {"head", "position"},
    {"head", "unit"},     {"head_address", "head"},  {"id", "node"},           {"interface", "link"},
    {"io", "head"},       {"node_id", "node"},       {"nodeid", "node"},       {"position", "head"},
    {"position", "unit"}, {"slot", "head"},          {"slot", "position"},     {"unit", "head"},
    {"unit", "position"}, {"position", "card"},      {"slot", "card"},         {"address", "listen"},
    {"port", "listen"},   {"cycle", "period"},       {"type", "kind"},         {"type", "model"},
    {"od", "objects"},    {"parameters", "objects"},
};

}  // namespace

std::string_view usual_synonym(std::string_view key, const std::vector<std::string>& known) {
  for (const Synonym& synonym : synonyms) {
    if (synonym.written == key && std::ranges::find(known, synonym.meant) != known.end())
      return synonym.meant;
  }
  return {};
}

}  // namespace canopus::text
