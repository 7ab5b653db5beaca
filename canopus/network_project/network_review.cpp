#include "canopus/network_project/network_review.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/network_project/network_load.hpp"
#include "canopus/network_project/pdo_link.hpp"

namespace canopus::network_project {
namespace {

using Severity = eds::Problem::Severity;

class Review {
 public:
  Review(const NetworkProject& project, const ExternalPdos& external)
      : project_(project), external_(external) {}

  std::vector<Finding> run() {
    for (const eds::Problem& problem : project_.list().problems()) {
      found_.push_back({problem.severity, 0, project_.list_path(), problem.line, problem.message});
    }
    if (!project_.notes().problem().empty()) {
      found_.push_back({Severity::warning, 0, notes_path(project_.list_path()), project_.notes().line(),
                        project_.notes().problem() + ": no note is shown"});
    }
    for (const ProjectNode& node : project_.nodes()) files_of(node);
    bit_rates();
    process_data();
    heartbeats();
    load();
    std::ranges::stable_sort(found_, [](const Finding& a, const Finding& b) {
      return std::pair(a.severity, a.node_id) < std::pair(b.severity, b.node_id);
    });
    return std::move(found_);
  }

 private:
  /// About a node, at the line of its object if there is one.
  void report(Severity severity, const ProjectNode& node, std::uint16_t index, std::string message) {
    unsigned line = 0;
    if (node.device != nullptr && index != 0) {
      const auto* facts = node.device->find_facts(index, 1);
      if (facts == nullptr) facts = node.device->find_facts(index, 0);
      if (facts != nullptr) line = facts->line;
    }
    found_.push_back({severity, node.id(), line == 0 ? project_.list_path() : node.path,
                      line == 0 ? node.listed.line : line,
                      fmt::format("{}: {}", node.shown_name(), std::move(message))});
  }
  void report_network(Severity severity, std::string message) {
    found_.push_back({severity, 0, project_.list_path(), 0, std::move(message)});
  }

  void files_of(const ProjectNode& node) {
    if (!node.path_note.empty()) report(Severity::note, node, 0, node.path_note);
    if (node.device == nullptr) {
      if (node.path.empty()) return;  // the list's own problem
      found_.push_back({Severity::error, node.id(), node.path, 0, node.unreadable});
      return;
    }
    for (const eds::Problem& problem : node.problems) {
      if (problem.severity == Severity::note) continue;
      const Severity severity = problem.severity == Severity::loss ? Severity::warning : problem.severity;
      found_.push_back({severity, node.id(), node.path, problem.line, problem.message});
    }
    const auto& commissioning = node.device->commissioning;
    if (!commissioning) {
      return report(
          Severity::warning, node, 0,
          fmt::format("{} has no [DeviceComissioning]: it is an EDS, not the DCF of a node", node.path));
    }
    if (const unsigned id = commissioning->node_id.value_or(0); id != 0 && id != node.id()) {
      report(
          Severity::error, node, 0,
          fmt::format("{} is the DCF of node {}: its NodeID and the list must say the same", node.path, id));
    }
    if (!commissioning->node_name.empty() && commissioning->node_name != node.listed.name) {
      report(Severity::note, node, 0,
             fmt::format("its DCF calls it \"{}\"", eds::printable(commissioning->node_name)));
    }
  }

  void bit_rates() {
    std::map<std::uint32_t, const ProjectNode*> rates;
    for (const ProjectNode& node : project_.nodes()) {
      if (node.device == nullptr || !node.device->commissioning) continue;
      const std::uint32_t rate = node.device->commissioning->bit_rate;
      if (rate == 0) continue;
      rates.emplace(rate, &node);
      const auto& known = node.device->device.bit_rates;
      if (!known.empty() && std::ranges::find(known, rate) == known.end()) {
        report(Severity::error, node, 0,
               fmt::format("its device file does not have {} kbit/s among its bit rates", rate / 1000));
      }
    }
    if (rates.size() > 1) {
      std::string shown;
      for (const auto& [rate, node] : rates) {
        shown += fmt::format("{}{} kbit/s ({})", shown.empty() ? "" : ", ", rate / 1000, node->shown_name());
      }
      report_network(Severity::error, "the DCFs have more than one bit rate: " + shown);
    } else if (rates.empty() && !project_.nodes().empty()) {
      report_network(Severity::warning, "no DCF has a bit rate, so no load can be calculated");
    }
  }

  struct ActivePdo {
    const ProjectNode* node;
    const Pdo* pdo;
  };

  /// Each RPDO and the sender of its frame.
  void process_data() {
    std::multimap<std::uint32_t, ActivePdo> senders;
    for_each_active(true, [&](ActivePdo pdo) {
      const auto [begin, end] = senders.equal_range(pdo.pdo->cob_id.key());
      for (auto other = begin; other != end; ++other) {
        // A plant reports two senders as well.
        if (other->second.node != pdo.node) continue;
        report(
            Severity::error, *pdo.node, pdo.pdo->communication_index(),
            fmt::format("{} and {} have {} both: receivers cannot distinguish them; give one another CAN-ID",
                        other->second.pdo->name(), pdo.pdo->name(), describe_can_id(pdo.pdo->cob_id)));
      }
      senders.emplace(pdo.pdo->cob_id.key(), pdo);
    });
    std::map<std::uint32_t, unsigned> taken;
    for_each_active(false, [&](ActivePdo pdo) {
      ++taken[pdo.pdo->cob_id.key()];
      const auto [begin, end] = senders.equal_range(pdo.pdo->cob_id.key());
      if (begin == end && !external_.sent.contains(pdo.pdo->cob_id.key())) {
        report(Severity::note, *pdo.node, pdo.pdo->communication_index(),
               fmt::format("{} waits for {}, which no node of the project sends", pdo.pdo->name(),
                           describe_can_id(pdo.pdo->cob_id)));
      }
      for (auto sender = begin; sender != end; ++sender) compare(sender->second, pdo);
    });
    for (const auto& [key, sender] : senders) {
      if (taken.contains(key) || external_.received.contains(key)) continue;
      report(Severity::note, *sender.node, sender.pdo->communication_index(),
             fmt::format("no node of the project receives its {} ({})", sender.pdo->name(),
                         describe_can_id(sender.pdo->cob_id)));
    }
  }

