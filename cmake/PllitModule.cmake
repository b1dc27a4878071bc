# One precompiled header for the house and one for its tests: Eigen and manif are slow to compile and in nearly every file.
function(pllit_precompiled_header name)
  file(WRITE ${CMAKE_BINARY_DIR}/${name}.cpp "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE pllit_flags Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

# Sources in batches of eight: what they include is read, and instantiated, once a batch. A whole build takes a third of the time.
function(pllit_in_batches target)
  if(PLLIT_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -Wno-subobject-linkage) # a batch is no header
    endif()
  endif()
endfunction()

# pllit_module(NAME [FUZZED] SOURCES a.cpp ... DEPENDS base ... LINK lib ...)
#   one folder of the house: the static library pllit_NAME with the alias pllit::NAME
#   FUZZED: a fuzz target runs it; under the sanitizers it counts the branches taken
function(pllit_module name)
  cmake_parse_arguments(arg "FUZZED" "" "SOURCES;DEPENDS;LINK" ${ARGN})
  add_library(pllit_${name} STATIC ${arg_SOURCES})
  add_library(pllit::${name} ALIAS pllit_${name})
  list(TRANSFORM arg_DEPENDS PREPEND pllit::)
  target_link_libraries(pllit_${name} PUBLIC pllit_flags Eigen3::Eigen ${arg_DEPENDS} ${arg_LINK})
  target_precompile_headers(pllit_${name} REUSE_FROM pllit_pch)
  pllit_in_batches(pllit_${name})
  if(arg_FUZZED AND PLLIT_SANITIZE)
    # What -fsanitize=fuzzer-no-link asks for, but compatible with the common precompiled header.
    target_compile_options(pllit_${name} PRIVATE -fsanitize-coverage=inline-8bit-counters,pc-table,trace-cmp)
  endif()
endfunction()

# pllit_test(NAME [WHOLE] SOURCES ... LINK ... [LABELS slow])   one GoogleTest executable, each test its own CTest entry
#   WHOLE: all of them one entry, where tests share what takes long to make
function(pllit_test name)
  cmake_parse_arguments(arg "WHOLE" "" "SOURCES;LINK;LABELS" ${ARGN})
  if("slow" IN_LIST arg_LABELS AND NOT PLLIT_SLOW_TESTS)
    return()
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LINK} pllit_flags Eigen3::Eigen GTest::gtest GTest::gmock GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests)
  target_precompile_headers(${name} REUSE_FROM pllit_test_pch)
  if(arg_WHOLE)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 400 LABELS "${arg_LABELS}")
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 400 LABELS "${arg_LABELS}")
endfunction()
