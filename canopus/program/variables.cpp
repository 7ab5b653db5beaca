#include "canopus/program/variables.hpp"

namespace canopus::program {

namespace {

struct Walk {
  const std::function<bool(const SingleVariable&)>& each;
  std::string name{};

  bool go(const DataType& type, std::uint32_t place, bool is_constant, bool is_retained,
          const std::string& comment) {
    switch (type.form) {
      case DataType::Form::elementary:
      case DataType::Form::enumeration:
      case DataType::Form::subrange: return each({name, type, place, is_constant, is_retained, comment});
      case DataType::Form::array: {
        const std::size_t length = name.size();
        for (std::int64_t index = type.low; index <= type.high; ++index) {
          name += '[' + std::to_string(index) + ']';
          if (!go(*type.element, place, is_constant, is_retained, comment)) return false;
          name.resize(length);
          place += type.element->slots;
        }
        return true;
      }
      case DataType::Form::structure:
      case DataType::Form::block: break;
    }
    const std::size_t length = name.size();
    for (const Member& member : type.members) {
      if (member.kind == MemberKind::in_out || member.kind == MemberKind::temporary ||
          member.kind == MemberKind::hidden)
        continue;
      name += '.' + member.name;
      if (!go(*member.type, place + member.offset, is_constant || member.is_constant,
              is_retained || member.is_retained, member.comment.empty() ? comment : member.comment))
        return false;
      name.resize(length);
    }
    return true;
  }
};

}  // namespace

void for_each_variable(const Program& program, const std::function<bool(const SingleVariable&)>& each) {
  Walk walk{each};
  for (const Symbol& symbol : program.symbols) {
    walk.name = symbol.name;
    if (!walk.go(*symbol.type, symbol.place, symbol.is_constant, symbol.is_retained, symbol.comment)) return;
  }
}

}  // namespace canopus::program
