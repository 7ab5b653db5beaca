#include "canopus/instruction_list/program_csv.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "canopus/ascii/words.hpp"
#include "canopus/text/csv.hpp"

namespace canopus::instruction_list {

namespace {

constexpr std::size_t most_rows = 200'000;
constexpr std::size_t most_operands = 16;

/// The titles of the columns that matter, in capitals and without blanks. German ones are unverified: a file with titles that are not
/// known has its columns in the usual order.
constexpr std::array statement_titles = {"LINESTATEMENT", "行間ステートメント", "ZEILENKOMMENTAR"};
constexpr std::array instruction_titles = {"INSTRUCTION", "命令", "ANWEISUNG", "BEFEHL"};
constexpr std::array device_titles = {"I/O(DEVICE)", "I/Oデバイス", "I/O(デバイス)", "I/O(デバイス)",
                                      "E/A(OPERAND)"};
constexpr std::array pointer_titles = {"PISTATEMENT", "P/ISTATEMENT", "PIステートメント", "P/Iステートメント",
                                       "P/I-KOMMENTAR"};
constexpr std::array note_titles = {"NOTE", "ノート", "NOTIZ"};

struct Columns {
  std::size_t statement = 1, instruction = 2, device = 3, pointer_statement = 5, note = 6;
};

template <std::size_t Count>
void find_column(const std::vector<std::string>& titles, const std::array<const char*, Count>& wanted,
                 std::size_t& column) {
  for (std::size_t i = 0; i < titles.size(); ++i) {
    std::string title = ascii::upper(titles[i]);
    std::erase(title, ' ');
    if (std::ranges::find(wanted, title) != wanted.end()) {
      column = i;
      return;
    }
  }
}

bool is_step_number(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, ascii::is_digit);
}

bool is_pointer(std::string_view text) {
  return text.size() > 1 && (text.front() == 'P' || text.front() == 'I') && is_step_number(text.substr(1));
}

class Reader {
 public:
  Reader(const std::string& file, std::vector<CompileError>& errors) : file_(file), errors_(errors) {}

  ProgramText read(std::string_view text) {
    text::CsvReader fields(text);
    const std::size_t errors_before = errors_.size();
    std::size_t rows = 0;
    while (!fields.is_at_end()) {
      if (++rows > most_rows) {
        error(fields.line(), "expected at most " + std::to_string(most_rows) + " rows");
        break;
      }
      const std::uint32_t line = fields.line();
      std::string wrong;
      const std::vector<std::string> row = fields.row(wrong);
      if (!wrong.empty()) {
        error(line, std::move(wrong));
      } else if (std::ranges::any_of(row, [](const std::string& field) { return !field.empty(); })) {
        add(line, row);
      }
    }
    if (!has_begun_ && errors_.size() == errors_before)
      error(1, "expected rows with step number, statement, instruction and device, as GX Works writes them");
    return std::move(made_);
  }

 private:
  void error(std::uint32_t line, std::string message) {
    errors_.push_back({file_, line, std::move(message)});
  }

  void add(std::uint32_t line, const std::vector<std::string>& row) {
    if (!has_begun_ && row.size() < 3) return begin(row);
    if (!std::exchange(has_begun_, true) && !is_step_number(row[0])) return titles(row);
    const auto field = [&](std::size_t column) {
      return column < row.size() ? std::string(ascii::trim(row[column])) : std::string();
    };
    const std::string name = ascii::upper(field(columns_.instruction));
    const std::string device = field(columns_.device);
    for (const std::size_t column : {columns_.statement, columns_.pointer_statement})
      if (std::string text = field(column); !text.empty())
        made_.statements.push_back({line, made_.instructions.size(), std::move(text)});
    if (!name.empty() || (is_step_number(row[0]) && is_pointer(device))) {
      made_.instructions.push_back({line, name.empty() ? device : name, {}, field(columns_.note)});
      if (!name.empty() && !device.empty()) made_.instructions.back().operands.push_back(device);
    } else if (!device.empty()) {
      further_operand(line, device);
    } else if (std::string note = field(columns_.note); !note.empty() && !made_.instructions.empty()) {
      made_.instructions.back().note += note;
    }
  }

  /// The rows above the titles: the program's name, and the CPU.
  void begin(const std::vector<std::string>& row) {
    if (row.size() == 1 && made_.title.empty()) made_.title = row[0];
    if (row.size() == 2) made_.cpu = row[1];
  }

  void titles(const std::vector<std::string>& row) {
    find_column(row, statement_titles, columns_.statement);
    find_column(row, instruction_titles, columns_.instruction);
    find_column(row, device_titles, columns_.device);
    find_column(row, pointer_titles, columns_.pointer_statement);
    find_column(row, note_titles, columns_.note);
  }

  void further_operand(std::uint32_t line, const std::string& device) {
    if (made_.instructions.empty())
      return error(line, "'" + device + "' belongs to no instruction; expected an instruction above it");
    std::vector<std::string>& operands = made_.instructions.back().operands;
    if (operands.size() < most_operands) return operands.push_back(device);
    error(line, "expected at most " + std::to_string(most_operands) + " operands");
  }

  const std::string& file_;
  std::vector<CompileError>& errors_;
  ProgramText made_;
  Columns columns_;
  bool has_begun_ = false;
};

}  // namespace

ProgramText read_program_csv(const std::string& file, std::string_view bytes,
                             std::vector<CompileError>& errors) {
  const auto text = text::utf8_of(bytes);
  if (!text) {
    errors.push_back({file, 1, text.error()});
    return {};
  }
  if (text->contains('\0')) {
    errors.push_back(
        {file, 1, "there is a zero byte; expected UTF-16 with a byte order mark, UTF-8 or CP932"});
    return {};
  }
  return Reader(file, errors).read(*text);
}

}  // namespace canopus::instruction_list
