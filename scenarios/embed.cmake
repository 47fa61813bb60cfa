# Writes scenarios/*.toml, the files that they name (*.msh, *.csv, *.png), the template of `knap new` and the examples of
# `knap schema --markdown` into one C++ file, so that the program needs no other file.
function(knap_embed_pictures pattern result)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/scenarios/${pattern})
  set(table "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(name ${file} NAME)
    file(READ ${file} bytes HEX)
    string(REGEX REPLACE "(..)" "\\\\x\\1" bytes ${bytes})
    string(APPEND table "        {\"${name}\", \"${bytes}\"s},\n")
  endforeach()
  set(${result} "${table}" PARENT_SCOPE)
endfunction()

function(knap_embed_table pattern with_ending result)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/scenarios/${pattern})
  set(table "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    if(with_ending)
      get_filename_component(name ${file} NAME)
    else()
      get_filename_component(name ${file} NAME_WE)
    endif()
    file(READ ${file} text)
    string(APPEND table "        {\"${name}\", R\"knap_file(${text})knap_file\"},\n")
  endforeach()
  set(${result} "${table}" PARENT_SCOPE)
endfunction()

function(knap_embed_scenarios output)
  knap_embed_table(*.toml FALSE scenarios)
  knap_embed_table(*.msh TRUE files)
  knap_embed_table(*.csv TRUE tables)
  knap_embed_pictures(*.png pictures)
  foreach(name new_scenario block_examples)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/scenario/${name}.toml)
    file(READ ${CMAKE_SOURCE_DIR}/src/scenario/${name}.toml ${name})
  endforeach()
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT
"// Generated from scenarios/*.toml, scenarios/*.msh, scenarios/*.csv and scenarios/*.png.
#include \"scenario/built_in.hpp\"

namespace knap {

using namespace std::string_literals;  // bytes of a picture may be 0

const std::vector<BuiltIn>& built_ins() {
    static const std::vector<BuiltIn> all{
@scenarios@    };
    return all;
}

const std::vector<BuiltIn>& built_in_files() {
    static const std::vector<BuiltIn> all{
@files@@tables@@pictures@    };
    return all;
}

const std::string& scenario_template() {
    static const std::string text = R\"knap_file(@new_scenario@)knap_file\";
    return text;
}

const std::string& block_examples() {
    static const std::string text = R\"knap_file(@block_examples@)knap_file\";
    return text;
}

}  // namespace knap
")
endfunction()
