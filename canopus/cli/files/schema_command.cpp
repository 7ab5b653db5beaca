// `canopus schema plant|network|campaign`: the JSON Schema of a file, for editors.

#include <array>

#include "canopus/campaign/campaign_file.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/commands.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/master/network_file.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/table_schema.hpp"

namespace canopus::cli {
namespace {

struct SchemaRow {
  const char* name;
  const char* help;
  const char* title;
  std::vector<text::FileError> (*read)(const std::string& text);
};
/// A further kind of file is a row here.
constexpr std::array schemas{
    SchemaRow{"plant", "Of plant files, as `canopus run` takes them", "Canopus plant file",
              [](const std::string& text) { return plant::read_plant(text, "plant.toml").errors; }},
    SchemaRow{"network", "Of network files, as `canopus master` takes them", "Canopus network file",
              [](const std::string& text) { return master::read_network(text, "network.toml").errors; }},
    SchemaRow{"campaign", "Of campaign files, as `canopus campaign` takes them", "Canopus campaign file",
              [](const std::string& text) { return campaign::read_campaign(text, "campaign.toml").errors; }},
};

void build_schema_command(Command& schema) {
  schema.require_subcommand(1);
  schema.footer(
      "Editors complete and check a TOML file by its schema: store it, and name it in the file's first "
      "line.\n"
      "It has what the checks of the file expect; `canopus check` finds more.\n"
      "Example: canopus schema plant > plant.schema.json\n"
      "         #:schema ./plant.schema.json");
  for (const SchemaRow& row : schemas) {
    schema.add_subcommand(row.name, row.help)->callback([&row] {
      print_json(text::json_schema(text::schema_of(row.read), row.title));
    });
  }
}

}  // namespace

void add_schema_command(Command& app, int&) {
  app.add_subcommand("schema", "Print the JSON Schema of plant, network and campaign files, for editors",
                     [](Command& schema) { build_schema_command(schema); });
}

}  // namespace canopus::cli
