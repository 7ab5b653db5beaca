#include "canopus/module/memory/diagnostics.hpp"

#include <algorithm>
#include <utility>

#include "canopus/module/interface/observer.hpp"

namespace canopus::module {

Diagnostics::Diagnostics(const DiagnosticsTables& tables) : tables_(tables) {
  for (const EventRow& row : tables.events) event_.at(std::to_underlying(row.event)) = &row;
  for (const DiagnosisRow& row : tables.errors) error_.at(std::to_underlying(row.diagnosis)) = &row;
}

void Diagnostics::log(ModuleEvent event, can::Time now, std::optional<std::uint32_t> detail) {
  const EventRow* row = event_[std::to_underlying(event)];
  if (row == nullptr) return;
  if (history_.size() == most_events) history_.pop_front();
  history_.push_back({.at = now, .code = row->code, .overview = row->overview, .detail = detail});
  if (observer_ != nullptr) observer_->event_logged(history_.back());
}

void Diagnostics::raise(Diagnosis diagnosis, can::Time now, std::initializer_list<std::uint32_t> details) {
  const DiagnosisRow* row = error_[std::to_underlying(diagnosis)];
  if (row == nullptr || (hold_clear_ && row->error_class != ErrorClass::major)) return;
  if (std::ranges::find(errors_, row->code, &ModuleErrorRecord::code) != errors_.end()) return;
  ModuleErrorRecord record{
      .at = now, .code = row->code, .error_class = row->error_class, .overview = row->overview};
  auto detail = record.details.begin();
  auto detail_name = row->details.begin();
  for (const std::uint32_t value : details) {
    if (detail == record.details.end()) break;
    *detail++ = {*detail_name++, value};
  }
  errors_.push_back(record);
  if (observer_ != nullptr) observer_->module_error(record);
}

void Diagnostics::remove(Diagnosis diagnosis) {
  const DiagnosisRow* row = error_[std::to_underlying(diagnosis)];
  if (row != nullptr) std::erase_if(errors_, [row](const auto& record) { return record.code == row->code; });
}

void Diagnostics::hold_clear(bool held) {
  hold_clear_ = held;
  if (held) {
    std::erase_if(errors_, [](const auto& record) { return record.error_class != ErrorClass::major; });
  }
}

bool Diagnostics::clear_minor() {
  if (worst().value_or(ErrorClass::minor) != ErrorClass::minor) return false;
  errors_.clear();
  return true;
}

std::optional<ErrorClass> Diagnostics::worst() const noexcept {
  std::optional<ErrorClass> worst;
  for (const ModuleErrorRecord& record : errors_) {
    if (!worst || record.error_class > *worst) worst = record.error_class;
  }
  return worst;
}

}  // namespace canopus::module
