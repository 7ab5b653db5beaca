#include "canopus/structured_text/token.hpp"

#include <algorithm>
#include <array>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::structured_text {

namespace {

using Kind = Token::Kind;

bool begins_name(char c) { return ascii::is_letter(c) || c == '_' || static_cast<unsigned char>(c) >= 0x80; }
bool is_in_name(char c) { return begins_name(c) || ascii::is_digit(c); }

constexpr std::array<std::string_view, 28> symbols = {
    ":=", "=>", "**", "<=", ">=", "<>", "..", "?=", "+", "-", "*", "/", "=", "<",
    ">",  "(",  ")",  "[",  "]",  ",",  ";",  ":",  ".", "&", "^", "@", "{", "}"};

constexpr std::size_t most_mistakes = 100;

class Lexer {
 public:
  Lexer(std::string_view source, std::string_view capitals, std::uint16_t file,
        std::vector<SourceError>& errors)
      : source_(source), capitals_(capitals), file_(file), errors_(errors) {}

  std::vector<Token> run() {
    std::vector<Token> tokens;
    while (true) {
      const std::size_t before = at_;
      skip_blanks();
      Token token = next();
      token.follows_blank = tokens.empty() || at_start_ != before;
      const bool is_end = token.kind == Kind::end;
      tokens.push_back(token);
      if (is_end) return tokens;
    }
  }

