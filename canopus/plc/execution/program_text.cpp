#include "canopus/plc/execution/program_text.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "canopus/ascii/words.hpp"

namespace canopus::plc {

namespace {

using program::DataType;

constexpr std::size_t most_blocks = 64;

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_name(char c) { return is_letter(c) || is_digit(c); }

/// The paths of all variables that are instances of a function block.
void add_instances(const DataType& type, std::string& path, std::string_view block,
                   std::vector<std::string>& found) {
  if (found.size() == most_blocks) return;
  const std::size_t length = path.size();
  if (type.form == DataType::Form::array && type.element->form >= DataType::Form::array) {
    for (std::int64_t index = type.low; index <= type.high && found.size() < most_blocks; ++index) {
      path += '[' + std::to_string(index) + ']';
      add_instances(*type.element, path, block, found);
      path.resize(length);
    }
  }
  if (type.form != DataType::Form::block && type.form != DataType::Form::structure) return;
  if (type.form == DataType::Form::block && ascii::equal_ignoring_case(type.name, block))
    found.push_back(path);
  for (const program::Member& member : type.members) {
    if (member.kind == program::MemberKind::in_out || member.kind == program::MemberKind::hidden) continue;
    path += '.' + member.name;
    add_instances(*member.type, path, block, found);
    path.resize(length);
  }
}

std::vector<std::string> instances_of(const program::Program& program, std::string_view block) {
  std::vector<std::string> found;
  for (const program::Symbol& symbol : program.symbols) {
    std::string path = symbol.name;
    add_instances(*symbol.type, path, block, found);
  }
  return found;
}

/// Reads a source from its begin, as far as comments and units go, and collects the names of the wanted lines.
class Reader {
 public:
  Reader(const ProgramExecution& execution, const CpuModel& model, std::string_view text, bool is_list,
         std::uint32_t from, std::uint32_t count, std::string_view wanted, SourceView& view)
      : execution_(execution),
        machine_(execution.machine()),
        devices_(model),
        text_(text),
        is_list_(is_list),
        from_(from),
        end_(from + count),
        wanted_(wanted),
        view_(view) {}

  void read() {
    begin_line();
    while (at_ < text_.size()) step();
    end_line();
    view_.lines = line_;
  }

 private:
  [[nodiscard]] bool is_shown() const { return line_ >= from_ && line_ < end_; }
  [[nodiscard]] bool starts(std::string_view mark) const { return text_.substr(at_).starts_with(mark); }

