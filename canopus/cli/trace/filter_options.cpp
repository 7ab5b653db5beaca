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
          "Only messages that match all of these terms, as on the page of a run: 'service=sdo,pdo node=3 "
          "!object=6000 abort=06020000 \"a text\"'; all SDO aborts: 'service=sdo abort'")
      ->type_name("EXPRESSION");
  list("--node", options.nodes,
       "Only messages of this node: its node-ID, or what its name begins with; may be given again", "NODE");
  command.add_old_spelling({.old = "--only-node", .now = "--node"});
  list("--service", options.services,
       "Only this service: nmt, flying-master, sync, time, emcy, pdo, mpdo, sdo, error-control, lss, layer2, "
       "error-frame, failsafe; may be given again",
       "SERVICE");
  list("--object", options.objects,
       "Only SDOs and PDOs with this object, as 6000 or 6000:01; may be given again", "OBJECT");
  list("--can-id", options.identifiers, "Only frames of this CAN-ID, hexadecimal; may be given again", "ID");
  command.add_old_spelling({.old = "--id", .now = "--can-id"});
  if (!of_file) return;
  list("--channel", options.channels, "Only this channel of the file; may be given again", "NAME");
  command.add_option("--from", options.from, "Only from this time after the first frame on, as 1.5s")
      ->type_name("TIME");
  command.add_option("--to", options.to, "Only up to this time after the first frame")->type_name("TIME");
}

}  // namespace canopus::cli
