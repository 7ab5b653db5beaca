// The names that an invariant may have for events are those of the lines of a run.

#include <utility>

#include <gmock/gmock.h>

#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"

namespace canopus::campaign::event_names_test {
namespace {

template <std::size_t Number>
plant::Event event_of() {
  return {.time = {}, .what = std::variant_alternative_t<Number, decltype(plant::Event::what)>{}};
}

template <std::size_t... Numbers>
void compare(std::index_sequence<Numbers...>) {
  for (const plant::Event& event : {event_of<Numbers>()...}) {
    text::TextOutput out;
    plant::JsonPrinter(out).on(event);
    const auto line = text::parse_json(out.text());
    ASSERT_TRUE(line) << out.text();
    EXPECT_EQ(line->value("event", ""), plant::name_of(event));
  }
}

TEST(EventNames, AreThoseOfTheLines) { compare(std::make_index_sequence<plant::event_names.size()>()); }

}  // namespace
}  // namespace canopus::campaign::event_names_test
