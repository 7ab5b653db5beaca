#include "canopus/text/csv.hpp"

#include <utility>

#include <iconv.h>

#include "canopus/ascii/words.hpp"

namespace canopus::text {

namespace {

constexpr std::size_t most_fields = 64;

bool is_utf8(std::string_view text) {
  std::size_t following = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (following > 0) {
      if ((byte & 0xC0U) != 0x80U) return false;
      --following;
    } else if (byte >= 0xF0U) {
      if (byte > 0xF4U) return false;
      following = 3;
    } else if (byte >= 0xE0U) {
      following = 2;
    } else if (byte >= 0xC2U) {
      following = 1;
    } else if (byte >= 0x80U) {
      return false;
    }
  }
  return following == 0;
}

std::expected<std::string, std::string> converted(std::string_view bytes, const char* encoding) {
  const iconv_t converter = iconv_open("UTF-8", encoding);
  if (converter == iconv_t(-1))  // NOLINT: the macro of POSIX
    return std::unexpected("this system cannot read " + std::string(encoding) + "; expected UTF-8 or UTF-16");
  std::string input(bytes);
  std::string result(bytes.size() * 3 + 4, '\0');
  char* from = input.data();
  std::size_t from_size = input.size();
  char* to = result.data();
  std::size_t to_size = result.size();
  const bool is_done = iconv(converter, &from, &from_size, &to, &to_size) != static_cast<std::size_t>(-1);
  iconv_close(converter);
  if (!is_done)
    return std::unexpected("byte " + std::to_string(bytes.size() - from_size + 1) + " is no text in " +
                           encoding + "; expected UTF-16 with a byte order mark, UTF-8 or CP932");
  result.resize(result.size() - to_size);
  return result;
}

}  // namespace

std::expected<std::string, std::string> utf8_of(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE")) return converted(bytes.substr(2), "UTF-16LE");
  if (bytes.starts_with("\xFE\xFF")) return converted(bytes.substr(2), "UTF-16BE");
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  if (is_utf8(bytes)) return std::string(bytes);
  return converted(bytes, "CP932");
}

CsvReader::CsvReader(std::string_view text) : text_(text) {
  bool is_quoted = false;
  unsigned lines = 0;
  for (const char c : text) {
    if (c == '"') is_quoted = !is_quoted;
    if (is_quoted) continue;
    if (c == '\t' || c == ';') separator_ = c;
    if (c == '\t' || c == ',' || c == ';' || (c == '\n' && ++lines > 10)) break;
  }
}

std::vector<std::string> CsvReader::row(std::string& error) {
  std::vector<std::string> fields;
  std::string field;
  const std::uint32_t first = line_;
  bool is_quoted = false;
  bool is_closed = false;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (is_quoted) {
      if (c == '\n') ++line_;
      if (c != '"') {
        field += c;
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
        field += c;
        ++at_;
      } else {
        is_quoted = false;
        is_closed = true;
      }
    } else if (c == separator_) {
      fields.push_back(std::exchange(field, {}));
      is_closed = false;
    } else if (c == '\n' || (c == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n')) {
      ++at_;  // LF, CR LF, or CR alone
      ++line_;
      break;
    } else if (c == '"' && field.empty() && !is_closed) {
      is_quoted = true;
    } else if (c != '\r') {
      if (is_closed && !ascii::is_blank(c) && error.empty())
        error = "expected a separator behind the closing quote";
      field += c;
    }
  }
  if (is_quoted) error = "the quote that is opened in line " + std::to_string(first) + " is not closed";
  fields.push_back(std::move(field));
  if (fields.size() > most_fields)
    error = "expected at most " + std::to_string(most_fields) + " fields in a row";
  return fields;
}

}  // namespace canopus::text
