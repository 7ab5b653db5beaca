// Every instruction of the table, with values worked out by hand.

#include <set>
#include <sstream>

#include <gmock/gmock.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"

#include "list_plc.hpp"

namespace canopus::instructions_test {
namespace {

using list_plc::Family;
using list_plc::ListPlc;

/// Scans: what is set before one, and what must be there behind it: "X0=1 D0=5 > D1=5 / X0=0 > D1=5".
struct Case {
  Family family;
  const char* program;  ///< instructions with ; between them
  const char* scans;
};

constexpr Family q = Family::q;
constexpr Family r = Family::iqr;
constexpr Family fx3 = Family::fx3;
constexpr Family fx5 = Family::fx5;

// clang-format off
const Case cases[] = {
    {q, "LD M0; OUT M10; LDI M0; OUT M11; LD M0; AND M1; OUT M12; LD M0; ANI M1; OUT M13; LD M0; OR M1; OUT M14; LD M0; ORI M1; OUT M15",
     "M0=0 M1=0 > M10=0 M11=1 M12=0 M13=0 M14=0 M15=1 / M0=1 > M10=1 M11=0 M12=0 M13=1 M14=1 M15=1 / M1=1 > M12=1 M13=0 / M0=0 > M14=1 M15=0"},
    {q, "LDP M0; OUT M10; LDF M0; OUT M11; LD M1; ANDP M0; OUT M12; LD M1; ANDF M0; OUT M13; LD M2; ORP M0; OUT M14; LD M2; ORF M0; OUT M15",
     "M1=1 > M10=0 M11=0 / M0=1 > M10=1 M11=0 M12=1 M13=0 M14=1 M15=0 / > M10=0 M12=0 M14=0 / M0=0 > M10=0 M11=1 M13=1 M14=0 M15=1 / > M11=0 M13=0 M15=0"},
    {r, "LDPI M0; OUT M10; LDFI M0; OUT M11; LD M1; ANDPI M0; OUT M12; LD M1; ANDFI M0; OUT M13; LD M2; ORPI M0; OUT M14; LD M2; ORFI M0; OUT M15",
     "M1=1 > M10=1 M11=1 / M0=1 > M10=0 M11=1 M12=0 M13=1 M14=0 M15=1 / M0=0 > M10=1 M11=0 M12=1 M13=0 M14=1 M15=0"},
    {fx3, "LD M0; LD M1; OR M2; ANB; OUT M10; LD M0; LD M1; AND M2; ORB; OUT M11",
     "M0=1 M2=1 > M10=1 M11=1 / M2=0 > M10=0 M11=1 / M0=0 M1=1 M2=1 > M10=0 M11=1"},
    {fx3, "LD M0; MPS; AND M1; OUT M10; MRD; AND M2; OUT M11; MPP; ANI M2; OUT M12",
     "M0=1 M1=1 > M10=1 M11=0 M12=1 / M2=1 > M10=1 M11=1 M12=0 / M0=0 > M10=0 M11=0 M12=0"},
    {fx3, "LD M0; INV; OUT M10", "M0=0 > M10=1 / M0=1 > M10=0"},
    {q, "LD M0; AND M1; MEP; OUT M10; LD M0; MEF; OUT M11", "M0=1 > M10=0 / M1=1 > M10=1 / > M10=0 / M0=0 > M10=0 M11=1 / > M11=0"},
    {q, "LD M0; EGP V0; OUT M10; LD M0; EGF V1; OUT M11", "M0=1 > M10=1 V0=1 / > M10=0 M11=0 / M0=0 > M11=1 V1=0 / > M11=0"},
    {q, "LD= D0 K5; OUT M1; LD<> D0 K5; OUT M2; LD> D0 K5; OUT M3; LD<= D0 K5; OUT M4; LD< D0 K5; OUT M5; LD>= D0 K5; OUT M6",
     "D0=5 > M1=1 M2=0 M3=0 M4=1 M5=0 M6=1 / D0=-1 > M1=0 M2=1 M3=0 M4=1 M5=1 M6=0 / D0=6 > M1=0 M2=1 M3=1 M4=0 M5=0 M6=1"},
    {fx3, "LD M0; AND= D0 K5; OUT M1; LD M0; AND<> D0 K5; OUT M2; LD M0; AND> D0 K5; OUT M3; LD M0; AND<= D0 K5; OUT M4; LD M0; AND< D0 K5; OUT M5; LD M0; AND>= D0 K5; OUT M6",
     "M0=1 D0=5 > M1=1 M2=0 M3=0 M4=1 M5=0 M6=1 / D0=6 > M1=0 M2=1 M3=1 M4=0 M5=0 M6=1 / M0=0 > M2=0 M3=0 M6=0"},
    {fx5, "LD M0; OR= D0 K5; OUT M1; LD M0; OR<> D0 K5; OUT M2; LD M0; OR> D0 K5; OUT M3; LD M0; OR<= D0 K5; OUT M4; LD M0; OR< D0 K5; OUT M5; LD M0; OR>= D0 K5; OUT M6",
     "M0=0 D0=5 > M1=1 M2=0 M3=0 M4=1 M5=0 M6=1 / M0=1 > M1=1 M2=1 M3=1 M4=1 M5=1 M6=1"},
    {fx3, "LDD= D0 K65537; OUT M1; LDD> D0 K-1; OUT M2; LD M3; ANDD<= D0 H10001; OUT M4; LD M5; ORD<> D0 K0; OUT M6",
     "D0=1 D1=1 M3=1 > M1=1 M2=1 M4=1 M6=1 / D0=-2 D1=-1 > M1=0 M2=0 M4=1 M6=1"},
    {r, "LD=_U D0 K65535; OUT M1; LD>_U D0 K1; OUT M2; LDD<_U D2 H80000000; OUT M3; LD<>_U D0 K0; OUT M4; LD<=_U D0 K0; OUT M5; LD<_U D0 K2; OUT M6; LD>=_U D0 K9; OUT M7",
     "D0=-1 > M1=1 M2=1 M3=1 M4=1 M5=0 M6=0 M7=1"},
    {fx5, "LD M0; AND=_U D0 K65535; OUT M1; LD M0; AND>_U D0 K1; OUT M2; LD M0; AND<>_U D0 K0; OUT M4; LD M0; AND<=_U D0 K0; OUT M5; LD M0; AND<_U D0 K2; OUT M6; LD M0; AND>=_U D0 K9; OUT M7",
     "M0=1 D0=-1 > M1=1 M2=1 M4=1 M5=0 M6=0 M7=1"},
    {fx5, "LD M0; OR=_U D0 K65535; OUT M1; LD M0; OR>_U D0 K1; OUT M2; LD M0; OR<>_U D0 K0; OUT M4; LD M0; OR<=_U D0 K0; OUT M5; LD M0; OR<_U D0 K2; OUT M6; LD M0; OR>=_U D0 K9; OUT M7",
     "D0=-1 > M1=1 M2=1 M4=1 M5=0 M6=0 M7=1"},
    {q, "LDE= D0 E1.5; OUT M1; LDE<> D0 E1.5; OUT M2; LDE> D0 E1.25; OUT M3; LDE<= D0 E1.5; OUT M4; LDE< D0 E1.5; OUT M5; LDE>= D0 E-2; OUT M6",
     "D0=0 D1=16320 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=1"},  // 3FC00000H
    {r, "LD M0; ANDE= D0 E1.5; OUT M1; LD M0; ANDE<> D0 E1.5; OUT M2; LD M0; ANDE> D0 E1.25; OUT M3; LD M0; ANDE<= D0 E1.5; OUT M4; LD M0; ANDE< D0 E1.5; OUT M5; LD M0; ANDE>= D0 E-2; OUT M6",
     "M0=1 D0=0 D1=16320 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=1"},
    {fx5, "LD M0; ORE= D0 E1.5; OUT M1; LD M0; ORE<> D0 E1.5; OUT M2; LD M0; ORE> D0 E1.25; OUT M3; LD M0; ORE<= D0 E1.5; OUT M4; LD M0; ORE< D0 E1.5; OUT M5; LD M0; ORE>= D0 E-2; OUT M6",
     "D0=0 D1=16320 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=1"},
    {q, "LDED= D0 E1.5; OUT M1; LDED<> D0 E1.5; OUT M2; LDED> D0 E1.25; OUT M3; LDED<= D0 E1.5; OUT M4; LDED< D0 E1.5; OUT M5; LDED>= D0 E-2; OUT M6",
     "D3=16376 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=1"},  // 3FF8 0000 0000 0000H
    {q, "LD M0; ANDED= D0 E1.5; OUT M1; LD M0; ANDED<> D0 E1.5; OUT M2; LD M0; ANDED> D0 E1.25; OUT M3; LD M0; ANDED<= D0 E1.5; OUT M4; LD M0; ANDED< D0 E1.5; OUT M5; LD M0; ANDED>= D0 E-2; OUT M6",
     "M0=1 D3=16376 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=1"},
    {q, "LD M0; ORED= D0 E1.5; OUT M1; LD M0; ORED<> D0 E1.5; OUT M2; LD M0; ORED> D0 E1.25; OUT M3; LD M0; ORED<= D0 E1.5; OUT M4; LD M0; ORED< D0 E1.5; OUT M5; LD M0; ORED>= D0 E-2; OUT M6",
     "D3=16376 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=1"},
    {q, "LD$= D0 \"AB\"; OUT M1; LD$<> D0 \"AB\"; OUT M2; LD$> D0 \"AA\"; OUT M3; LD$<= D0 \"ABC\"; OUT M4; LD$< D0 \"AB\"; OUT M5; LD$>= D0 \"B\"; OUT M6",
     "D0=16961 D1=0 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=0"},  // 4241H
    {q, "LD M0; AND$= D0 \"AB\"; OUT M1; LD M0; AND$<> D0 \"AB\"; OUT M2; LD M0; AND$> D0 \"AA\"; OUT M3; LD M0; AND$<= D0 \"ABC\"; OUT M4; LD M0; AND$< D0 \"AB\"; OUT M5; LD M0; AND$>= D0 \"B\"; OUT M6",
     "M0=1 D0=16961 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=0"},
    {q, "LD M0; OR$= D0 \"AB\"; OUT M1; LD M0; OR$<> D0 \"AB\"; OUT M2; LD M0; OR$> D0 \"AA\"; OUT M3; LD M0; OR$<= D0 \"ABC\"; OUT M4; LD M0; OR$< D0 \"AB\"; OUT M5; LD M0; OR$>= D0 \"B\"; OUT M6",
     "D0=16961 > M1=1 M2=0 M3=1 M4=1 M5=0 M6=0"},
    // Outputs
    {q, "LD M0; OUT D0.5; OUT Y1F; LD D0.5; OUT M1", "M0=1 > D0=32 Y1F=1 M1=1 / M0=0 > D0=0 Y1F=0 M1=0"},
    {q, "LD M0; OUTH T0 K2; LD T0; OUT M1", "M0=1 > M1=0 TC0=1 TN0=0 / > TN0=1 M1=0 / > TN0=2 TS0=1 M1=1"},
    {fx5, "LD M0; OUTHS T0 K15; LD T0; OUT M1", "M0=1 > M1=0 / > TN0=10 M1=0 / > TN0=15 M1=1"},
    {q, "LD M0; SET M1; LD M2; RST M1; LD M2; RST D0; SET D1.3", "M0=1 D0=7 > M1=1 D0=7 / M0=0 > M1=1 / M2=1 > M1=0 D0=0 D1=8"},
    {fx3, "LD M0; PLS M1; LD M0; PLF M2", "M0=1 > M1=1 M2=0 / > M1=0 / M0=0 > M1=0 M2=1 / > M2=0"},
    {q, "LD M0; FF M1", "M0=1 > M1=1 / > M1=1 / M0=0 > M1=1 / M0=1 > M1=0"},
    {fx3, "LD M0; ALT M1; LD M0; ALTP M2", "M0=1 > M1=1 M2=1 / > M1=0 M2=1 / M0=0 > M1=0 / M0=1 > M1=1 M2=0"},
    {q, "LD M0; SFT M11; LD M0; SFTP M21", "M0=1 M10=1 M20=1 > M10=0 M11=1 M20=0 M21=1 / M20=1 M21=0 > M11=0 M21=0 M20=1"},
    {q, "LD M0; MC N0 M50; LD M1; OUT M2; LD M1; SET M3; LD M1; OUTH T0 K1; MCR N0; LD M1; OUT M4",
     "M1=1 > M50=0 M2=0 M3=0 M4=1 / M0=1 > M50=1 M2=1 M3=1 TC0=1 / M0=0 > M2=0 M3=1 M4=1 TC0=0 TN0=0"},
    {fx3, "LD M0; MC N0 M50; LD M1; MC N1 M51; LD M8000; OUT M2; MCR N1; LDI M1; OUT M3; MCR N0", "M8000=1 M0=1 > M2=0 M3=1 / M1=1 > M51=1 M2=1 M3=0 / M0=0 > M51=0 M2=0 M3=0"},
    // Program
    {fx3, "LD M0; CJ P0; LD M1; OUT M2; P0; LD M1; OUT M3; LD M0; CJP P63; LD M1; OUT M4",
     "M1=1 > M2=1 M3=1 M4=1 / M0=1 M1=0 > M2=1 M3=0 M4=1 / > M4=0"},
    {q, "JMP P5; LD SM400; OUT M0; P5; LD SM400; OUT M1; LD SM400; CJ P6; GOEND; P6; GOEND; LD SM400; OUT M2", "SM400=1 > M0=0 M1=1 M2=0"},
    {q, "LD M0; CALL P1; LD M1; CALLP P1; FEND; P1; LD SM400; INC D0; RET", "SM400=1 M0=1 > D0=1 / > D0=2 / M0=0 M1=1 > D0=3 / > D0=3"},
    {fx3, "LD M0; CALL P1; FEND; P1; LD M8000; INC D0; SRET", "M8000=1 M0=1 > D0=1 / M0=0 > D0=1"},
    {fx5, "LD SM400; INC D0; FOR K3; FOR D5; LD SM400; INC D1; NEXT; NEXT; LD SM400; INC D0", "SM400=1 D5=4 > D0=2 D1=12"},
    {fx3, "FOR D5; LD M8000; INC D1; NEXT", "M8000=1 D5=-4 > D1=1"},
    {q, "FOR K10; LD SM400; INC D1; LD= D1 K4; BREAK D2 P0; NEXT; P0; LD SM400; INC D3", "SM400=1 > D1=4 D2=7 D3=1"},
    {q, "NOP; NOPLF; LD SM400; WDT; OUT M0", "SM400=1 > M0=1"},
    // Moves
    {fx3, "LD M0; MOV K-5 D0; DMOV H12345678 D2; LD M0; MOVP D10 D11; DMOVP D12 D14", "M0=1 D10=3 D12=1 D13=2 > D0=-5 D2=22136 D3=4660 D11=3 D14=1 D15=2 / D10=4 > D11=3"},
    {q, "LD M0; MOV K4M16 D0; MOV H5 K1M40; MOV K2M16 D1; DMOV K8M16 D2", "M0=1 M16=1 M23=1 M31=1 M47=1 > D0=-32639 M40=1 M41=0 M42=1 M43=0 M44=0 D1=129 D2=-32639 D3=-31488"},
    {q, "LD M0; MOV D0Z1 D10; MOV K7 D20Z1; MOV K10Z1 D30; MOV D0 Z2; LD M100Z1; OUT M0Z1", "M0=1 Z1=2 D0=9 D2=42 M102=1 > D10=42 D22=7 D30=12 Z2=9 M2=1"},
    {fx3, "LD M0; MOV K2 Z1; MOV K3 V0; DMOV K65537 Z2; DMOV Z2 D4; MOV D0Z1 D10; MOV D0V0 D11; MOV K1 V; MOV V D12", "M0=1 D2=42 D3=43 > D10=42 D11=43 D4=1 D5=1 D12=1"},
    {q, "LD M0; EMOV E1.5 D0; EDMOV E1.5 D4", "M0=1 > D0=0 D1=16320 D4=0 D5=0 D6=0 D7=16376"},
    {fx3, "LD M0; DEMOV E1.5+1 D0", "M0=1 > D0=0 D1=16752"},  // 15.0: 41700000H
    {q, "LD M0; CML D0 D1; DCML D2 D4", "M0=1 D0=21845 D2=0 D3=-1 > D1=-21846 D4=-1 D5=0"},
    {fx3, "LD M0; NEG D0; DNEG D2", "M0=1 D0=5 D2=1 D3=0 > D0=-5 D2=-1 D3=-1"},
    {fx3, "LD M0; XCH D0 D1; DXCH D2 D4", "M0=1 D0=5 D1=6 D2=1 D3=2 D4=3 D5=4 > D0=6 D1=5 D2=3 D3=4 D4=1 D5=2"},
    {fx3, "LD M0; SWAP D0", "M0=1 D0=4660 > D0=13330"},  // 1234H, 3412H
    {fx3, "LD M0; BMOV D0 D1 K3; BMOV K1M10 D10 K2; BMOV D0 K1M30 K2", "M0=1 D0=1 D1=2 D2=3 M10=1 M15=1 > D1=1 D2=2 D3=3 D10=1 D11=2 M30=1 M34=1 M35=0"},
    {q, "LD M0; FMOV K7 D0 K3; DFMOV K65537 D10 K2", "M0=1 D3=9 > D0=7 D1=7 D2=7 D3=9 D10=1 D11=1 D12=1 D13=1 D14=0"},
    {fx3, "LD M0; ZRST D0 D2; ZRST M10 M12; ZRST T0 T1; ZRST C199 C200",
     "M0=1 D2=1 D3=1 M12=1 M13=1 TN1=5 TS1=1 TN2=5 CN199=1 CN200=2 HCN0=3 HCN1=4 > D2=0 D3=1 M12=0 M13=1 TN1=0 TS1=0 TN2=5 CN199=0 CN200=0 HCN0=0 HCN1=4"},
    {q, "LD M0; BKRST M10 K3", "M0=1 M12=1 M13=1 > M12=0 M13=1"},
    {fx3, "LD M0; $MOV \"ABC\" D0; $MOV D0 D10", "M0=1 D1=-1 > D0=16961 D1=67 D10=16961 D11=67"},
    // Arithmetic
    {q, "LD M0; + K5 D0; - K2 D1; + D0 K1 D2; - D0 K1 D3; D+ K65536 D4; D- D4 K1 D6", "M0=1 D0=32767 D1=1 > D0=-32764 D1=-1 D2=-32763 D3=32771 D4=0 D5=1 D6=-1 D7=0"},
    {q, "LD M0; * K300 K-300 D0; / K-7 K2 D2; D* K65536 K65536 D4; D/ K-70000 K30000 D8", "M0=1 > D0=-24464 D1=-2 D2=-3 D3=-1 D4=0 D5=0 D6=1 D7=0 D8=-2 D9=-1 D10=-10000 D11=-1"},
    {r, "LD M0; +_U K65535 D0; -_U K1 D1; *_U K65535 K65535 D2; /_U K65535 K10 D4; D+P_U HFFFFFFFF D6", "M0=1 D0=2 D1=0 D6=2 > D0=1 D1=-1 D2=1 D3=-2 D4=6553 D5=5 D6=1 D7=0"},
    {fx3, "LD M0; ADD D0 K2 D1; SUB D0 K2 D2; DADD D0 K1 D4; DSUB D8 K1 D8", "M0=1 D0=1 > D1=3 D2=-1 D4=2 D5=3 D8=-1 D9=-1"},
    {fx3, "LD M0; MUL K300 K300 D0; DIV K17 K5 D2; DMUL K100000 K100000 D4; DDIV K100000 K7 D8", "M0=1 > D0=24464 D1=1 D2=3 D3=2 D4=-7168 D5=21515 D6=2 D7=0 D8=14285 D9=0 D10=5 D11=0"},
    {fx3, "LD M0; INC D0; DEC D1; DINC D2; DDEC D4; INCP D6", "M0=1 D0=32767 D2=-1 D3=0 > D0=-32768 D1=-1 D2=0 D3=1 D4=-1 D5=-1 D6=1 / > D6=1"},
    {q, "LD M0; E+ E1.5 D0; E- E0.5 D2; E+ E1 E2 D4; E* E1.5 E2 D6; E/ E3 E2 D8", "M0=1 > D0=0 D1=16320 D2=0 D3=-16640 D4=0 D5=16448 D6=0 D7=16448 D8=0 D9=16320"},
    {r, "LD M0; ED+ E1.5 D0; ED- E1 E2.5 D4; ED* E1.5 E1 D8; ED/ E3 E2 D12", "M0=1 > D3=16376 D7=-16392 D11=16376 D15=16376"},
    {fx3, "LD M0; DEADD E1 E2 D4; DESUB E1 K2 D0; DEMUL E1.5 E2 D6; DEDIV E3 E2 D8", "M0=1 > D5=16448 D1=-16512 D7=16448 D9=16320"},
    // Logic, shift
    {q, "LD M0; WAND H0FF0 D0; WOR H1 D1; WXOR HFF D2; WXNR HFF D3; WAND D0 HF0 D4; DAND HFFFF D6; DOR H10000 D8; DXOR D6 D8 D10; DXNR D6 D8 D12",
     "M0=1 D0=4660 D1=2 D2=15 D3=15 D6=-1 D7=-1 > D0=560 D1=3 D2=240 D3=-241 D4=48 D6=-1 D7=0 D8=0 D9=1 D10=-1 D11=1 D12=0 D13=-2"},
    {fx3, "LD M0; WAND D0 HF0 D1; WOR D0 HF D2; WXOR D0 HFFFF D3; DAND D0 HFF D4; DOR D4 H10000 D6; DXOR D6 D4 D8", "M0=1 D0=4660 > D1=48 D2=4671 D3=-4661 D4=52 D5=0 D6=52 D7=1 D8=0 D9=1"},
    {q, "LD M0; ROR D0 K1; RCR D1 K1; ROL D2 K1; RCL D3 K1; DROR D4 K4; DROL D6 K4", "M0=1 SM700=0 D0=1 D1=0 D2=-32768 D3=1 D4=1 D6=0 D7=-32768 > D0=-32768 D1=-32768 D2=1 D3=3 D4=0 D5=4096 D6=8 D7=0 SM700=0"},
    {fx3, "LD M0; RORP D0 K1", "M0=1 D0=1 > D0=-32768 M8022=1 / > D0=-32768"},
    {q, "LD M0; SFR D0 K2; SFL D1 K3", "M0=1 D0=-1 D1=-1 > D0=16383 D1=-8 SM700=1"},
    {q, "LD M0; BSFR M10 K3; BSFL M20 K3", "M0=1 M12=1 M13=1 M20=1 M23=1 > M11=1 M12=0 M13=1 M20=0 M21=1 M23=1"},
    {q, "LD M0; DSFR D0 K3; DSFL D10 K3", "M0=1 D0=1 D1=2 D2=3 D3=4 D10=1 D11=2 D12=3 D13=4 > D0=2 D1=3 D2=0 D3=4 D10=0 D11=1 D12=2 D13=4"},
    {fx3, "LD M0; SFTR M10 M20 K4 K1; SFTL M10 M30 K4 K1; WSFR D0 D10 K3 K1; WSFL D0 D20 K3 K2",
     "M0=1 M10=1 M20=1 M21=1 M30=1 D0=8 D1=9 D10=1 D11=2 D12=3 D20=1 D21=2 D22=3 > M20=1 M21=0 M23=1 M30=1 M31=1 M32=0 D10=2 D11=3 D12=8 D20=8 D21=9 D22=1"},
    // Conversions
    {fx3, "LD M0; BCD D0 D1; BIN D1 D2; DBCD D4 D6; DBIN D6 D8", "M0=1 D0=1234 D4=24910 D5=188 > D1=4660 D2=1234 D6=22136 D7=4660 D8=24910 D9=188"},
    {q, "LD M0; FLT D0 D2; DFLT D4 D6; INT D2 D8; DINT E-70000.4 D10; INT E2.75 D12", "M0=1 D0=-3 D4=0 D5=1 > D2=0 D3=-16320 D6=0 D7=18304 D8=-3 D10=-4464 D11=-2 D12=3"},
    {fx3, "LD M0; FLT D0 D2; INT D2 D4; INT D6 D8", "M0=1 D0=7 D6=0 D7=-16336 > D3=16608 D4=7 D8=-2"},  // C0300000H: -2.75
    {r, "LD M0; INT2FLT D0 D2; DINT2FLT D4 D6; FLT2INT E2.75 D8; FLT2DINT E-70000.4 D10", "M0=1 D0=-3 D4=0 D5=1 > D3=-16320 D7=18304 D8=3 D10=-4464 D11=-2"},
    {fx3, "LD M0; CMP D0 K5 M10; ZCP K2 K4 D0 M20; DCMP D2 K-1 M30", "M0=1 D0=6 D2=-1 D3=-1 > M10=1 M11=0 M12=0 M20=0 M21=0 M22=1 M30=0 M31=1 M32=0 / D0=3 > M10=0 M12=1 M21=1 / D0=1 > M20=1 M21=0"},
    {q, "LDDT= D0 D3 H7; OUT M10; LDDT<> D0 D3 H7; OUT M11; LDDT> D0 D3 H7; OUT M12; LDDT<= D0 D3 H7; OUT M13; LDDT< D0 D3 H7; OUT M14; LDDT>= D0 D3 H7; OUT M15", "M0=1 M1=0 D0=2026 D1=11 D2=28 D3=2026 D4=11 D5=29 > M10=0 M11=1 M12=0 M13=1 M14=1 M15=0 / D2=29 > M10=1 M11=0 M12=0 M13=1 M14=0 M15=1"},
    {q, "LD M0; ANDDT= D0 D3 H7; OUT M10; LD M0; ANDDT<> D0 D3 H7; OUT M11; LD M0; ANDDT> D0 D3 H7; OUT M12; LD M0; ANDDT<= D0 D3 H7; OUT M13; LD M0; ANDDT< D0 D3 H7; OUT M14; LD M0; ANDDT>= D0 D3 H7; OUT M15", "M0=1 M1=0 D0=2026 D1=11 D2=28 D3=2026 D4=11 D5=29 > M10=0 M11=1 M12=0 M13=1 M14=1 M15=0 / D2=29 > M10=1 M11=0 M12=0 M13=1 M14=0 M15=1"},
    {q, "LD M1; ORDT= D0 D3 H7; OUT M10; LD M1; ORDT<> D0 D3 H7; OUT M11; LD M1; ORDT> D0 D3 H7; OUT M12; LD M1; ORDT<= D0 D3 H7; OUT M13; LD M1; ORDT< D0 D3 H7; OUT M14; LD M1; ORDT>= D0 D3 H7; OUT M15", "M0=1 M1=0 D0=2026 D1=11 D2=28 D3=2026 D4=11 D5=29 > M10=0 M11=1 M12=0 M13=1 M14=1 M15=0 / D2=29 > M10=1 M11=0 M12=0 M13=1 M14=0 M15=1"},
    {fx5, "LDTM= D0 D3 H7; OUT M10; LDTM<> D0 D3 H7; OUT M11; LDTM> D0 D3 H7; OUT M12; LDTM<= D0 D3 H7; OUT M13; LDTM< D0 D3 H7; OUT M14; LDTM>= D0 D3 H7; OUT M15", "M0=1 M1=0 D0=22 D1=5 D2=9 D3=22 D4=5 D5=10 > M10=0 M11=1 M12=0 M13=1 M14=1 M15=0 / D2=10 > M10=1 M11=0 M12=0 M13=1 M14=0 M15=1"},
    {fx5, "LD M0; ANDTM= D0 D3 H7; OUT M10; LD M0; ANDTM<> D0 D3 H7; OUT M11; LD M0; ANDTM> D0 D3 H7; OUT M12; LD M0; ANDTM<= D0 D3 H7; OUT M13; LD M0; ANDTM< D0 D3 H7; OUT M14; LD M0; ANDTM>= D0 D3 H7; OUT M15", "M0=1 M1=0 D0=22 D1=5 D2=9 D3=22 D4=5 D5=10 > M10=0 M11=1 M12=0 M13=1 M14=1 M15=0 / D2=10 > M10=1 M11=0 M12=0 M13=1 M14=0 M15=1"},
    {fx5, "LD M1; ORTM= D0 D3 H7; OUT M10; LD M1; ORTM<> D0 D3 H7; OUT M11; LD M1; ORTM> D0 D3 H7; OUT M12; LD M1; ORTM<= D0 D3 H7; OUT M13; LD M1; ORTM< D0 D3 H7; OUT M14; LD M1; ORTM>= D0 D3 H7; OUT M15", "M0=1 M1=0 D0=22 D1=5 D2=9 D3=22 D4=5 D5=10 > M10=0 M11=1 M12=0 M13=1 M14=1 M15=0 / D2=10 > M10=1 M11=0 M12=0 M13=1 M14=0 M15=1"},
    {r, "LDDT= D0 D3 H4; OUT M10; LDDT> D0 D3 H3; OUT M11; LDDT= D0 D3 H0; OUT M12; LDDT<> D0 D3 H8; OUT M13; LDTM< D6 D9 H1; OUT M14",
     "D0=2026 D1=11 D2=28 D3=2026 D4=10 D5=30 D6=1 D7=2 D8=3 D9=0 D10=0 D11=4 > M10=1 M11=1 M12=0 M13=0 M14=1 / D4=13 > M10=0 M11=0 / D4=11 > M11=0"},
    {r, "LDDT= D0 D9 H8007; OUT M10; LDTM> D3 D9 H8007; OUT M11; LDTM>= D3 D9 H8004; OUT M12",
     "SD210=2026 SD211=11 SD212=28 SD213=22 SD214=5 SD215=9 D0=2026 D1=11 D2=28 D3=22 D4=5 D5=8 > M10=1 M11=0 M12=1 / D5=10 > M11=1"},
    {fx5, "LDTM<= D0 D9 H8007; OUT M10", "SD8013=9 SD8014=5 SD8015=22 D0=22 D1=5 D2=9 > M10=1 / D2=10 > M10=0"},
    {fx3, "LD M0; SUM D0 D2; DSUM D4 D6; SUM K3M100 D8", "M0=1 D0=21847 D4=-1 D5=-1 D7=9 M100=1 M105=1 > D2=9 D6=32 D7=0 D8=2 M8020=0 / M100=0 M105=0 > D8=0 M8020=1"},  // 5557H
    {q, "LD M0; SUM D0 D2; DSUM D4 D6", "M0=1 D0=-1 D4=1 D5=-32768 D7=9 > D2=16 D6=2 D7=9"},
    {fx3, "LD M0; MEAN D0 D10 K3; DMEAN D4 D12 K2; MEAN D0 D14 K1", "M0=1 D0=7 D1=-2 D2=6 D4=-1 D5=-1 D6=-4 D7=-1 > D10=3 D12=-2 D13=-1 D14=7 / D2=-7 > D10=0 / D0=-7 > D10=-5"},
    {r, "LD M0; MEAN_U D0 D10 K2; DMEAN_U D0 D12 K1", "M0=1 D0=-1 D1=1 > D10=-32768 D12=-1 D13=1"},
    {q, "LD M0; LIMIT K-5 K10 D0 D1; DLIMIT K0 K70000 D2 D4", "M0=1 D0=3 D2=0 D3=2 > D1=3 D4=4464 D5=1 / D0=11 > D1=10 / D0=-6 D3=-1 > D1=-5 D4=0 D5=0"},
    {fx5, "LD M0; LIMIT_U K1 K65000 D0 D1", "M0=1 D0=-1 > D1=-536 / D0=0 > D1=1"},
    {fx3, "LD M0; SQR D0 D1; DSQR D2 D4; LIMIT K1 K5 D0 D6", "M0=1 D0=99 D2=-1 D3=32767 > D1=9 D4=-19196 D5=0 D6=5 / D0=100 > D1=10 / D0=0 > D1=0 D6=1"},  // 46340
    {fx3, "LD M0; MOV Z3 D0; MOV K9 Z4; DMOV D10 Z5; MOV V5 D2", "M0=1 Z3=7 D10=5 D11=6 > D0=7 Z4=9 Z5=5 D2=6"},  // Z is the CPU's
    {q, "LD M0; SQR D0 D2", "M0=1 D0=0 D1=16400 > D2=0 D3=16320"},  // 40100000H: 2.25, 3FC00000H: 1.5
    // Modules
    {q, "LD M0; FROM H0 K10 D0 K2; TO H0 K20 D0 K2; DFRO H0 K10 D4 K1; DTO H0 K30 D4 K1; MOV U0\\G10 D8; MOV K9 U0\\G40; LD U0\\G10.2; OUT M1",
     "M0=1 U0\\G10=5 U0\\G11=6 > D0=5 D1=6 D4=5 D5=6 U0\\G20=5 U0\\G21=6 U0\\G30=5 U0\\G31=6 D8=5 U0\\G40=9 M1=1"},
    {fx3, "LD M0; FROMP K0 K10 D0 K1; TOP K0 K20 K7 K2; DFROM K0 K10 K4M100 K1; DTO K0 K30 H12345678 K1; FROM K0 K10 K2M200 K1; TO K0 K50 K4M0 K1",
     "M0=1 U0\\G10=261 U0\\G11=1 > D0=261 U0\\G20=7 U0\\G21=7 M100=1 M102=1 M108=1 M116=1 U0\\G30=22136 U0\\G31=4660 M200=1 M202=1 M208=0 U0\\G50=1 / U0\\G10=0 > D0=261"},
    {q, "LD M0; RFS X20 K16; OUT M1", "M0=1 > M1=1"},
    {fx3, "LD M0; REF X0 K8; OUT M1", "M0=1 > M1=1"},
    // Clock: 2026-11-28, a Saturday, 22:05:09
    {fx3, "LD M0; TRD D0", "M0=1 D8013=9 D8014=5 D8015=22 D8016=28 D8017=11 D8018=26 D8019=6 > D0=26 D1=11 D2=28 D3=22 D4=5 D5=9 D6=6"},
    {fx5, "LD M0; TRDP D0", "M0=1 SD8013=9 SD8014=5 SD8015=22 SD8016=28 SD8017=11 SD8018=2026 SD8019=6 > D0=2026 D1=11 D2=28 D3=22 D4=5 D5=9 D6=6"},
    {q, "LD M0; DATERD D0", "M0=1 SD210=9745 SD211=10274 SD212=1289 SD213=8198 > D0=2026 D1=11 D2=28 D3=22 D4=5 D5=9 D6=6"},  // 2611H 2822H 0509H 2006H
    {r, "LD M0; DATERD D0", "M0=1 SD210=2026 SD211=11 SD212=28 SD213=22 SD214=5 SD215=9 SD216=6 > D0=2026 D1=11 D2=28 D3=22 D4=5 D5=9 D6=6"},
    {fx3, "LD M0; TCMP K10 K30 K50 D0 M10; TZCP D20 D23 D0 M20",
     "M0=1 D0=10 D1=30 D2=49 D20=10 D23=11 > M10=1 M11=0 M12=0 M20=0 M21=1 M22=0 / D2=50 > M10=0 M11=1 M12=0 / D2=51 > M10=0 M11=0 M12=1 / D0=9 > M10=1 M20=1 M21=0 / D0=11 D1=0 D2=1 > M21=0 M22=1"},
    {fx3, "LD M0; TADD D0 D3 D6; TSUB D3 D0 D10", "M0=1 D0=10 D1=30 D2=50 D3=20 D4=29 D5=10 > D6=7 D7=0 D8=0 D10=9 D11=58 D12=20 / D3=1 D4=0 D5=0 > D10=14 D11=29 D12=10"},
    {q, "LD M0; DATE+ D0 D3 D6; DATE- D3 D0 D10", "M0=1 D0=10 D1=30 D2=50 D3=20 D4=29 D5=10 > D6=7 D7=0 D8=0 D10=9 D11=58 D12=20"},
    {fx3, "LD M0; HTOS D0 D3; DHTOS D6 D10; STOH D3 D20; DSTOH D10 D30", "M0=1 D0=1 D1=2 D2=3 D6=23 D7=59 D8=59 > D3=3723 D10=20863 D11=1 D20=1 D21=2 D22=3 D30=23 D31=59 D32=59"},
    {q, "LD M0; SECOND D6 D10; HOUR D10 D30", "M0=1 D6=23 D7=59 D8=59 > D10=20863 D11=1 D30=23 D31=59 D32=59"},
};
// clang-format on

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = std::min(text.find(separator), text.size());
    parts.emplace_back(ascii::trim(text.substr(0, end)));
    if (end == text.size()) return parts;
    text.remove_prefix(end + 1);
  }
}

