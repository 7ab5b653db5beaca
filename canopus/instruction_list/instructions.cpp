#include "canopus/instruction_list/instructions.hpp"

#include <array>
#include <map>
#include <vector>

#include "canopus/ascii/words.hpp"

namespace canopus::instruction_list {

namespace {

constexpr std::uint8_t bit(Family family) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(family));
}
constexpr std::uint8_t q = bit(Family::q);
constexpr std::uint8_t iqr = bit(Family::iqr);
constexpr std::uint8_t fx3 = bit(Family::fx3);
constexpr std::uint8_t fx5 = bit(Family::fx5);
constexpr std::uint8_t all = q | iqr | fx3 | fx5;
constexpr std::uint8_t big = q | iqr | fx5;
constexpr std::uint8_t fx = fx3 | fx5;
constexpr std::uint8_t q_iqr = q | iqr;
constexpr std::uint8_t new_ones = iqr | fx5;  // those of GX Works3

constexpr std::uint8_t P = with_pulse;
constexpr std::uint8_t DP = with_double | with_pulse;
constexpr std::uint8_t D = with_double;
constexpr std::uint8_t DU = with_double | with_unsigned;
constexpr std::uint8_t DPU = with_double | with_pulse | with_unsigned;

// clang-format off
constexpr Instruction table[] = {
    // Contacts
    {"LD LDI AND ANI OR ORI", "b", all, 0, Action::contact, "contact, normally open or closed"},
    {"LDP LDF ANDP ANDF ORP ORF", "b", all, 0, Action::pulse_contact, "contact for one execution: rising, falling edge"},
    {"LDPI LDFI ANDPI ANDFI ORPI ORFI", "b", big, 0, Action::pulse_contact, "the same, inverted"},
    {"ANB ORB", "", all, 0, Action::block, "joins two blocks in series, in parallel"},
    {"MPS MRD MPP", "", all, 0, Action::stack, "branches: result stored, read, read and removed"},
    {"INV", "", all, 0, Action::invert, "result inverted"},
    {"MEP MEF", "", all, 0, Action::pulse_result, "edge of the result: rising, falling"},
    {"EGP EGF", "B", q_iqr, 0, Action::edge_relay, "edge of the result by an edge relay V"},
    {"LD= LD<> LD> LD<= LD< LD>=", "s s", all, D, Action::compare, "comparison"},
    {"AND= AND<> AND> AND<= AND< AND>=", "s s", all, D, Action::compare, "comparison in series"},
    {"OR= OR<> OR> OR<= OR< OR>=", "s s", all, D, Action::compare, "comparison in parallel"},
    {"LD= LD<> LD> LD<= LD< LD>=", "s s", new_ones, DU, Action::compare, "comparison without a sign: names with _U"},
    {"AND= AND<> AND> AND<= AND< AND>=", "s s", new_ones, DU, Action::compare, "comparison without a sign in series: names with _U"},
    {"OR= OR<> OR> OR<= OR< OR>=", "s s", new_ones, DU, Action::compare, "comparison without a sign in parallel: names with _U"},
    {"LDE= LDE<> LDE> LDE<= LDE< LDE>=", "e e", big, 0, Action::compare, "comparison of REAL"},
    {"ANDE= ANDE<> ANDE> ANDE<= ANDE< ANDE>=", "e e", big, 0, Action::compare, "comparison of REAL in series"},
    {"ORE= ORE<> ORE> ORE<= ORE< ORE>=", "e e", big, 0, Action::compare, "comparison of REAL in parallel"},
    {"LDED= LDED<> LDED> LDED<= LDED< LDED>=", "f f", q_iqr, 0, Action::compare, "comparison of LREAL"},
    {"ANDED= ANDED<> ANDED> ANDED<= ANDED< ANDED>=", "f f", q_iqr, 0, Action::compare, "comparison of LREAL in series"},
    {"ORED= ORED<> ORED> ORED<= ORED< ORED>=", "f f", q_iqr, 0, Action::compare, "comparison of LREAL in parallel"},
    {"LD$= LD$<> LD$> LD$<= LD$< LD$>=", "t t", big, 0, Action::compare_text, "comparison of texts"},
    {"AND$= AND$<> AND$> AND$<= AND$< AND$>=", "t t", big, 0, Action::compare_text, "comparison of texts in series"},
    {"OR$= OR$<> OR$> OR$<= OR$< OR$>=", "t t", big, 0, Action::compare_text, "comparison of texts in parallel"},
    {"LDDT= LDDT<> LDDT> LDDT<= LDDT< LDDT>=", "a a n", big, 0, Action::compare_clock, "comparison of dates (year, month, day): bits of n, 8000H more: with the clock"},
    {"ANDDT= ANDDT<> ANDDT> ANDDT<= ANDDT< ANDDT>=", "a a n", big, 0, Action::compare_clock, "comparison of dates (year, month, day) in series: bits of n, 8000H more: with the clock"},
    {"ORDT= ORDT<> ORDT> ORDT<= ORDT< ORDT>=", "a a n", big, 0, Action::compare_clock, "comparison of dates (year, month, day) in parallel: bits of n, 8000H more: with the clock"},
    {"LDTM= LDTM<> LDTM> LDTM<= LDTM< LDTM>=", "a a n", big, 0, Action::compare_clock, "comparison of times (hour, minute, second): bits of n, 8000H more: with the clock"},
    {"ANDTM= ANDTM<> ANDTM> ANDTM<= ANDTM< ANDTM>=", "a a n", big, 0, Action::compare_clock, "comparison of times (hour, minute, second) in series: bits of n, 8000H more: with the clock"},
    {"ORTM= ORTM<> ORTM> ORTM<= ORTM< ORTM>=", "a a n", big, 0, Action::compare_clock, "comparison of times (hour, minute, second) in parallel: bits of n, 8000H more: with the clock"},
    // Outputs
    {"OUT", "o|o k", all, 0, Action::out, "bit; timer (Q, iQ-R, FX5: 100 ms) or counter with its setting"},
    {"OUTH", "o k", big, 0, Action::out_high_speed, "high-speed timer: 10 ms"},
    {"OUTHS", "o k", fx5, 0, Action::out_millisecond, "timer of 1 ms"},
    {"SET", "o", all, 0, Action::set, "bit ON"},
    {"RST", "o", all, 0, Action::reset, "bit OFF, word 0; timer or counter: contact OFF, value 0"},
    {"PLS PLF", "B", all, 0, Action::pulse, "bit ON for a scan: rising, falling edge"},
    {"FF", "B", big, 0, Action::toggle, "bit inverted with each rising edge"},
    {"ALT", "B", fx, P, Action::toggle, "bit inverted; ALTP with each rising edge"},
    {"SFT", "B", big, P, Action::shift_device, "bit takes over the one below it, which goes OFF"},
    // Program
    {"MC", "N B", all, 0, Action::master_control, "master control: outputs up to MCR are OFF without it"},
    {"MCR", "N", all, 0, Action::master_control_reset, "its end"},
    {"CJ", "p", all, P, Action::jump, "jump with a condition"},
    {"JMP", "p", big, 0, Action::jump_always, "jump"},
    {"GOEND", "", big, 0, Action::jump_to_end, "jump to END"},
    {"EI", "", all, 0, Action::enable_interrupts, "interrupt programs are executed; in the main program also those that have waited"},
    {"DI", "", all, 0, Action::disable_interrupts, "interrupt programs wait, as from RUN on"},
    {"IRET", "", all, 0, Action::interrupt_return, "end of an interrupt program"},
    {"STL", "b", fx, 0, Action::state, "step: what follows is executed while the state S is ON"},
    {"RET", "", fx3, 0, Action::state_end, "end of the steps"},
    {"RETSTL", "", fx5, 0, Action::state_end, "end of the steps"},
    {"CALL", "p", all, P, Action::call, "subroutine"},
    {"RET", "", q_iqr | fx5, 0, Action::return_, "its end"},
    {"SRET", "", fx, 0, Action::return_, "its end"},
    {"FEND", "", all, 0, Action::main_end, "end of the main program"},
    {"END", "", all, 0, Action::end, "end of the program"},
    {"FOR", "n", all, 0, Action::for_, "repeats up to NEXT"},
    {"NEXT", "", all, 0, Action::next, "end of FOR"},
    {"BREAK", "d p", big, P, Action::break_, "leaves FOR: repetitions that remain, pointer"},
    {"NOP", "", all, 0, Action::nothing, "nothing"},
    {"NOPLF", "", q_iqr, 0, Action::nothing, "page break of a print"},
    {"WDT", "", all, P, Action::nothing, "watchdog timer: nothing, as a scan takes no time"},
    // Moves
    {"MOV", "s d", all, DP, Action::move, "value"},
    {"EMOV", "e E", big, P, Action::move, "REAL"},
    {"DEMOV", "e E", fx, P, Action::move, "REAL"},
    {"EDMOV", "f F", q_iqr, P, Action::move, "LREAL"},
    {"CML", "s d", all, DP, Action::complement, "all bits inverted"},
    {"NEG", "d", all, DP, Action::negate, "negative"},
    {"XCH", "d d", all, DP, Action::exchange, "exchanges two"},
    {"SWAP", "W", all, P, Action::swap_bytes, "exchanges the bytes of a word"},
    {"BMOV", "a A n", all, P, Action::block_move, "n words"},
    {"FMOV", "s A n", all, DP, Action::fill_move, "a value to n words"},
    {"ZRST", "o o", fx, P, Action::reset_range, "all from the first to the last device 0 or OFF"},
    {"BKRST", "A n", q_iqr, P, Action::reset_block, "n bits OFF"},
    {"$MOV", "t T", all, P, Action::move_text, "text, with 00H behind it"},
    // Arithmetic
    {"+ -", "s d|s s d", big, DP, Action::arithmetic, "d = d + s, or d = s + s"},
    {"* /", "s s x", big, DP, Action::multiply, "product of twice the width; quotient and remainder"},
    {"+ -", "s d|s s d", new_ones, DPU, Action::arithmetic, "without a sign: names with _U"},
    {"* /", "s s x", new_ones, DPU, Action::multiply, "without a sign: names with _U"},
    {"ADD SUB", "s s d", fx, DP, Action::arithmetic, "d = s + s, s - s"},
    {"MUL DIV", "s s x", fx, DP, Action::multiply, "product of twice the width; quotient and remainder"},
    {"INC", "d", all, DP, Action::increment, "one more"},
    {"DEC", "d", all, DP, Action::decrement, "one less"},
    {"E+ E-", "e E|e e E", big, P, Action::real_arithmetic, "REAL: d = d + s, or d = s + s"},
    {"E* E/", "e e E", big, P, Action::real_multiply, "REAL"},
    {"ED+ ED-", "f F|f f F", q_iqr, P, Action::real_arithmetic, "LREAL: d = d + s, or d = s + s"},
    {"ED* ED/", "f f F", q_iqr, P, Action::real_multiply, "LREAL"},
    {"DEADD DESUB", "e e E", fx, P, Action::real_arithmetic, "REAL"},
    {"DEMUL DEDIV", "e e E", fx, P, Action::real_multiply, "REAL"},
    // Logic, shift
    {"WAND WOR WXOR WXNR", "s d|s s d", big, P, Action::logic, "bit by bit"},
    {"DAND DOR DXOR DXNR", "l L|l l L", big, P, Action::logic, "bit by bit, 32 bits"},
    {"WAND WOR WXOR", "s s d", fx3, P, Action::logic, "bit by bit"},
    {"DAND DOR DXOR", "l l L", fx3, P, Action::logic, "bit by bit, 32 bits"},
    {"ROR RCR ROL RCL", "d n", all, DP, Action::rotate, "rotates by n bits: right, right with carry, left, left with carry"},
    {"SFR SFL", "W n", big, P, Action::shift, "shifts by n bits: right, left"},
    {"BSFR BSFL", "A n", big, P, Action::shift_bits, "n bits by one: right, left"},
    {"DSFR DSFL", "A n", big, P, Action::shift_words, "n words by one: right, left"},
    {"SFTR SFTL", "a A n n", fx, P, Action::shift_in_bits, "n1 bits by n2, which come from s"},
    {"WSFR WSFL", "a A n n", fx, P, Action::shift_in_words, "n1 words by n2, which come from s"},
    // Conversions, comparisons
    {"BCD", "s d", all, DP, Action::to_bcd, "binary to BCD: up to 9999, 99999999"},
    {"BIN", "s d", all, DP, Action::from_bcd, "BCD to binary"},
    {"FLT", "s E", q | fx, DP, Action::to_real, "integer to REAL"},
    {"INT", "e d", q, DP, Action::from_real, "REAL to integer, rounded"},
    {"INT", "e d", fx, DP, Action::truncate_real, "REAL to integer, towards 0"},
    {"INT2FLT", "w E", new_ones, P, Action::to_real, "integer to REAL"},
    {"DINT2FLT", "l E", new_ones, P, Action::to_real, "integer of 32 bits to REAL"},
    {"FLT2INT", "e W", new_ones, P, Action::from_real, "REAL to integer, rounded"},
    {"FLT2DINT", "e L", new_ones, P, Action::from_real, "REAL to integer of 32 bits, rounded"},
    {"CMP", "s s B", fx, DP, Action::compare_to_bits, "three bits: greater, equal, less"},
    {"ZCP", "s s s B", fx, DP, Action::zone_compare, "three bits: below, within, above"},
    {"SUM", "s d", fx, DP, Action::count_bits, "number of bits that are ON"},
    {"SUM", "s W", q_iqr, DP, Action::count_bits, "number of bits that are ON"},
    {"MEAN", "a d n", all, DP, Action::mean, "mean of n values without its fraction"},
    {"MEAN", "a d n", new_ones, DPU, Action::mean, "without a sign: names with _U"},
    {"LIMIT", "s s s d", all, DP, Action::limit, "third value within the first and the second one"},
    {"LIMIT", "s s s d", new_ones, DPU, Action::limit, "without a sign: names with _U"},
    {"SQR", "s d", fx3, DP, Action::square_root, "square root without its fraction"},
    {"SQR", "e E", q, P, Action::square_root, "square root of a REAL"},
    // Modules
    {"FROM", "n n A n", all, P, Action::from, "buffer memory: module, address, to, words"},
    {"TO", "n n v n", all, P, Action::to, "buffer memory: module, address, from, words"},
    {"DFRO", "n n A n", q_iqr | fx5, P, Action::from, "the same of 32 bits"},
    {"DTO", "n n v n", all, P, Action::to, "the same of 32 bits"},
    {"DFROM", "n n A n", fx, P, Action::from, "the same of 32 bits"},
    {"RFS", "B n", big, P, Action::refresh, "n X of modules as they are now, or n Y to the modules"},
    {"REF", "B n", fx, P, Action::refresh, "n X of modules as they are now, or n Y to the modules"},
    // Clock
    {"TRD", "A", fx, P, Action::read_clock, "clock to seven words: year, month, day, hour, minute, second, day of the week"},
    {"TWR", "a", fx, P, Action::set_clock, "sets the clock from seven words"},
    {"DATERD", "A", q_iqr, P, Action::read_clock, "clock to seven words: year, month, day, hour, minute, second, day of the week"},
    {"DATEWR", "a", q_iqr, P, Action::set_clock, "sets the clock from seven words"},
    {"TCMP", "n n n a B", fx, P, Action::compare_time, "hour, minute, second with three words: three bits as of CMP"},
    {"TZCP", "a a a B", fx, P, Action::compare_time_zone, "three times of three words: three bits as of ZCP"},
    {"TADD TSUB", "a a A", fx, P, Action::add_times, "times of three words, within a day"},
    {"DATE+ DATE-", "a a A", q_iqr, P, Action::add_times, "times of three words, within a day"},
    {"HTOS", "a d", fx, DP, Action::to_seconds, "time of three words in seconds"},
    {"STOH", "s A", fx, DP, Action::from_seconds, "seconds as a time of three words"},
    {"SECOND", "a L", q_iqr, P, Action::to_seconds, "time of three words in seconds, 32 bits"},
    {"HOUR", "l A", q_iqr, P, Action::from_seconds, "seconds, 32 bits, as a time of three words"},
};

