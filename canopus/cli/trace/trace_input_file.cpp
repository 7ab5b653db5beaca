#include "canopus/cli/trace/trace_input_file.hpp"

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/hex.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/trace/print/trace_walk.hpp"

namespace canopus::cli {

void add_format_option(Command& command, const std::string& option, std::string& name,
                       const std::string& help, bool read) {
  std::vector<std::string_view> known;
  for (const auto& entry : trace::format_names) {
    if (read || entry.is_written) known.push_back(entry.name);
  }
  command.add_option(option, name, help)->type_name("FORMAT")->check(one_of_words(std::move(known)));
}

std::optional<TraceInputFile> TraceInputFile::open(const std::string& path, const std::string& format,
                                                   Output& err, std::function<bool()> goes_on) {
  auto reader =
      trace::open_trace(path, trace::format_of_name(format), trace::wait_in_words(err, std::move(goes_on)));
  if (!reader) {
    err.line("canopus: {}", reader.error());
    return std::nullopt;
  }
  return TraceInputFile(std::move(*reader), path, err);
}

std::optional<trace::TraceRecord> TraceInputFile::next() {
  constexpr std::uint64_t most_printed = 10;
  while (true) {
    const auto record = reader_->next();
    if (record) {
      if (*record) ++records_;
      return *record;
    }
    if (++mistakes_ <= most_printed) err_->line("canopus: {}", record.error());
    if (mistakes_ == most_printed + 1) err_->line("canopus: {}: there are more mistakes", path_);
  }
}

bool TraceInputFile::finish() {
  if (mistakes_ > 0)
    err_->line("canopus: {}: {} could not be read", path_, ascii::counted(mistakes_, "record"));
  return trace::report_left_out(path_, *reader_, records_, mistakes_, *err_);
}

std::string seconds_text(can::Duration time) {
  const bool negative = time.count() < 0;
  const auto size =
      negative ? 0 - static_cast<std::uint64_t>(time.count()) : static_cast<std::uint64_t>(time.count());
  return fmt::format("{}{}.{:09}", negative ? "-" : "", size / 1'000'000'000, size % 1'000'000'000);
}

std::string frame_text(std::string_view channel, const trace::TraceRecord& record) {
  const can::Frame& frame = record.frame;
  const bool wide = frame.extended && !record.error_frame;
  std::string text = fmt::format("{}  {:0{}X}   [{}]", channel, frame.identifier, wide ? 8 : 3, frame.dlc);
  if (record.error_frame) text += "  error frame";
  if (frame.remote) text += "  remote request";
  if (!frame.bytes().empty()) text += ' ' + ascii::hex_bytes(frame.bytes(), " ");
  return text;
}

}  // namespace canopus::cli
