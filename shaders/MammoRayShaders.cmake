# Compiles GLSL to a header with the SPIR-V words in an array, rebuilt when an included file changes.
#
#   mammoray_compile_shader(<list> SOURCE <file> VARIABLE <name> [DEFINES <name=value>...])
#
# Appends the header's path, <build>/<name>.h, to <list>; it defines `const uint32_t <name>[]`.
set(MAMMORAY_SHADER_DIR "${CMAKE_CURRENT_LIST_DIR}")
find_program(MAMMORAY_GLSLANG_VALIDATOR glslangValidator REQUIRED
  DOC "The Khronos GLSL compiler (Debian: glslang-tools)")

function (mammoray_compile_shader headers)
  cmake_parse_arguments(PARSE_ARGV 1 shader "" "SOURCE;VARIABLE" "DEFINES")
  set(source "${MAMMORAY_SHADER_DIR}/${shader_SOURCE}")
  set(header "${CMAKE_CURRENT_BINARY_DIR}/${shader_VARIABLE}.h")
  list(TRANSFORM shader_DEFINES PREPEND "-D")
  add_custom_command(
    OUTPUT "${header}"
    COMMAND "${MAMMORAY_GLSLANG_VALIDATOR}" --quiet --target-env vulkan1.2
      "-I${MAMMORAY_SHADER_DIR}/include" ${shader_DEFINES}
      --vn ${shader_VARIABLE} --depfile "${header}.d" -o "${header}" "${source}"
    MAIN_DEPENDENCY "${source}"
    DEPFILE "${header}.d"
    COMMENT "Compiling ${shader_SOURCE} (${shader_VARIABLE})"
    VERBATIM)
  list(APPEND ${headers} "${header}")
  set(${headers} "${${headers}}" PARENT_SCOPE)
endfunction ()