  template <typename Visit>
  void for_each_active(bool transmit, Visit visit) const {
    for (const ProjectNode& node : project_.nodes()) {
      if (!node.listed.present) continue;
      for (const Pdo& pdo : node.pdos) {
        if (pdo.transmit == transmit && pdo.is_active()) visit(ActivePdo{&node, &pdo});
      }
    }
  }

  void compare(ActivePdo sender, ActivePdo consumer) {
    const std::string sender_name = fmt::format("{} of {}", sender.pdo->name(), sender.node->shown_name());
    if (consumer.pdo->length() > sender.pdo->length()) {
      return report(Severity::error, *consumer.node, consumer.pdo->mapping_index(),
                    fmt::format("{} maps {}, but {} sends {} with {}: a frame that is too short is not taken "
                                "(EMCY 8210H); map fewer objects here or more there",
                                consumer.pdo->name(), ascii::counted(consumer.pdo->length(), "byte"),
                                sender_name, sender.pdo->length(), describe_can_id(sender.pdo->cob_id)));
    }
    unsigned bit = 0;
    for (const MappedObject& object : consumer.pdo->mapping) {
      if (!object.is_dummy()) compare(sender, consumer, object, bit, sender_name);
      bit += object.bits;
    }
  }

  void compare(ActivePdo sender, ActivePdo consumer, const MappedObject& object, unsigned bit,
               const std::string& sender_name) {
    unsigned sent_bit = 0;
    const MappedObject* sent = nullptr;
    for (const MappedObject& one : sender.pdo->mapping) {
      if (sent_bit + one.bits > bit) {
        sent = &one;
        break;
      }
      sent_bit += one.bits;
    }
    if (sent == nullptr) return;
    const std::string own_name = eds::object_text(object.index, object.sub);
    const std::string sent_name = eds::object_text(sent->index, sent->sub);
    if (sent_bit != bit || sent->bits != object.bits) {
      return report(Severity::warning, *consumer.node, consumer.pdo->mapping_index(),
                    fmt::format("{} takes bits {} to {} as {}, but there {} has {} in bits {} to {}",
                                consumer.pdo->name(), bit, bit + object.bits - 1, own_name, sender_name,
                                sent_name, sent_bit, sent_bit + sent->bits - 1));
    }
    const auto type = [](const ProjectNode& node, const MappedObject& one) {
      const canopen::Entry entry = node.device->dictionary->find(one.index, one.sub);
      return entry ? entry.description->type : canopen::DataType::none;
    };
    const canopen::DataType own_type = type(*consumer.node, object);
    const canopen::DataType sent_type = type(*sender.node, *sent);
    if (own_type == canopen::DataType::none || sent_type == canopen::DataType::none || own_type == sent_type)
      return;
    report(Severity::note, *consumer.node, consumer.pdo->mapping_index(),
           fmt::format("{}: {} is {}, and {} of {} that it gets is {}", consumer.pdo->name(), own_name,
                       eds::name(own_type), sent_name, sender_name, eds::name(sent_type)));
  }

  /// Consumers are held against their producers; the check of a plant reports missing and slow ones, too.
  void heartbeats() {
    for (const ProjectNode& node : project_.nodes()) {
      const bool guards = node.value(0x100C).value_or(0) != 0 && node.value(0x100D).value_or(0) != 0;
      if (guards && node.value(0x1017).value_or(0) != 0) {
        report(
            Severity::warning, node, 0x1017,
            "has a heartbeat (1017H) and node guarding (100CH, 100DH): the heartbeat counts, set 100CH to 0");
      }
    }
  }

  void load() {
    const NetworkLoad load = reckon_load(project_);
    if (load.bit_rate == 0) return;
    if (load.steady > 1) {
      report_network(
          Severity::error,
          fmt::format("timers and SYNC alone take {:.0f} % of {} kbit/s: make them slower, or the bus "
                      "faster",
                      load.steady * 100, load.bit_rate / 1000));
    } else if (load.most > 1) {
      report_network(Severity::warning,
                     fmt::format("when all values change at once, {:.0f} % of {} kbit/s are "
                                 "needed: longer inhibit times would limit that",
                                 load.most * 100, load.bit_rate / 1000));
    }
    if (load.unlimited != 0) {
      report_network(
          Severity::note,
          fmt::format("{} TPDO{} sent at every change without an inhibit time: one value that moves fast "
                      "can fill the bus",
                      load.unlimited, load.unlimited == 1 ? " is" : "s are"));
    }
  }

  const NetworkProject& project_;
  const ExternalPdos& external_;
  std::vector<Finding> found_;
};

}  // namespace

std::vector<Finding> review(const NetworkProject& project, const ExternalPdos& external) {
  return Review(project, external).run();
}

}  // namespace canopus::network_project