  void begin_line() {
    line_start_ = at_;
    if (is_shown()) view_.shown.emplace_back();
  }
  void end_line() {
    if (!is_shown()) return;
    std::string_view line = text_.substr(line_start_, at_ - line_start_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    view_.shown.back().text = line;
  }
  /// One character on, over the end of a line, too.
  void advance() {
    if (text_[at_] != '\n') {
      ++at_;
      return;
    }
    end_line();
    ++at_;
    ++line_;
    begin_line();
  }
  void skip(std::size_t count) {
    for (; count != 0 && at_ < text_.size(); --count) advance();
  }
  void skip_comment(std::string_view open, std::string_view close) {
    unsigned depth = 0;
    while (at_ < text_.size()) {
      if (starts(open)) {
        ++depth;
        skip(open.size());
      } else if (starts(close)) {
        skip(close.size());
        if (--depth == 0) return;
      } else {
        advance();
      }
    }
  }
  void skip_text(char quote) {
    advance();
    while (at_ < text_.size() && text_[at_] != quote && text_[at_] != '\n') skip(text_[at_] == '$' ? 2 : 1);
    if (at_ < text_.size()) advance();
  }

  void step() {
    const char c = text_[at_];
    if (!is_list_) {
      if (starts("(*")) return skip_comment("(*", "*)");
      if (starts("/*")) return skip_comment("/*", "*/");
      if (starts("//")) {
        while (at_ < text_.size() && text_[at_] != '\n') advance();
        return;
      }
      if (c == '\'' || c == '"') return skip_text(c);
      if (c == '(') ++depth_;
      if (c == ')' && depth_ != 0) --depth_;
    }
    if (is_digit(c)) {  // 16#FF, T#1s: no names
      while (at_ < text_.size() && (is_name(text_[at_]) || text_[at_] == '#')) advance();
      return;
    }
    if (is_letter(c)) return name();
    advance();
  }

  [[nodiscard]] std::size_t end_of_word(std::size_t at) const {
    while (at < text_.size() && is_name(text_[at])) ++at;
    return at;
  }
  /// Behind a name with its members and indices of constants: a.b[3].c
  [[nodiscard]] std::size_t end_of_path(std::size_t at) const {
    at = end_of_word(at);
    while (at < text_.size()) {
      if (text_[at] == '.' && at + 1 < text_.size() && is_letter(text_[at + 1])) {
        at = end_of_word(at + 1);
      } else if (text_[at] == '[') {
        std::size_t close = at + 1;
        while (close < text_.size() &&
               (is_digit(text_[close]) || text_[close] == ',' || text_[close] == ' ' || text_[close] == '-'))
          ++close;
        if (close >= text_.size() || text_[close] != ']') return at;
        at = close + 1;
      } else {
        return at;
      }
    }
    return at;
  }

  void name() {
    const std::size_t start = at_;
    const std::string_view word = text_.substr(start, end_of_word(start) - start);
    if (!is_list_ && is_unit_word(word)) return skip(word.size());
    const bool is_typed = start + word.size() < text_.size() && text_[start + word.size()] == '#';
    if (is_typed) {  // T#1s, COLOUR#red
      skip(word.size() + 1);
      while (at_ < text_.size() && (is_name(text_[at_]) || text_[at_] == '.')) advance();
      return;
    }
    const std::string_view path = text_.substr(start, end_of_path(start) - start);
    if (is_shown() && !is_argument_name(start + path.size())) {
      if (!add_variable(path)) add_device(start, word);
    }
    skip(std::max(path.size(), device_length_));
    device_length_ = 0;
  }

  /// PROGRAM, FUNCTION_BLOCK and their ends; the name behind the first ones.
  bool is_unit_word(std::string_view word) {
    const std::string upper = ascii::upper(word);
    if (unit_is_next_) {
      unit_is_next_ = false;
      base_ = std::string(word);
      is_chosen_ = !is_block_;
      return true;
    }
    const bool is_block = upper == "FUNCTION_BLOCK";
    if (is_block || upper == "PROGRAM" || upper == "FUNCTION") {
      unit_is_next_ = upper != "FUNCTION";
      is_block_ = is_block;
      leave_unit();
      return true;
    }
    if (upper == "END_PROGRAM" || upper == "END_FUNCTION_BLOCK" || upper == "END_FUNCTION") leave_unit();
    return upper.starts_with("END_");
  }

  void leave_unit() {
    base_.clear();
    is_chosen_ = true;
  }

  /// Of the block that is read, once a shown line has a name in it: all variables are searched.
  void choose_instance() {
    is_chosen_ = true;
    std::vector<std::string> all = instances_of(machine_.program(), base_);
    const auto found = std::ranges::find(all, wanted_);
    base_ = found != all.end() ? *found : all.empty() ? "" : all.front();
    block_ = base_;
    blocks_ = std::move(all);
  }

  /// t(IN := x): the name of an argument is none of a variable.
  [[nodiscard]] bool is_argument_name(std::size_t behind) const {
    if (depth_ == 0) return false;
    while (behind < text_.size() && text_[behind] == ' ') ++behind;
    const std::string_view next = text_.substr(behind, 2);
    return next == ":=" || next == "=>";
  }

  bool add_variable(std::string_view path) {
    if (!is_chosen_) choose_instance();
    for (const std::string& name :
         {base_.empty() ? std::string() : base_ + '.' + std::string(path), std::string(path)}) {
      if (name.empty()) continue;
      const auto variable = machine_.find(name);
      if (!variable) continue;
      if (variable->type->form >= DataType::Form::array) return true;  // a structure, or an instance
      if (is_block_ && !block_.empty() && name.starts_with(block_)) show_blocks();
      add(path.size(), name, false);
      return true;
    }
    return false;
  }

  void show_blocks() {
    if (view_.block == block_) return;
    view_.block = block_;
    view_.blocks = blocks_;
  }

  /// D100, X1F, U0\G25.
  void add_device(std::size_t start, std::string_view word) {
    if (const DeviceLabel* const label = execution_.label(word);
        label != nullptr && devices_.point(label->device))
      return add(word.size(), label->device, true);
    std::size_t end = start + word.size();
    if (end + 1 < text_.size() && text_[end] == '\\' && is_letter(text_[end + 1])) end = end_of_word(end + 1);
    const std::string upper = ascii::upper(text_.substr(start, end - start));
    const bool is_buffer = end != start + word.size();
    if ((!is_buffer && !devices_.looks_like_device(upper)) || !devices_.point(upper)) return;
    add(end - start, upper, true);
    device_length_ = end - start;
  }

  void add(std::size_t length, std::string name, bool is_device) {
    view_.shown.back().values.push_back({static_cast<std::uint32_t>(at_ - line_start_ + 1),
                                         static_cast<std::uint32_t>(length), std::move(name), is_device});
  }

  const ProgramExecution& execution_;
  const program::Machine& machine_;
  CpuDeviceNames devices_;
  std::string_view text_;
  bool is_list_;
  std::uint32_t from_;
  std::uint32_t end_;
  std::string_view wanted_;
  SourceView& view_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  std::uint32_t line_ = 1;
  unsigned depth_ = 0;  // of ( )
  bool unit_is_next_ = false;
  bool is_block_ = false;
  bool is_chosen_ = true;  // the instance of the block
  std::string base_;       // what stands before a variable of the unit: "Main", "Main.motor1"
  std::string block_;
  std::vector<std::string> blocks_;
  std::size_t device_length_ = 0;
};

void mark_code(const program::Program& program, std::size_t file, std::uint32_t from, SourceView& view) {
  for (const program::SourcePosition& position : program.positions) {
    if (position.file != file || position.line < from || position.line - from >= view.shown.size()) continue;
    view.shown[position.line - from].has_code = position.line != 0;
  }
}

}  // namespace

SourceView source_view(const ProgramExecution& execution, const CpuModel& model, std::size_t source,
                       std::uint32_t from, std::uint32_t count, std::string_view block) {
  SourceView view;
  if (source >= execution.sources().size()) return view;
  const ProgramSource& file = execution.sources()[source];
  from = std::max<std::uint32_t>(from, 1);
  Reader(execution, model, file.text, ascii::lower(file.name).ends_with(".csv"), from, count, block, view)
      .read();
  const auto& files = execution.machine().program().files;
  const auto number = static_cast<std::size_t>(std::ranges::find(files, file.name) - files.begin());
  mark_code(execution.machine().program(), number, from, view);
  return view;
}

}  // namespace canopus::plc
