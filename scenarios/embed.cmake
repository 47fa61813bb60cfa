# Writes scenarios/*.toml, the files that they name (*.msh) and the template of `knap new` into one C++ file, so that the program knows them by name from any directory.
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
  set(template ${CMAKE_SOURCE_DIR}/src/scenario/new_scenario.toml)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${template})
  file(READ ${template} template)
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT
"// Generated from scenarios/*.toml and scenarios/*.msh.
#include \"scenario/built_in.hpp\"

namespace knap {

const std::vector<BuiltIn>& built_ins() {
    static const std::vector<BuiltIn> all{
@scenarios@    };
    return all;
}

const std::vector<BuiltIn>& built_in_files() {
    static const std::vector<BuiltIn> all{
@files@    };
    return all;
}

const std::string& scenario_template() {
    static const std::string text = R\"knap_file(@template@)knap_file\";
    return text;
}

}  // namespace knap
")
endfunction()
