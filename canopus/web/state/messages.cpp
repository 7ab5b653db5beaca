#include "canopus/web/state/messages.hpp"

#include <utility>

#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/printable.hpp"
#include "canopus/trace/print/message_printer.hpp"

namespace canopus::web {
namespace {

trace::Names names_of(plant::Plant& plant) {
  trace::Names names;
  for (plant::InitialPlantNode& node : plant::initial_nodes(plant)) {
    names.add(trace::describe_node(std::move(node.bus), node.node_id, std::move(node.name),
                                   std::move(node.objects)));
  }
  return names;
}

}  // namespace

WebMessages::WebMessages(plant::Plant& plant) : plant_(plant), decoder_(names_of(plant)) {
  for (std::size_t i = 0; i < plant.bus_count(); ++i) {
    taps_.push_back(std::make_unique<Tap>(*this, static_cast<std::uint16_t>(i)));
    plant.bus(i).add_observer(*taps_.back());
  }
}

WebMessages::~WebMessages() {
  for (std::size_t i = 0; i < taps_.size(); ++i) plant_.bus(i).remove_observer(*taps_[i]);
}

void WebMessages::Tap::frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) {
  if (!messages_.is_wanted_) return;
  auto& frames = messages_.frames_;
  frames.push_back({.time = end, .channel = bus_, .frame = frame});
  if (frames.size() <= most_frames) return;
  frames.pop_front();
  ++messages_.left_out_;
}

std::string WebMessages::new_messages(bool wanted) {
  if (!wanted || !std::exchange(is_wanted_, true)) {
    is_wanted_ = wanted;
    frames_.clear();
    left_out_ = 0;
    return {};
  }
  if (frames_.empty()) return {};
  text::Json event = plant::event_line(plant_.timeline().now(), "messages");
  event["left_out"] = std::exchange(left_out_, 0);
  event["messages"] = text::Json::array();
  for (const trace::TraceRecord& record : std::exchange(frames_, {})) {
    const std::string& bus = plant_.bus(record.channel).name();
    decoder_.receive(record, bus, [&](const trace::Message& message) {
      event["messages"].push_back(trace::to_json(message, bus));
    });
  }
  return text::printable_json(event.dump());
}

}  // namespace canopus::web