 private:
  [[nodiscard]] char peek(std::size_t distance = 0) const {
    return at_ + distance < source_.size() ? source_[at_ + distance] : '\0';
  }
  [[nodiscard]] bool is_at(std::string_view text) const { return source_.substr(at_).starts_with(text); }
  void advance(std::size_t count = 1) {
    for (; count > 0 && at_ < source_.size(); --count, ++at_) {
      // A line ends with LF, CR LF, or CR alone.
      if (source_[at_] == '\n' || (source_[at_] == '\r' && peek(1) != '\n')) {
        ++line_;
        line_start_ = at_ + 1;
      }
    }
  }
  [[nodiscard]] SourcePosition position() const {
    return {file_, static_cast<std::uint16_t>(std::min<std::size_t>(at_ - line_start_ + 1, 65'535)), line_};
  }
  void error(SourcePosition at, std::string message) {
    if (errors_.size() < most_mistakes) errors_.push_back({at, std::move(message)});
  }

  void skip_blanks() {
    while (at_ < source_.size()) {
      const SourcePosition start = position();
      if (ascii::is_blank(peek()) || peek() == '\n' || peek() == '\r' || peek() == '\f' ||
          is_at("\xEF\xBB\xBF")) {
        advance(is_at("\xEF\xBB\xBF") ? 3 : 1);
      } else if (is_at("//")) {
        while (at_ < source_.size() && peek() != '\n' && peek() != '\r') advance();
      } else if (is_at("(*")) {
        skip_comment("(*", "*)", start);
      } else if (is_at("/*")) {
        skip_comment("/*", "*/", start);
      } else if (peek() == '{') {
        skip_comment("{", "}", start);  // a pragma
      } else {
        return;
      }
    }
  }
  /// Comments nest [IEC 61131-3 6.1.5].
  void skip_comment(std::string_view open, std::string_view close, SourcePosition start) {
    unsigned depth = 0;
    do {
      if (at_ >= source_.size()) {
        return error(start, "the comment does not end; expected " + std::string(close));
      }
      if (is_at(close)) {
        --depth;
        advance(close.size());
      } else if (is_at(open)) {
        ++depth;
        advance(open.size());
      } else {
        advance();
      }
    } while (depth > 0);
  }

  Token token(Kind kind, std::size_t start, SourcePosition at) {
    return {.kind = kind,
            .at = at,
            .text = capitals_.substr(start, at_ - start),
            .written = source_.substr(start, at_ - start)};
  }

  Token next() {
    at_start_ = at_;
    const std::size_t start = at_;
    const SourcePosition at = position();
    const char c = peek();
    if (at_ >= source_.size()) return token(Kind::end, start, at);
    if (begins_name(c)) return name(start, at);
    if (ascii::is_digit(c)) return number(start, at);
    if (c == '%' && ascii::is_letter(peek(1))) {
      advance(2);
      while (ascii::is_letter(peek()) || ascii::is_digit(peek()) ||
             (peek() == '.' && ascii::is_digit(peek(1))))
        advance();
      return token(Kind::name, start, at);
    }
    if (c == '\'' || c == '"') return string(start, at);
    for (const std::string_view symbol : symbols) {
      if (!is_at(symbol)) continue;
      advance(symbol.size());
      return token(Kind::symbol, start, at);
    }
    advance();
    while (at_ < source_.size() && (static_cast<unsigned char>(peek()) & 0xC0U) == 0x80U) advance();
    error(at, static_cast<unsigned char>(c) < 0x20
                  ? "unexpected control character"
                  : "unexpected character " + std::string(source_.substr(start, at_ - start)));
    return token(Kind::wrong, start, at);
  }

  Token name(std::size_t start, SourcePosition at) {
    while (is_in_name(peek())) advance();
    if (peek() == '\\' && capitals_[start] == 'U' && ascii::is_letter(peek(1))) {  // U0\G25
      advance();
      while (is_in_name(peek())) advance();
    }
    if (peek() == '#') return typed_literal(start, at);
    return token(Kind::name, start, at);
  }

  Token typed_literal(std::size_t start, SourcePosition at) {
    const std::string_view prefix = capitals_.substr(start, at_ - start);
    advance();
    if (peek() == '\'' || peek() == '"') {
      Token found = string(at_, at);
      found.prefix = prefix;
      return found;
    }
    const auto type = program::elementary_named(prefix);
    const bool is_date =
        prefix == "D" || prefix == "LD" || (type && program::info(*type).family == program::Family::date);
    const bool is_real = type && program::info(*type).family == program::Family::real;
    const std::size_t begin = at_;
    if (peek() == '-' || peek() == '+') advance();
    while (is_in_name(peek()) || (peek() == '.' && peek(1) != '.') || peek() == '#' ||
           (is_date && (peek() == '-' || peek() == ':') && ascii::is_digit(peek(1))) ||
           (is_real && (peek() == '-' || peek() == '+') && ascii::lower(source_[at_ - 1]) == 'e')) {
      if (peek() == '.' && !ascii::is_digit(peek(1))) break;
      advance();
    }
    Token found = token(Kind::typed_literal, start, at);
    found.prefix = prefix;
    found.text = source_.substr(begin, at_ - begin);
    if (found.text.empty()) error(at, "expected a value after " + std::string(prefix) + "#");
    return found;
  }

  Token number(std::size_t start, SourcePosition at) {
    const auto digits = [&] {
      while (ascii::is_digit(peek()) || (peek() == '_' && is_in_name(peek(1)))) advance();
    };
    digits();
    int base = 10;
    std::size_t begin = start;
    Kind kind = Kind::integer;
    if (peek() == '#') {
      base = ascii::parse_number<int>(source_.substr(start, at_ - start)).value_or(0);
      advance();
      begin = at_;
      while (is_in_name(peek())) advance();
    } else {
      if (peek() == '.' && ascii::is_digit(peek(1))) {
        kind = Kind::real;
        advance();
        digits();
      }
      const std::size_t sign = peek(1) == '+' || peek(1) == '-' ? 1 : 0;
      if (ascii::lower(peek()) == 'e' && ascii::is_digit(peek(1 + sign))) {
        kind = Kind::real;
        advance(1 + sign);
        digits();
      }
    }
    Token found = token(kind, start, at);
    std::string plain;
    for (const char d : source_.substr(begin, at_ - begin))
      if (d != '_') plain += d;
    const auto wrong = [&](std::string_view why) {
      error(at, "'" + std::string(found.written) + "' " + std::string(why));
      found.kind = Kind::wrong;
      return found;
    };
    if (kind == Kind::real) {
      const auto value = ascii::parse_number<double>(plain);
      if (!value) return wrong("is beyond the range of LREAL");
      found.real = *value;
      return found;
    }
    if (base != 2 && base != 8 && base != 10 && base != 16)
      return wrong("has no base that there is; expected 2#, 8# or 16#");
    const auto value = ascii::parse_number_or_error<std::uint64_t>(plain, base);
    if (!value) {
      return wrong(value.error() == ascii::NumberError::out_of_range ? "is beyond the range of 64 bits"
                                                                     : "is no number of its base");
    }
    found.number = *value;
    found.is_based = base != 10 || begin != start;
    if (begins_name(peek())) {
      while (is_in_name(peek())) advance();
      found.written = source_.substr(start, at_ - start);
      return wrong("is no number; a name begins with a letter or _");
    }
    return found;
  }

  Token string(std::size_t start, SourcePosition at) {
    const char quote = peek();
    advance();
    while (at_ < source_.size() && peek() != quote && peek() != '\n' && peek() != '\r')
      advance(peek() == '$' && peek(1) != '\n' ? 2 : 1);
    Token found = token(quote == '\'' ? Kind::string : Kind::wide_string, start, at);
    found.text = source_.substr(start + 1, at_ - start - 1);
    if (peek() == quote) {
      advance();
    } else {
      error(at, std::string("the string does not end; expected ") + quote);
      found.kind = Kind::wrong;
    }
    return found;
  }

  std::string_view source_;
  std::string_view capitals_;
  std::uint16_t file_;
  std::vector<SourceError>& errors_;
  std::size_t at_ = 0;
  std::size_t at_start_ = 0;
  std::size_t line_start_ = 0;
  std::uint32_t line_ = 1;
};

}  // namespace

std::vector<Token> tokens_of(std::string_view source, std::string_view capitals, std::uint16_t file,
                             std::vector<SourceError>& errors) {
  return Lexer(source, capitals, file, errors).run();
}

}  // namespace canopus::structured_text
