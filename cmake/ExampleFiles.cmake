# cmake -D FOLDER=... -D OUTPUT=... -P ExampleFiles.cmake: writes the first plant and its device files as the source file OUTPUT
# (canopus/web/commands/example_files.hpp).
file(GLOB files RELATIVE ${FOLDER} ${FOLDER}/first-plant/plant.toml ${FOLDER}/devices/*.eds)
set(arrays "")
set(rows "")
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} content HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${content}")
  string(REPEAT "0x..," 20 row)
  string(REGEX REPLACE "(${row})" "\\1\n" bytes "${bytes}")
  string(MAKE_C_IDENTIFIER "file_${file}" name)
  string(APPEND arrays "constexpr unsigned char ${name}[] = {${bytes}0};\n")
  string(APPEND rows "    {\"${file}\", {reinterpret_cast<const char*>(${name}), sizeof(${name}) - 1}},\n")
endforeach()
file(WRITE ${OUTPUT}.new "#include \"canopus/web/commands/example_files.hpp\"

namespace canopus::web {
namespace {
${arrays}const ExampleFile example_file_table[] = {
${rows}};
}  // namespace

std::span<const ExampleFile> example_files() noexcept { return example_file_table; }

}  // namespace canopus::web
")
file(COPY_FILE ${OUTPUT}.new ${OUTPUT})
file(REMOVE ${OUTPUT}.new)
