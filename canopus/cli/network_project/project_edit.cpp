// Commands that change a project.

#include <filesystem>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/cli/network_project/project_command.hpp"
#include "canopus/cli/output/new_file.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/master/dcf_download.hpp"
#include "canopus/store/files.hpp"
#include "canopus/text/file_text.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using network_project::NetworkProject;
using network_project::ProjectNode;
using Json = text::Json;

void print_node(const ProjectArguments& arguments, std::string_view what, const ProjectNode& node) {
  if (arguments.bus.json) {
    return print_json(
        Json{{"event", what}, {"node", node.id()}, {"name", node.listed.name}, {"file", node.path}});
  }
  print_line("{}: {}, {}", node.shown_name(), what, node.path);
}

/// "6000:01=5", "Producer heartbeat time = 500".
struct Setting {
  std::string object;
  std::string value;
};
std::expected<Setting, std::string> parse_setting(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    return std::unexpected(fmt::format("\"{}\": expected OBJECT=VALUE, for example 1017=500", text));
  }
  // A tabulator may be part of a text.
  const auto trimmed = [](std::string_view piece) {
    return std::string(ascii::trim(piece, [](char c) { return c == ' '; }));
  };
  return Setting{trimmed(std::string_view(text).substr(0, equals)),
                 trimmed(std::string_view(text).substr(equals + 1))};
}

}  // namespace

int new_network(const ProjectArguments& arguments) {
  auto folder = ProjectFolder::open(arguments.project, ProjectFolder::For::changing);
  if (!folder) return project_failed(project_code::file, folder.error());
  const auto project = folder->make(arguments.name);
  if (!project) return project_failed(project_code::file, project.error());
  if (const auto saved = folder->save(*project, "new"); !saved) {
    return project_failed(project_code::file, saved.error());
  }
  if (arguments.bus.json) {
    print_json(Json{{"event", "new"}, {"file", folder->shown_list()}});
  } else {
    print_line("{}: a network without nodes", folder->shown_list());
  }
  return project_code::done;
}

int add_network_node(const ProjectArguments& arguments) {
  const auto bit_rate = bit_rate_of(arguments.bit_rate);
  if (!bit_rate) return project_failed(project_code::usage, bit_rate.error());
  const auto text = text::read_file(arguments.file);
  if (!text) return project_failed(project_code::file, text.error());
  const std::string file_name = std::filesystem::path(arguments.file).filename().string();
  return change_network(arguments, "add " + file_name, [&](ProjectFolder&, NetworkProject& project) {
    const auto added = project.add_node({.node_id = static_cast<std::uint8_t>(arguments.node_id),
                                         .name = arguments.name,
                                         .eds = *text,
                                         .eds_name = file_name,
                                         .bit_rate = *bit_rate});
    if (!added) {
      return project_failed(project_code::refused, fmt::format("{}: {}", arguments.file, added.error()));
    }
    print_node(arguments, "added", *project.find(*added));
    return project_code::done;
  });
}

int remove_network_node(const ProjectArguments& arguments) {
  return change_network(arguments, "remove " + arguments.node, [&](ProjectFolder&, NetworkProject& project) {
    const auto node = project.find(arguments.node);
    if (!node) return project_failed(project_code::refused, node.error());
    const ProjectNode gone = **node;
    if (const auto done = project.remove_node(gone.id()); !done) {
      return project_failed(project_code::refused, done.error());
    }
    print_node(arguments, "removed", gone);
    return project_code::done;
  });
}

