# Writes config/*.yaml into config_presets_data.cpp, so that the presets travel with the program.
function(pllit_embed_presets output)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/config/*.yaml)
  set(entries "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(name ${file} NAME_WE)
    file(READ ${file} yaml)
    string(APPEND entries "    Preset{\"${name}\", R\"yaml(${yaml})yaml\"},\n")
  endforeach()
  set(code "// Generated from config/*.yaml.\n#include \"pllit/slam/config_presets.hpp\"\n\nnamespace pllit {\n\n"
           "std::span<const Preset> presets() {\n  static constexpr Preset kPresets[] = {\n${entries}  }\;\n  return kPresets\;\n}\n\n"
           "}  // namespace pllit\n")
  string(CONCAT code ${code})
  file(CONFIGURE OUTPUT ${output} CONTENT "@code@" @ONLY)
endfunction()
