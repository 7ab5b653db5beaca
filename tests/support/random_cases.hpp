#pragma once
// How many random cases a test tries: a share of them in ./check, all in ./check --all, CANOPUS_SEEDS=N where somebody wants N.

#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace canopus::support {

/// `all`: with the build's option CANOPUS_LONG_TESTS, which sets the variable of that name.
inline unsigned random_cases(unsigned share, unsigned all) {
  if (const char* wanted = std::getenv("CANOPUS_SEEDS"); wanted != nullptr)
    return static_cast<unsigned>(std::strtoul(wanted, nullptr, 10));
  return std::getenv("CANOPUS_LONG_TESTS") != nullptr ? all : share;
}

/// A property of rapidcheck, tried so many times; RC_PARAMS=seed=N has it try others.
template <typename Property>
void expect_property(Property property, unsigned share, unsigned all) {
  rc::detail::TestParams params = rc::detail::configuration().testParams;
  params.maxSuccess = static_cast<int>(random_cases(share, all));
  const auto result = rc::detail::checkTestable(property, rc::detail::TestMetadata{}, params);
  std::ostringstream text;
  rc::detail::printResultMessage(result, text);
  EXPECT_TRUE(result.template is<rc::detail::SuccessResult>()) << text.str();
}

}  // namespace canopus::support