void set_all(ListPlc& plc, std::string_view settings) {
  for (const std::string_view each : ascii::words(settings)) {
    const std::size_t equals = each.find('=');
    plc.set(each.substr(0, equals), *ascii::parse_number<int>(each.substr(equals + 1)));
  }
}

TEST(ListInstructions, EachOne_DoesWhatTheManualHas) {
  for (const Case& each : cases) {
    SCOPED_TRACE(each.program);
    ListPlc plc(each.family, split(each.program, ';'));
    int scan = 0;
    for (const std::string& phase : split(each.scans, '/')) {
      SCOPED_TRACE("scan " + std::to_string(++scan));
      const std::size_t arrow = phase.find('>');
      set_all(plc, std::string_view(phase).substr(0, arrow));
      EXPECT_EQ(plc.run(), "");
      for (const std::string_view expected : ascii::words(std::string_view(phase).substr(arrow + 1))) {
        const std::size_t equals = expected.find('=');
        const auto value = static_cast<std::int16_t>(*ascii::parse_number<int>(expected.substr(equals + 1)));
        EXPECT_EQ(plc.word(expected.substr(0, equals)), value) << expected;
      }
    }
  }
}

/// Names that stand in a case above, and in the tests of timers and counters.
TEST(ListInstructions, EveryNameOfTheTable_IsExecutedInACase) {
  // STL, RET, RETSTL, EI, DI, IRET: structure_test.cpp; TWR, DATEWR: below.
  std::set<std::string> used = {"OUT", "END", "STL", "RET", "RETSTL", "EI", "DI", "IRET", "TWR", "DATEWR"};
  for (const Case& each : cases)
    for (const std::string& line : split(each.program, ';')) used.insert(line.substr(0, line.find(' ')));
  for (const instruction_list::Instruction& row : instruction_list::instructions()) {
    for (const std::string_view name : ascii::words(row.names)) {
      bool is_used = false;
      for (std::uint8_t forms = 0; forms <= row.forms; ++forms)
        is_used = is_used || ((forms & ~row.forms) == 0 &&
                              used.contains(instruction_list::form_of_name(row, name, forms)));
      EXPECT_TRUE(is_used) << name;
    }
  }
}

