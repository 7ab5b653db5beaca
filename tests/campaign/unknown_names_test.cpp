// Every name in a campaign file that its plant does not have is refused before the first run: file, line, column, field, what was found
// and what was expected.

#include "campaign_folder.hpp"

namespace canopus::campaign::unknown_names_test {
namespace {

using testing::HasSubstr;

const std::string up = R"([[invariant]]
name = "up"
kind = "operational"
within = "30s"
)";

struct Mistake {
  std::string name;
  std::string
      rest;  ///< behind [campaign], whose three lines are the first ones, and `up`: line 8 is its first line
  std::string error;  ///< from the line on
};

class UnknownName : public test::CampaignFolder, public testing::WithParamInterface<Mistake> {};

TEST_P(UnknownName, IsRefusedWithItsPlaceAndWhatWasExpected) {
  EXPECT_FALSE(load(text("duration = \"1s\"", up + GetParam().rest)));
  EXPECT_THAT(err_.text(), HasSubstr("campaign.toml:" + GetParam().error));
}

std::string rule(const std::string& lines) { return "[[rule]]\nname = \"x\"\n" + lines + "\n"; }
std::string invariant(const std::string& lines) { return "[[invariant]]\nname = \"x\"\n" + lines + "\n"; }

INSTANTIATE_TEST_SUITE_P(
    Each, UnknownName,
    testing::Values(
        Mistake{"Event", invariant("kind = \"event\"\nevent = \"errors\""),
                "11:9: event = \"errors\": expected one of boot, nmt, lss, emcy, unacknowledged, bus error, "
                "controller, boot slave, "
                "signal, buffer, forced, released, lift, load, warning, module event, module error, error"},
        Mistake{"Node", invariant("kind = \"operational\"\nwithin = \"1s\"\nnodes = [\"encodr\"]"),
                "12:9: invariant \"x\": nodes: the plant has no node \"encodr\"; did you mean \"encoder\"?"},
        Mistake{"DeviceOfAValue",
                invariant("kind = \"value\"\ndevice = \"pump\"\nobject = \"6004:00\"\nlow = 0"),
                "11:10: invariant \"x\": device = \"pump\": the plant has no device of this name; expected "
                "io-block, encoder or drive"},
        Mistake{"Object", invariant("kind = \"value\"\ndevice = \"encoder\"\nobject = \"7777:00\"\nlow = 0"),
                "12:10: invariant \"x\": object: "},
        Mistake{"Word", invariant("kind = \"value\"\nword = 'U9\\G5'\nlow = 0"),
                "11:8: invariant \"x\": word: the PLC has no U9\\G5"},
        Mistake{"Variable", invariant("kind = \"value\"\nvariable = \"speed\"\nlow = 0"),
                "11:12: invariant \"x\": variable: the PLC has no program"},
        Mistake{"PlcOfAValue", invariant("kind = \"value\"\nplc = \"plc9\"\nword = 'D1'\nlow = 0"),
                "11:7: invariant \"x\": plc = \"plc9\": the plant has no PLC of this name; did you mean "
                "\"plc1\"?"},
        Mistake{"DeviceOfAPowerCut", rule("device = \"encoder2\"\npower_cut = { at = \"1s\" }"),
                "10:10: rule \"x\": device = \"encoder2\": the plant has no device of this name; did you "
                "mean \"encoder\"?"},
        Mistake{"KeyOfAPowerCut", rule("device = \"encoder\"\npower_cut = { at = \"1s\", four = \"1s\" }"),
                "11:26: rule \"x\": power_cut: unknown key four; did you mean for?"},
        Mistake{"DeviceOfASet", rule("device = \"pump\"\nset = { start = \"1s\" }"),
                "10:10: rule \"x\": device = \"pump\": the plant file has no device of this name; expected "
                "io-block, encoder or drive"},
        Mistake{"KeyOfASet", rule("device = \"encoder\"\nset = { strat = \"1s\" }"),
                "11:9: rule \"x\": device: unknown key strat; did you mean start?"},
        Mistake{"Bus", rule("bus = \"line9\"\nfault = { kind = \"noise\", bit_error_rate = 1e-6 }"),
                "10:7: rule \"x\": bus = \"line9\": the plant file has no bus of this name; did you mean "
                "\"line1\"?"},
        Mistake{"KeyOfAFault", rule("fault = { kind = \"noise\", bit_error_rate = 1e-6, rate = 1 }"),
                "10:50: rule \"x\": bus.fault: unknown key rate; expected one of"},
        Mistake{"MissingKeyOfAFault", rule("fault = { kind = \"noise\" }"),
                "10:9: rule \"x\": bus.fault: bit_error_rate is missing; expected a number"},
        Mistake{"KindOfAFault", rule("fault = { kind = \"nois\" }"),
                "10:11: rule \"x\": kind = \"nois\": expected"},
        Mistake{"WordOfAWrite", rule("write = { at = \"1s\", word = \"D99999\", value = 1 }"),
                "10:22: rule \"x\": word: "},
        Mistake{"VariableOfAWrite", rule("write = { at = \"1s\", variable = \"speed\", value = 1 }"),
                "10:22: rule \"x\": variable: the PLC has no program"},
        Mistake{"Knob", rule("fault = { kind = \"noise\", bit_error_rate = { low = 1e-7, hihg = 1e-6 } }"),
                "10:44: expected { low = 1, high = 5 } or { choose = [1, 2, 5] }"},
        Mistake{"Choice", rule("fault = { kind = \"noise\", bit_error_rate = { chose = [1e-7] } }"),
                "10:44: expected { low = 1, high = 5 } or { choose = [1, 2, 5] }"},
        Mistake{"KeyOfARule", rule("fault = { kind = \"noise\", bit_error_rate = 1e-6 }\nchanse = 1"),
                "11:1: rule: unknown key chanse; did you mean chance?"},
        Mistake{"KeyOfAnInvariant", invariant("kind = \"operational\"\nwithin = \"1s\"\nnode = [\"drive\"]"),
                "12:1: invariant: unknown key node; did you mean nodes?"},
        Mistake{
            "DeviceOfAVariant",
            "[[variant]]\nname = \"v\"\n[[variant.change]]\ndevice = \"pump\"\nset = { start = \"1s\" }\n",
            "8:1: device = \"pump\": the plant file has no device of this name"},
        Mistake{"PythonFile", invariant("kind = \"python\"\nfile = \"checks.py\"\nfunction = \"f\""),
                "11:8: file: there is no file "}),
    [](const auto& each) { return each.param.name; });

class KnownName : public test::CampaignFolder {};

TEST_F(KnownName, OfAnEvent_IsAccepted) {
  for (const std::string_view name : {"boot", "lift", "module error", "error"}) {
    EXPECT_TRUE(
        load(text("duration = \"1s\"", invariant("kind = \"event\"\nevent = \"" + std::string(name) + "\""))))
        << name << err_.text();
  }
}

}  // namespace
}  // namespace canopus::campaign::unknown_names_test
