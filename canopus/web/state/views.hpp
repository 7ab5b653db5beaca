#pragma once
// What the page looks at beside the state of the plant: the buffer memory of a module, the boots of slaves, objects of a
// node, the traffic of a bus (docs/web.md, docs/events.md). A view changes nothing and is no access of the program; what no client asks for costs nothing.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"
#include "canopus/web/state/boots.hpp"
#include "canopus/web/state/traffic.hpp"

namespace canopus::web {

class WebViews {
 public:
  static constexpr std::size_t most_words = 256;  ///< of one view

  /// Both must outlive this. To be made before the plant is switched on.
  WebViews(plant::Plant& plant, const WebBoots& boots);
  ~WebViews();
  WebViews(const WebViews&) = delete;
  WebViews& operator=(const WebViews&) = delete;

  /// The event of a view, one of
  ///   {"words": MODULE, "find": "...", "from": 0, "count": 100}  words of the module of that number whose name, address, PDO,
  ///                                                              CAN-ID or sender holds this text, from the one of that number on
  ///   {"boots": true}
  ///   {"objects": NODE, ...}  web_objects.hpp
  ///   {"traffic": BUS, ...}   web_traffic.hpp
  ///   {"values": [...]}       web_values.hpp
  ///   {"meaning": "1017:00"}  web_objects.hpp
  ///   {"errors": MODULE}      node_detail_view.hpp
  ///   {"domain": NODE, ...}   node_detail_view.hpp
  ///   {"program": PLC, ...}   program_views.hpp
  ///   {"variables": PLC, ...} program_views.hpp
  /// as JSON; empty: it is none. An empty text: no client has views any more.
  [[nodiscard]] std::string event_of(std::string_view view);
  [[nodiscard]] const WebTraffic& traffic() const noexcept { return traffic_; }

 private:
  using Json = text::Json;
  /// A module with its names of words.
  struct Module {
    std::string name;
    std::string bus;
    const plant::CatalogueEntry* entry = nullptr;
    module::CommunicationModule* module = nullptr;
    /// Words that have a name, by address.
    struct Word {
      std::uint16_t address = 0;
      std::uint16_t row = 0;  ///< in the catalogue
    };
    std::vector<Word> words{};
  };
  /// When frames of base identifiers were last on a bus.
  class Tap final : public can::BusObserver {
   public:
    explicit Tap(const bool& is_looked_at) : is_looked_at_(is_looked_at) { last.fill(can::never); }
    void frame_completed(const can::Frame& frame, can::Time start, can::Time end) override;
    std::array<can::Time, 2048> last{};

   private:
    const bool& is_looked_at_;
  };
  /// The PDO that a process data word goes with.
  struct ProcessWord {
    bool received = false;
    unsigned pdo = 0;
    std::uint32_t identifier = 0;
  };
  /// The same as texts: "RPDO1", "183", "node 3 (encoder) TPDO1".
  struct Source {
    std::string pdo{};
    std::string can_id{};
    std::string sender{};
  };
  /// Of the plant's devices, by base identifier.
  using Senders = std::map<std::uint32_t, std::string>;

  void list_modules();
  [[nodiscard]] std::string words_event(const text::Json& view);
  [[nodiscard]] std::string boots_event() const;
  /// By address.
  [[nodiscard]] std::map<std::uint16_t, ProcessWord> process_words(const Module& module) const;
  [[nodiscard]] Senders senders_on(std::string_view bus) const;
  [[nodiscard]] static Source source_of(const ProcessWord& word, const Senders& senders);

  plant::Plant& plant_;
  const WebBoots& boots_;
  std::vector<Module> modules_;
  std::vector<std::unique_ptr<Tap>> taps_;  ///< of each bus
  bool is_looked_at_ = false;
  WebTraffic traffic_;
};

}  // namespace canopus::web