TEST(ListInstructions, Twr_SetsTheClockOfTheCpu) {
  using namespace std::chrono;
  const auto written = [](Family family, const std::string& name, std::vector<int> words) {
    ListPlc plc(family, {"LD M0", name + " D0"});
    plc.set("M0", 1);
    for (std::size_t i = 0; i < words.size(); ++i) plc.set("D" + std::to_string(i), words[i]);
    const std::string fault = plc.run();
    return std::pair(fault, plc.image.clock);
  };
  const auto at = [](int year) {
    return local_days(std::chrono::year(year) / November / 28) + hours(22) + minutes(5) + seconds(9);
  };
  EXPECT_EQ(written(Family::fx3, "TWR", {26, 11, 28, 22, 5, 9, 6}), std::pair(std::string(), at(2026)));
  EXPECT_EQ(written(Family::fx3, "TWR", {80, 11, 28, 22, 5, 9, 5}), std::pair(std::string(), at(1980)));
  EXPECT_EQ(written(Family::fx5, "TWRP", {2026, 11, 28, 22, 5, 9, 6}), std::pair(std::string(), at(2026)));
  EXPECT_EQ(written(Family::q, "DATEWR", {2026, 11, 28, 22, 5, 9, 6}), std::pair(std::string(), at(2026)));
  EXPECT_EQ(written(Family::iqr, "DATEWR", {2026, 2, 29, 0, 0, 0, 0}),
            std::pair(std::string("MAIN.csv:5:1: value 29 is outside of 1 to 28"), local_seconds()));
  EXPECT_EQ(written(Family::iqr, "DATEWR", {26, 2, 1, 0, 0, 0, 0}).first,
            "MAIN.csv:5:1: value 26 is outside of 1980 to 2079");
}