int set_in_network(const ProjectArguments& arguments) {
  const auto bit_rate = bit_rate_of(arguments.bit_rate);
  if (!bit_rate) return project_failed(project_code::usage, bit_rate.error());
  const bool is_of_network = arguments.node.empty();
  const bool has_node_option =
      arguments.has_reference || arguments.present || arguments.absent || arguments.node_id != 0;
  if (is_of_network && (has_node_option || !arguments.items.empty())) {
    return project_failed(project_code::usage,
                          "NODE is missing: --node-id, --reference, --present, --absent and "
                          "values are a node's");
  }
  if (!is_of_network && *bit_rate != 0) {
    return project_failed(project_code::usage, "--bit-rate is that of all nodes: leave NODE out");
  }
  if (arguments.items.empty() && !has_node_option && !arguments.is_named && *bit_rate == 0) {
    return project_failed(project_code::usage, "nothing to set; expected OBJECT=VALUE, or an option");
  }
  std::string title = "set " + (is_of_network ? std::string("the network") : arguments.node);
  for (const std::string& item : arguments.items) title += " " + item;
  return change_network(arguments, title, [&](ProjectFolder&, NetworkProject& project) {
    const auto refused = [](const std::string& why) { return project_failed(project_code::refused, why); };
    if (is_of_network) {
      if (arguments.is_named) {
        if (const auto done = project.set_name(arguments.name); !done) return refused(done.error());
      }
      if (*bit_rate != 0) {
        if (const auto done = project.set_bit_rate(*bit_rate); !done) return refused(done.error());
      }
      return project_code::done;
    }
    const auto found = project.find(arguments.node);
    if (!found) return refused(found.error());
    const std::uint8_t id = (*found)->id();
    for (const std::string& item : arguments.items) {
      const auto setting = parse_setting(item);
      if (!setting) return project_failed(project_code::usage, setting.error());
      const auto entry = find_object(*project.find(id), setting->object);
      if (!entry) return refused(entry.error());
      if (const auto done = project.set_value(id, entry->index, entry->sub, setting->value); !done) {
        return refused(fmt::format("{}: {}", project.find(id)->shown_name(), done.error()));
      }
    }
    network_project::ListedNode listed = project.find(id)->listed;
    if (arguments.is_named) listed.name = arguments.name;
    if (arguments.has_reference) listed.reference = arguments.reference;
    if (arguments.node_id != 0) listed.node_id = static_cast<std::uint8_t>(arguments.node_id);
    if (arguments.present) listed.present = true;
    if (arguments.absent) listed.present = false;
    if (has_node_option || arguments.is_named) {
      if (const auto done = project.change_node(id, listed); !done) return refused(done.error());
    }
    return project_code::done;
  });
}

int note_in_network(const ProjectArguments& arguments) {
  return change_network(arguments, "note " + arguments.node, [&](ProjectFolder&, NetworkProject& project) {
    const auto found = project.find(arguments.node);
    if (!found) return project_failed(project_code::refused, found.error());
    const ProjectNode& node = **found;
    const bool had_one = !project.notes().note(node.id()).empty();
    if (const auto done = project.set_note(node.id(), arguments.note); !done) {
      return project_failed(project_code::refused, done.error());
    }
    if (arguments.bus.json) {
      print_json(Json{{"event", "noted"}, {"node", node.id()}, {"note", arguments.note}});
    } else {
      print_line("{}: {}", node.shown_name(),
                 !arguments.note.empty() ? "noted"
                 : had_one               ? "the note is taken out"
                                         : "has no note");
    }
    return project_code::done;
  });
}

int unset_in_network(const ProjectArguments& arguments) {
  return change_network(arguments, "unset " + arguments.node, [&](ProjectFolder&, NetworkProject& project) {
    const auto found = project.find(arguments.node);
    if (!found) return project_failed(project_code::refused, found.error());
    const std::uint8_t id = (*found)->id();
    for (const std::string& item : arguments.items) {
      const auto entry = find_object(*project.find(id), item);
      if (!entry) return project_failed(project_code::refused, entry.error());
      if (const auto done = project.remove_value(id, entry->index, entry->sub); !done) {
        return project_failed(project_code::refused, done.error());
      }
    }
    return project_code::done;
  });
}

int undo_in_network(const ProjectArguments& arguments) {
  auto folder = ProjectFolder::open(arguments.project, ProjectFolder::For::changing);
  if (!folder) return project_failed(project_code::file, folder.error());
  const auto title = folder->undo();
  if (!title) return project_failed(project_code::file, title.error());
  if (!*title) return project_failed(project_code::refused, "there is nothing to take back");
  if (arguments.bus.json) {
    print_json(Json{{"event", "undone"}, {"title", **title}});
  } else {
    print_line("taken back: {}", **title);
  }
  return project_code::done;
}

int write_concise_dcf(const ProjectArguments& arguments) {
  return with_network(arguments, [&](const ProjectFolder& folder, const NetworkProject& project) {
    const auto node = project.find(arguments.node);
    if (!node) return project_failed(project_code::refused, node.error());
    if ((*node)->device == nullptr) {
      return project_failed(project_code::file,
                            fmt::format("{}: {}", folder.shown_path((*node)->path), (*node)->unreadable));
    }
    const auto concise = master::concise_dcf_of(*(*node)->device, {}, (*node)->id());
    if (!concise) return project_failed(project_code::refused, concise.error().front().message);
    const auto written =
        write_new_file(arguments.file, {reinterpret_cast<const char*>(concise->data()), concise->size()});
    if (!written) return project_failed(project_code::file, written.error());
    if (!arguments.bus.json)
      print_line("{}: {} for 1F22:{:02X}", arguments.file, ascii::counted(concise->size(), "byte"),
                 (*node)->id());
    return project_code::done;
  });
}

}  // namespace canopus::cli
