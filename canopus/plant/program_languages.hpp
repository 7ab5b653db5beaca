#pragma once
// The programs of a PLC in whatever language their files are: Structured Text, or instruction lists as CSV.

#include <span>

#include "canopus/instruction_list/label.hpp"
#include "canopus/plc/cpu/device.hpp"
#include "canopus/structured_text/compiler.hpp"

namespace canopus::plant {

/// One program of all files; a file .csv is an instruction list, with these labels. PROGRAMs are executed in the order of the files.
[[nodiscard]] structured_text::Compilation compile_languages(
    std::span<const structured_text::Source> sources, const plc::CpuModel& cpu,
    const program::DeviceNames& devices, std::span<const instruction_list::Label> labels = {});

}  // namespace canopus::plant