constexpr AbsentInstruction absent[] = {
    {"IST", fx, "there is no operation mode of initial states; SET the states by contacts"},
    {"SQR", new_ones, "not there yet; what its name is in GX Works3 was not found"},
    {"SFC* BLOCK* STEP* TRAN* BSTART BEND ASTART", q_iqr, "sequential function charts (SFC) are not there"},
    {"PID PIDINIT PIDCONT PIDSTOP PIDRUN S.PID*", all, "there is no PID control loop"},
    {"IMASK SIMASK GETIMASK", big, "the interrupts are not masked one by one; EI and DI are there"},
    {"HSCS HSCR HSZ HSCT DHSCS DHSCR DHSZ DHSCT SPD UDCNT1 UDCNT2 HIOEN", all, "there are no inputs of high-speed counters"},
    {"PLSY PLSR PLSV PWM DRVI DRVA ZRN DSZR DVIT TBL ABS DPLSY DPLSR DPLSV DDRVI DDRVA DZRN DDVIT DTBL DABS RAMP ROTC", all, "there are no pulse outputs and positioning"},
    {"RS RS2 IVCK IVDR IVRD IVWR IVBWR ADPRW FLCRT FLDEL FLWR FLRD FLCMD FLSTRD", fx, "there are no communication adapters"},
    {"REFF MTR HKY DSW SEGD SEGL ARWS PR ANS ANR TKY KY*", all, "there are no filters, keys and displays of the base unit"},
    {"J.* JP.* G.* GP.* Z.* ZP.* S.TO SP.TO D.* DP.* DDWR DDRD", q_iqr, "dedicated instructions of modules and networks are not there; use FROM, TO and U\\G"},
    {"RSET* QDRSET* QCDSET* ZRRDB* ZRWRB* SP.FREAD SP.FWRITE S.FREAD S.FWRITE", q_iqr, "there are no files and blocks of file registers"},
    {"PSTART* PSTOP* POFF* PSCAN* PLOW* ECALL* EFCALL* XCALL FCALL*", q_iqr, "a list is a program of its own; use tasks of the plant file"},
    {"BON ENCO DECO SORT SER SMOV CCD CRC BZCP SCL WTOB BTOW UNI DIS BAND ZONE SCL* BAND* ZONE*", all, "not there yet"},
};
// clang-format on

