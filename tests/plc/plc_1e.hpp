#pragma once
// A PLC that takes 1E frames.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "plc/conversation.hpp"

namespace canopus::plc {

using testing::bytes;
using testing::Plc;
using testing::shown;

inline melsec::PortSettings port_1e(WritePermission write = WritePermission::always) {
  return {.takes_3e = false, .takes_1e = true, .write = write};
}

struct Plc1e : Plc {
  explicit Plc1e(const CpuModel& model = r04cpu(), melsec::PortSettings settings = port_1e())
      : Plc(model, std::move(settings)) {}
};

/// One request, binary, to a CPU of its own.
inline std::string request(const std::string& request) { return Plc1e{}.request(request); }
inline std::string request_ascii(const std::string& request) { return Plc1e{}.raw(request); }

}  // namespace canopus::plc
