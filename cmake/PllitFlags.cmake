# Compile flags shared by every target, as the interface library pllit_flags.
add_library(pllit_flags INTERFACE)
target_compile_options(pllit_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror)
target_include_directories(pllit_flags INTERFACE ${CMAKE_SOURCE_DIR}/src)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(pllit_flags INTERFACE -fpch-preprocess) # lets ccache see through the precompiled header
  # g++ 14 sees past the end of Eigen's vectors of three where its vectorised code does not go.
  target_compile_options(pllit_flags INTERFACE -Wno-array-bounds -Wno-maybe-uninitialized -Wno-stringop-overflow)
endif()
# Debian's GTSAM and OpenCV are built for baseline x86-64; with AVX Eigen would align its types differently across the border.
target_compile_definitions(pllit_flags INTERFACE EIGEN_MAX_ALIGN_BYTES=16)

set(arch ${PLLIT_ARCH})
if(arch STREQUAL "auto")
  set(arch "")
  include(CheckCXXSourceRuns)
  check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"x86-64-v3\") ? 0 : 1; }" PLLIT_HAS_X86_64_V3)
  if(PLLIT_HAS_X86_64_V3)
    set(arch "x86-64-v3")
  endif()
endif()
if(arch)
  target_compile_options(pllit_flags INTERFACE -march=${arch})
endif()

if(PLLIT_SANITIZE)
  set(sanitizers -fsanitize=address,undefined -fno-sanitize-recover=all)
  # With assertions, also those of Eigen and of the standard library.
  target_compile_options(pllit_flags INTERFACE ${sanitizers} -fno-omit-frame-pointer -O1 -g1)
  target_compile_definitions(pllit_flags INTERFACE _GLIBCXX_ASSERTIONS)
  target_link_options(pllit_flags INTERFACE ${sanitizers})
endif()
# -O2 runs as fast as -O3 here and compiles in half the time.
string(REPLACE "-O3" "-O2" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
  target_compile_options(pllit_flags INTERFACE -Og -g)
endif()