TEST(ListInstructions, Refresh_NamesThePoints) {
  ListPlc plc(Family::q, {"LD M0", "RFS X20 K16", "RFS Y30 K8"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_THAT(plc.image.refreshed, testing::ElementsAre(testing::Pair(0x20, 16), testing::Pair(0x30, 8)));
}

TEST(ListInstructions, ResultsBeyondAWord_KeepTheirLowestBits) {
  ListPlc plc(Family::q, {"LD SM400", "+ K1 D0"});
  plc.set("SM400", 1);
  plc.set("D0", 32767);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.word("D0"), -32768);
}

TEST(ListInstructions, Faults_NameTheLine) {
  const auto fault = [](Family family, std::vector<std::string> lines) {
    ListPlc plc(family, std::move(lines));
    plc.set(family == Family::fx3 ? "M8000" : "SM400", 1);
    plc.machine->set_watchdog(10'000);
    return plc.run();
  };
  EXPECT_EQ(fault(Family::q, {"LD SM400", "/ K1 D0 D2"}), "MAIN.csv:5:1: division by zero");
  EXPECT_EQ(fault(Family::q, {"LD SM400", "MOV K-1 Z0", "MOV D0Z0 D1"}),
            "MAIN.csv:7:1: D0Z0: the CPU or the module has no such device");
  EXPECT_EQ(fault(Family::q, {"LD SM400", "BCD K10000 D1"}),
            "MAIN.csv:5:1: value 10000 is outside of 0 to 9999");
  EXPECT_EQ(fault(Family::q, {"LD SM400", "BIN HA D1"}), "MAIN.csv:5:1: value 10 is outside of 0 to 9");
  EXPECT_EQ(fault(Family::fx3, {"LD M8000", "MEAN D0 D1 K65"}),
            "MAIN.csv:5:1: value 65 is outside of 1 to 64");
  EXPECT_EQ(fault(Family::fx3, {"LD M8000", "SQR K-1 D1"}),
            "MAIN.csv:5:1: value -1 is outside of 0 to 2147483647");
  EXPECT_EQ(fault(Family::q, {"LD SM400", "LIMIT K6 K5 D0 D1"}),
            "MAIN.csv:5:1: value 6 is outside of -2147483648 to 5");
  EXPECT_EQ(fault(Family::q, {"FOR K0", "NEXT"}), "MAIN.csv:4:1: value 0 is outside of 1 to 32767");
  EXPECT_EQ(fault(Family::q, {"LD SM400", "FROM H3 K0 D0 K1"}),
            "MAIN.csv:5:1: buffer memory: there is no module");
  EXPECT_EQ(fault(Family::q, {"LD SM400", "TO H0 K1000 K1 K1"}),
            "MAIN.csv:5:1: buffer memory: the CPU or the module has no such device");
  EXPECT_EQ(fault(Family::fx3, {"LD M8000", "FMOV K0 D0 K-1"}),
            "MAIN.csv:5:1: value -1 is outside of 0 to 32767");
  EXPECT_EQ(fault(Family::fx3, {"LD M8000", "BMOV D7999 D0 K2"}),
            "MAIN.csv:5:1: D7999: the CPU or the module has no such device");
  EXPECT_EQ(fault(Family::fx3, {"P0", "LD M8000", "CJ P0"}),
            "MAIN.csv:6:1: the scan takes too long: a loop may not end");
  EXPECT_EQ(fault(Family::q, {"P0", "JMP P0"}), "MAIN.csv:5:1: the scan takes too long: a loop may not end");
}

}  // namespace
}  // namespace canopus::instructions_test
