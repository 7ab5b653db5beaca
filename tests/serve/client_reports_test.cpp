#include "canopus/serve/client_reports.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plant/event.hpp"

namespace canopus::serve::client_reports_test {
namespace {

using ::testing::ElementsAre;
using namespace std::chrono_literals;

class Lines final : public plant::PlantObserver {
 public:
  void on(const plant::Event& event) override {
    const auto& failure = std::get<plant::Failure>(event.what);
    lines.push_back(failure.source + ": " + failure.message);
  }
  std::vector<std::string> lines;
};

TEST(ClientReports, FewReports_AreAllErrorsOfTheirSource) {
  Lines out;
  can::Timeline timeline;
  ClientReports reports(out, timeline, "socketcand line1");
  reports("10.0.0.7:5000 left");
  EXPECT_THAT(out.lines, ElementsAre("socketcand line1: 10.0.0.7:5000 left"));
}

TEST(ClientReports, ManyReportsInASecond_AreCountedAndSaidLater) {
  Lines out;
  can::Timeline timeline;
  ClientReports reports(out, timeline, "MC protocol plc1");
  for (int i = 0; i < 1000; ++i) reports("again");
  EXPECT_EQ(out.lines.size(), ClientReports::most_lines);
  timeline.run_until(can::Time(1s));
  out.lines.clear();
  reports("later");
  EXPECT_THAT(out.lines, ElementsAre("MC protocol plc1: 995 reports of clients were left out",
                                     "MC protocol plc1: later"));
}

}  // namespace
}  // namespace canopus::serve::client_reports_test