const std::multimap<std::string, NamedInstruction, std::less<>>& by_name() {
  static const auto made = [] {
    std::multimap<std::string, NamedInstruction, std::less<>> names;
    for (const Instruction& row : table) {
      std::uint8_t variant = 0;
      for (const std::string_view name : ascii::words(row.names)) {
        // A row with _U has those names alone: the plain ones are in a row of their own.
        for (std::uint8_t forms = 0; forms <= row.forms; ++forms) {
          const bool is_form =
              (forms & ~row.forms) == 0 && ((row.forms & with_unsigned) == 0 || (forms & with_unsigned) != 0);
          if (is_form) names.emplace(form_of_name(row, name, forms), NamedInstruction{&row, variant, forms});
        }
        ++variant;
      }
    }
    return names;
  }();
  return made;
}

/// "PID*" is every name that begins so; of the others P behind it is one, too.
bool matches(std::string_view pattern, std::string_view name) {
  if (pattern.ends_with('*')) return name.starts_with(pattern.substr(0, pattern.size() - 1));
  return name == pattern || (name.ends_with('P') && name.substr(0, name.size() - 1) == pattern);
}

}  // namespace

std::string_view family_name(Family family) noexcept {
  static constexpr std::array<std::string_view, 4> names = {"Q", "iQ-R", "FX3", "FX5"};
  return names[static_cast<std::size_t>(family)];
}

