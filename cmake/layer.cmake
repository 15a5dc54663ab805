# turnlight_flags(TARGET): the house's warnings and floating-point rules, and the chosen sanitizers.
function(turnlight_flags target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Werror
    # g++ 12 sees overlapping copies in operator+(const char*, std::string&&): GCC bug 105651.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    # The same bits on every machine: no contraction to fused multiply-add behind our back.
    -ffp-contract=off)
  if(TURNLIGHT_SANITIZE)
    target_compile_options(${target} PRIVATE
      -fsanitize=${TURNLIGHT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PRIVATE -fsanitize=${TURNLIGHT_SANITIZE})
  endif()
  if(TURNLIGHT_FUZZERS)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# turnlight_layer(NAME SOURCES ... USES ...): one folder's library. A function used from a layer that
# is not in USES fails at the link; scripts/check-layers refuses the include already.
# A layer whose folder matches TURNLIGHT_PLAIN is not compiled but taken from build/release.
function(turnlight_layer name)
  cmake_parse_arguments(LAYER "" "" "SOURCES;USES" ${ARGN})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(TURNLIGHT_PLAIN AND folder MATCHES "${TURNLIGHT_PLAIN}")
    add_library(${name} INTERFACE)
    target_include_directories(${name} INTERFACE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${name} INTERFACE
      ${PROJECT_SOURCE_DIR}/build/release/${folder}/lib${name}.a ${LAYER_USES})
    return()
  endif()
  add_library(${name} STATIC ${LAYER_SOURCES})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${LAYER_USES})
  turnlight_flags(${name})
endfunction()
