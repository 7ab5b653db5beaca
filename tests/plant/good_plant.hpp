#pragma once
// A plant file that has some of everything, and the errors of any other text.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

inline constexpr std::string_view good_plant = R"([plant]
name = "press line"
seed = 7

[[bus]]
name = "line1"
bit_rate = 250_000
serve = "socketcand:127.0.0.1:29536"

[[device]]
node = 3
name = "encoder"
eds = "encoder.eds"
start = "1.5s"
objects = { "1017:00" = 500, "2000:0A" = "text" }

[[device.behaviour]]
object = "6004:00"
kind = "ramp"
low = -10
high = 4095.5
period = "4s"

[[plc]]
name = "plc1"
listen = ":5008"
cpu = "stop"
store = "state"

[[plc.module]]
model = "ME3CAN1-Q"
head = 0x30
node = 1
master = true
exchange = "20ms"
restart_time = "100ms"
buffer = { G70 = 1000 }
objects = { "1F89:00" = 10000 }
watch = ["G25", "G10000"]

[[plc.module.slave]]
node = 3
mandatory = false
receive = [1, { pdo = 2, at = "G10020" }]
send = 1
)";

inline std::vector<std::string> errors_of(std::string_view text) {
  std::vector<std::string> lines;
  for (const text::FileError& error : read_plant(text, "plant.toml").errors)
    lines.push_back(describe(error, "plant.toml"));
  return lines;
}

}  // namespace canopus::plant
