#pragma once
// The application process of an XDD [CiA 311]: the attributes that its parameters give to the objects that
// refer to them.

#include <string_view>
#include <unordered_map>

#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/eds/ini.hpp"
#include "canopus/eds/xml/document.hpp"

namespace canopus::eds {

/// Adds Key=value with the place of `given`, but not a key that the section has already.
void add_item(Section& section, const xml::Document& document, std::string_view key,
              pugi::xml_attribute given, std::string_view value);
/// The same with the text of an element.
void add_item(Section& section, const xml::Document& document, std::string_view key, pugi::xml_node given);

/// The type of IEC 61131-3 of the same width; BITSTRING where there is none.
[[nodiscard]] std::string_view simple_type_word(canopen::DataType type) noexcept;

class XddParameters {
 public:
  /// `process`: ApplicationProcess, or an empty element.
  XddParameters(const xml::Document& document, pugi::xml_node process, Problems& problems);

  /// Keys and values of a parameter as CiA 306 has them, those of its template included, or nullptr: there is
  /// none of this uniqueID. Each is read once, independent of the number of objects that refer to it.
  [[nodiscard]] const Section* find(std::string_view id);

 private:
  struct Type {  // a simple one, or a reference to another one
    std::string_view word;
    std::string_view data_type;
    std::string_view reference;
    xml::Position position;
  };
  struct Parameter {
    pugi::xml_node element;
    bool is_read = false;
    Section facts{};
  };
  using Parameters = std::unordered_map<std::string_view, Parameter>;

  [[nodiscard]] Type type_in(pugi::xml_node holder) const;
  [[nodiscard]] const Section* find(Parameters& parameters, std::string_view id) const;
  void read(Parameter& parameter) const;
  void add_type(Section& facts, pugi::xml_node parameter) const;

  const xml::Document& document_;
  Problems& problems_;
  std::unordered_map<std::string_view, Type> types_;
  Parameters parameters_;
  mutable Parameters templates_;
};

}  // namespace canopus::eds
