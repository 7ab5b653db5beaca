#include "canopus/web/http/form.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::web::form_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST(WebForm, NamesAndValues) {
  EXPECT_THAT(*read_form("name=anna&password=a+b%26c%3d%C3%A4"),
              ElementsAre(Pair("name", "anna"), Pair("password", "a b&c=\xC3\xA4")));
  EXPECT_THAT(*read_form(""), IsEmpty());
  EXPECT_THAT(*read_form("a&b="), ElementsAre(Pair("a", ""), Pair("b", "")));
  EXPECT_THAT(*read_form("a=b=c"), ElementsAre(Pair("a", "b=c")));
  EXPECT_EQ((*read_form("a=%00"))["a"], std::string(1, '\0'));
}

TEST(WebForm, WhatIsNone) {
  for (const char* body : {"a=%", "a=%2", "a=%zz", "a=%-1", "a=%+1", "%2", "a=1&a=2", "a=1&%61=2",
                           "1=&2=&3=&4=&5=&6=&7=&8=&9="}) {
    EXPECT_FALSE(read_form(body)) << body;
  }
  EXPECT_TRUE(read_form("1=&2=&3=&4=&5=&6=&7=&8="));
}

TEST(WebForm, ACookieByItsName) {
  EXPECT_EQ(cookie_of("canopus_80=abc", "canopus_80"), "abc");
  EXPECT_EQ(cookie_of("a=1; canopus_80=abc;b=2", "canopus_80"), "abc");
  EXPECT_EQ(cookie_of("a=1;canopus_80=a=c ; b", "canopus_80"), "a=c");
  for (const char* field :
       {"", "canopus_80", "canopus_8=abc", "Canopus_80=abc", "xcanopus_80=abc", "a=canopus_80=abc"}) {
    EXPECT_FALSE(cookie_of(field, "canopus_80")) << field;
  }
  EXPECT_FALSE(cookie_of("canopus_80=abc; canopus_80=def", "canopus_80")) << "who set the second one?";
}

/// What a form says comes out of it as it went in, by another's way of writing it: every byte as %XX.
RC_GTEST_PROP(WebForm, AnyBytes, (const std::string& name, const std::string& value)) {
  const auto hexadecimal = [](const std::string& text) {
    std::string result;
    for (const char letter : text) {
      constexpr const char* digits = "0123456789ABCDEF";
      result += {'%', digits[static_cast<unsigned char>(letter) >> 4],
                 digits[static_cast<unsigned char>(letter) & 15]};
    }
    return result;
  };
  const auto form = read_form(hexadecimal(name) + '=' + hexadecimal(value));
  RC_ASSERT(form.has_value());
  RC_ASSERT(form->size() == 1U);
  RC_ASSERT(form->begin()->first == name);
  RC_ASSERT(form->begin()->second == value);
}

}  // namespace
}  // namespace canopus::web::form_test
