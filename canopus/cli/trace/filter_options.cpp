#include "canopus/cli/trace/filter_options.hpp"

#include <string>
#include <vector>

#include "canopus/cli/options/command.hpp"

namespace canopus::cli {

void add_filter_options(Command& command, trace::FilterOptions& options, bool of_file) {
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* help,
                        const char* type) {
    command.add_option(name, values, help)->type_name(type)->allow_extra_args(false);
  };
  command
      .add_option(
          "--filter", options.expression,
          "Only messages for which all of this holds, as on the page of a run: 'service=sdo,pdo node=3 "
          "!object=6000 \"a text\"'")
      ->type_name("EXPRESSION");
  list("--only-node", options.nodes, "Only messages of this node-ID; may be repeated", "ID");
  list("--service", options.services,
       "Only this service: nmt, flying-master, sync, time, emcy, pdo, mpdo, sdo, error-control, lss, layer2, "
       "error-frame, failsafe; may be repeated",
       "SERVICE");
  list("--object", options.objects,
       "Only SDOs and PDOs with this object, as 6000 or 6000:01; may be repeated", "OBJECT");
  list("--id", options.identifiers, "Only frames of this identifier, hexadecimal; may be repeated", "ID");
  if (!of_file) return;
  list("--channel", options.channels, "Only this channel of the file; may be repeated", "NAME");
  command.add_option("--from", options.from, "Only from this time after the first frame on, as 1.5s")
      ->type_name("TIME");
  command.add_option("--to", options.to, "Only up to this time after the first frame")->type_name("TIME");
}

}  // namespace canopus::cli
