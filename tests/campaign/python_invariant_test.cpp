// An invariant that is a function in Python.

#include "canopus/campaign/plant_run.hpp"

#include "campaign_folder.hpp"

namespace canopus::campaign::python_invariant_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class PythonInvariant : public test::CampaignFolder {
 protected:
  /// A run of 4 s of the first plant, with this function `check` in checks.py.
  RunResult run_with(const std::string& python, const std::string& more = "") {
    write("checks.py", python);
    const auto campaign = load(
        text("duration = \"4s\"",
             "[[invariant]]\nname = \"p\"\nkind = \"python\"\nfile = \"checks.py\"\nfunction = \"check\"\n" +
                 more));
    EXPECT_TRUE(campaign) << err_.text();
    return campaign ? run_or_fail(*campaign, plan_of(*campaign, 0, 1)) : RunResult{};
  }
  std::string refusal_of(const std::string& python, const std::string& function = "check") {
    write("checks.py", python);
    EXPECT_FALSE(
        load(text("duration = \"1s\"",
                  "[[invariant]]\nname = \"p\"\nkind = \"python\"\nfile = \"checks.py\"\nfunction = \"" +
                      function + "\"\n")));
    return err_.text();
  }
};

TEST_F(PythonInvariant, ThatHolds_IsNoFailure) {
  EXPECT_THAT(run_with("def check(events):\n    print('seen by people')\n    assert any(e['event'] == 'boot' "
                       "for e in events)\n")
                  .failures,
              IsEmpty());
  EXPECT_THAT(run_with("def check(events):\n    return True\n").failures, IsEmpty());
}

TEST_F(PythonInvariant, ThatRaises_FailsAtTheEventWithItsTraceback) {
  const RunResult result = run_with(R"(
def check(events):
    for event in events:
        inner(event)

def inner(event):
    assert not (event["event"] == "boot" and event["node"] == 4), f"node {event['node']} has booted"
)");
  ASSERT_THAT(result.failures, SizeIs(1));
  const InvariantFailure& failure = result.failures.front();
  EXPECT_EQ(failure.fingerprint(), "p: AssertionError: node # has booted");
  EXPECT_EQ(failure.detail, "AssertionError: node 4 has booted");
  EXPECT_GT(failure.at, can::Time{});
  EXPECT_LT(failure.at, can::Time{} + std::chrono::seconds(3));
  EXPECT_THAT(failure.traceback, HasSubstr("line 7, in inner"));
  EXPECT_THAT(failure.traceback, testing::Not(HasSubstr("importlib")));
}

TEST_F(PythonInvariant, ThatReturnsATextOrFalse_Fails) {
  EXPECT_EQ(run_with("def check(events):\n    return 'too slow'\n").failures.front().fingerprint(),
            "p: too slow");
  EXPECT_EQ(run_with("def check(events):\n    return False\n").failures.front().fingerprint(),
            "p: check returned False");
  EXPECT_THAT(run_with("def check(events):\n    return 5\n").failures.front().detail,
              HasSubstr("type int; expected None, True, False or text"));
}

TEST_F(PythonInvariant, WithAFilter_GetsTheMessages) {
  EXPECT_THAT(run_with("def check(events):\n    return any(e['event'] == 'message' and e['service'] == 'nmt' "
                       "for e in events)\n",
                       "filter = \"service=nmt\"\n")
                  .failures,
              IsEmpty());
}

TEST_F(PythonInvariant, KeepsNothingFromRunToRun) {
  write("checks.py",
        "count = 0\ndef check(events):\n    global count\n    count += 1\n    assert count == 1\n");
  const auto campaign = load(
      text("duration = \"1s\"",
           "[[invariant]]\nname = \"p\"\nkind = \"python\"\nfile = \"checks.py\"\nfunction = \"check\"\n"));
  ASSERT_TRUE(campaign) << err_.text();
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    EXPECT_THAT(run_or_fail(*campaign, plan_of(*campaign, 0, seed)).failures, IsEmpty());
}

TEST_F(PythonInvariant, ThatEndsItsProcess_Fails) {
  EXPECT_THAT(run_with("import os\ndef check(events):\n    os._exit(3)\n").failures.front().detail,
              HasSubstr("check gave no result"));
}

TEST_F(PythonInvariant, ThatIsNotThere_IsRefusedWithItsPlace) {
  EXPECT_THAT(refusal_of("def other(events):\n    pass\n"),
              HasSubstr("campaign.toml:8:12: function = \"check\": the file has no function of this name"));
  err_.clear();
  EXPECT_THAT(
      refusal_of("def check(events)\n    pass\n"),
      testing::AllOf(HasSubstr("campaign.toml:7:8: file: "), HasSubstr("cannot be imported: SyntaxError")));
  err_.clear();
  EXPECT_THAT(refusal_of("", "a b"),
              HasSubstr("campaign.toml:8:12: function = \"a b\": expected the name of a function"));
}

TEST_F(PythonInvariant, WithoutPython_IsRefusedWithASentence) {
  const std::string before = std::getenv("PATH");
  ::setenv("PATH", in("").c_str(), 1);
  const std::string refused = refusal_of("def check(events):\n    pass\n");
  ::setenv("PATH", before.c_str(), 1);
  EXPECT_THAT(
      refused,
      HasSubstr("cannot start python3, which an invariant of the campaign needs: No such file or directory"));
}

}  // namespace
}  // namespace canopus::campaign::python_invariant_test
