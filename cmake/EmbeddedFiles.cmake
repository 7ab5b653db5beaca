# cmake -D FOLDER=... -D PATTERNS=... -D HEADER=... -D NAMESPACE=... -D TYPE=... -D FUNCTION=... -D OUTPUT=... -P EmbeddedFiles.cmake:
# writes the files of a folder that match the patterns (separated by commas) as the source file OUTPUT. HEADER declares TYPE (path and
# content) and FUNCTION, which returns them.
string(REPLACE "," ";" patterns "${PATTERNS}")
list(TRANSFORM patterns PREPEND "${FOLDER}/")
file(GLOB files RELATIVE ${FOLDER} ${patterns})
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
file(WRITE ${OUTPUT}.new "#include \"${HEADER}\"

namespace ${NAMESPACE} {
namespace {
${arrays}const ${TYPE} table_of_${FUNCTION}[] = {
${rows}};
}  // namespace

std::span<const ${TYPE}> ${FUNCTION}() noexcept { return table_of_${FUNCTION}; }

}  // namespace ${NAMESPACE}
")
file(COPY_FILE ${OUTPUT}.new ${OUTPUT})
file(REMOVE ${OUTPUT}.new)
