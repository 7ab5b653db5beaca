#pragma once
// How MELSEC's intelligent function modules for CAN behave as CANopen nodes and NMT masters, where CiA leaves a choice or
// both manuals differ from it [ME3CAN1-Q 4; RJ71CN91 1, App. 3].

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/service/node_options.hpp"
#include "canopus/manager/boot/master_options.hpp"
#include "canopus/manager/configuration/configuration_manager.hpp"
#include "canopus/module/canopen/object_rows.hpp"
#include "canopus/module/q_iqr/words.hpp"

namespace canopus::module::q_iqr {

[[nodiscard]] canopen::NodeOptions node_options();
/// No software check, no restore [ME3CAN1-Q Tab. 4-30; RJ71CN91 App. 3 1F81H]; the manuals have no SDO block transfer.
[[nodiscard]] manager::MasterOptions master_options();
/// [ME3CAN1-Q 4.8.12; RJ71CN91 App. 3 1F22H]
[[nodiscard]] manager::ConfigurationOptions configuration_options();
/// 1F90:06 = 4000 + 10 x node-ID ms [ME3CAN1-Q 4.8.10; RJ71CN91 App. 3 1F90H].
void set_detect_cycle(canopen::ObjectDictionary& objects, std::uint8_t node_id);

/// Differences of the models' dictionaries.
struct Identity {
  std::string_view device_name{};       ///< 1008H
  std::string_view hardware_version{};  ///< 1009H
  std::string_view software_version{};  ///< 100AH
  std::uint32_t vendor = 0;             ///< 1018:01
  std::uint32_t product = 0;            ///< 1018:02
  std::uint32_t revision = 0;           ///< 1018:03
};
/// PDOs and network variables of a dictionary.
struct DictionaryShape {
  DataExchangeLayout exchange = exchange_layout;
  bool rpdo_timers = false;  ///< RPDOs have an inhibit time and an event timer
  /// PDOs 1 to 4 are those of the pre-defined connection set; else they are not valid.
  bool predefined_pdos = true;
  /// Added last: other defaults of what is there, and more.
  std::span<const ObjectRow> more{};
};
/// The object dictionary in CANopen 405 mode [ME3CAN1-Q Tab. 4-6 to 4-10, 4.9; RJ71CN91 App. 3; FX3U-CAN 5.6].
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> make_dictionary(
    const Identity& identity, const DictionaryShape& shape = {});

}  // namespace canopus::module::q_iqr