std::span<const Instruction> instructions() noexcept { return table; }

std::span<const AbsentInstruction> absent_instructions() noexcept { return absent; }

const AbsentInstruction* absent_instruction(std::string_view name, Family family) {
  for (const AbsentInstruction& each : absent) {
    if ((each.families & bit(family)) == 0) continue;
    for (const std::string_view pattern : ascii::words(each.names))
      if (matches(pattern, name)) return &each;
  }
  return nullptr;
}

// The D of a contact stands before its sign: LDD>=.
std::string form_of_name(const Instruction& instruction, std::string_view name, std::uint8_t forms) {
  std::string made(name);
  if ((forms & with_double) != 0)
    made.insert(instruction.action == Action::compare ? made.find_first_of("=<>") : 0, 1, 'D');
  if ((forms & with_pulse) != 0) made += 'P';
  if ((forms & with_unsigned) != 0) made += "_U";
  return made;
}

std::optional<NamedInstruction> instruction_named(std::string_view name, Family family) {
  const auto [begin, end] = by_name().equal_range(name);
  for (auto found = begin; found != end; ++found)
    if ((found->second.instruction->families & bit(family)) != 0) return found->second;
  return std::nullopt;
}

std::string families_with(std::string_view name) {
  std::string names;
  for (const Family family : {Family::q, Family::iqr, Family::fx3, Family::fx5}) {
    if (!instruction_named(name, family)) continue;
    if (!names.empty()) names += ", ";
    names += family_name(family);
  }
  return names;
}

}  // namespace canopus::instruction_list
