// A request in steady state allocates nothing: the program's operator new counts.

#include <cstdlib>
#include <new>
#include <string>

#include <gtest/gtest.h>

#include "plc/conversation.hpp"

namespace {
std::size_t allocations = 0;
}  // namespace

// GCC, once it has inlined these, takes free() for the wrong partner of operator new.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

// Replaced for the whole test program; aligned and array forms come here or are not used by what is measured.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  ++allocations;
  return std::malloc(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

namespace canopus::plc::melsec_allocation_test {
namespace {

TEST(MelsecSession, Requests_AllocateNothing) {
  testing::Plc plc;
  const std::string requests = testing::bytes(
      "54 00 01 00 00 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 40 00"                // D100 x 64
      "50 00 00 ff ff 03 00 13 00 10 00 01 04 80 00 | 00 00 19 00 00 ab 00 00 00 00 f8 | 40 00"   // U0\G25
      "50 00 00 ff ff 03 00 0e 00 10 00 01 14 01 00 40 00 00 9d 03 00 10 10"                      // Y40
      "50 00 00 ff ff 03 00 14 00 10 00 03 04 00 00 | 02 01 64 00 00 a8 00 00 00 90 0a 00 00 b4"  // random
      "50 00 00 ff ff 03 00 06 00 10 00 99 99 00 00");                                            // refused
  const std::size_t before = allocations;
  std::size_t answered = 0;
  for (int round = 0; round < 100; ++round) {
    std::copy(requests.begin(), requests.end(), plc.session->space().begin());
    plc.session->received(requests.size());
    answered += plc.session->process(plc.now);
    plc.session->sent(plc.session->output().size());
  }
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(answered, 500U);
}

}  // namespace
}  // namespace canopus::plc::melsec_allocation_test
