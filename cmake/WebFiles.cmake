# cmake -D FOLDER=... -D OUTPUT=... -P WebFiles.cmake: writes the files of the page in FOLDER as the source file OUTPUT
# (canopus/web/http/files.hpp).
set(type_html "text/html; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_svg "image/svg+xml")

file(GLOB files RELATIVE ${FOLDER} ${FOLDER}/*.html ${FOLDER}/*.css ${FOLDER}/*.js ${FOLDER}/*.svg)
set(arrays "")
set(rows "")
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} content HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${content}")
  string(REPEAT "0x..," 20 row)
  string(REGEX REPLACE "(${row})" "\\1\n" bytes "${bytes}")
  string(MAKE_C_IDENTIFIER "file_${file}" name)
  get_filename_component(ending ${file} LAST_EXT)
  string(SUBSTRING ${ending} 1 -1 ending)
  string(APPEND arrays "constexpr unsigned char ${name}[] = {${bytes}0};\n")
  string(APPEND rows "    {\"/${file}\", \"${type_${ending}}\", "
         "{reinterpret_cast<const char*>(${name}), sizeof(${name}) - 1}},\n")
endforeach()
file(WRITE ${OUTPUT}.new "#include \"canopus/web/http/files.hpp\"

namespace canopus::web {
namespace {
${arrays}const WebFile web_files[] = {
${rows}};
}  // namespace

const WebFile* find_web_file(std::string_view path) noexcept {
  for (const WebFile& file : web_files) {
    if (file.path == path) return &file;
  }
  return nullptr;
}

}  // namespace canopus::web
")
file(COPY_FILE ${OUTPUT}.new ${OUTPUT})
file(REMOVE ${OUTPUT}.new)
