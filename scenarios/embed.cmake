# Writes scenarios/*.toml into one C++ file, so that the program knows them by name from any directory.
function(knap_embed_scenarios output)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/scenarios/*.toml)
  set(table "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(name ${file} NAME_WE)
    file(READ ${file} text)
    string(APPEND table "        {\"${name}\", R\"toml(${text})toml\"},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT
"// Generated from scenarios/*.toml.
#include \"scenario/built_in.hpp\"

namespace knap {

const std::vector<BuiltIn>& built_ins() {
    static const std::vector<BuiltIn> all{
@table@    };
    return all;
}

}  // namespace knap
")
endfunction()
