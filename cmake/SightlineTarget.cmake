# One place for what every target of the project has in common.
#
# sightline_library(NAME GLOB... [BATCH N] [ALONE FILE...])
#                                   a static library target sightline_NAME with the alias sightline::NAME.
# sightline_options(TARGET [UNCHECKED])
#                                   language level, warnings, floating-point contract, sanitizers. UNCHECKED: compiled
#                                   as if there were no sanitizers, and linked with them.
# sightline_optimise_less(TARGET)   for what calls the library and does little itself: compiled in less time.
# sightline_unity(TARGET [BATCH N] [ALONE FILE...])
#                                   where CMAKE_UNITY_BUILD is on (the presets release and sanitize): compiles N
#                                   sources together, or eight, which takes less than half of the time, for most
#                                   of it is spent on headers. Sources whose unnamed namespace repeats a name of
#                                   another one's, or of a header that others use, are compiled alone, once it is
#                                   said here: ALONE FILE...
#                                   More than eight at once are for what includes much; what is fast because the
#                                   compiler inlines well keeps its eight. The preset sanitize, which does not optimise
#                                   for speed, compiles 24 where N does not say otherwise.

find_program(SIGHTLINE_CCACHE ccache)
mark_as_advanced(SIGHTLINE_CCACHE)
if(SIGHTLINE_CCACHE AND PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${SIGHTLINE_CCACHE})
endif()

set(SIGHTLINE_SANITIZE_FLAGS "")
if(SIGHTLINE_SANITIZE)
  # AddressSanitizer sees the memory that a null or wrapped pointer touches, or one into a smaller object or another
  # class's. Without a check of each pointer beside that, programs take a quarter to a third less time. That pointers
  # are aligned is checked where bytes are read as objects: the readers of files are fuzzed with all checks.
  set(SIGHTLINE_SANITIZE_FLAGS -fsanitize=address,undefined
    -fno-sanitize=null,pointer-overflow,object-size,vptr,alignment)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # By default, GCC's runtime does not look for variables that are used after their function has returned. So no code
    # is compiled for that.
    list(APPEND SIGHTLINE_SANITIZE_FLAGS --param=asan-use-after-return=0)
  endif()
endif()

# Instruction sets of ARM and RISC-V for which Highway compiles nothing: their vectors have no fixed size, so they can
# be neither members nor captured nor in arrays. Machines that have such a set take the best one that is left, on ARM
# NEON.
set(SIGHTLINE_UNSIZED_TARGETS "HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV")

function(sightline_options target)
  cmake_parse_arguments(PARSE_ARGV 1 own "UNCHECKED" "" "")
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  # The same bits everywhere: no contraction to fused multiply-add, no fast-math. Both flags are always given, because a
  # program that has Sightline as a subdirectory may have -ffast-math or -Ofast in CMAKE_CXX_FLAGS.
  # Designated initialisers leave out the members that keep their defaults.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
    -Wno-missing-field-initializers -fno-fast-math -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # GCC 12 sees overlaps in std::string's own operator+ (its bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
    if(CMAKE_UNITY_BUILD)
      # An unnamed namespace in a source that another one includes looks like one in a header.
      target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
  endif()
  if(SIGHTLINE_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(SIGHTLINE_SANITIZE)
    target_link_options(${target} PRIVATE ${SIGHTLINE_SANITIZE_FLAGS})
  endif()
  if(SIGHTLINE_SANITIZE AND NOT own_UNCHECKED)
    # With -O1, GCC takes two and a half times as long to compile the runtime, and tests a quarter less to run.
    target_compile_options(${target} PRIVATE ${SIGHTLINE_SANITIZE_FLAGS} -fno-sanitize-recover=all
      -fno-omit-frame-pointer -UNDEBUG -Og -g1)
    # Vector code is compiled without SSSE3 and SSE4: their vectors are as long as those of SSE2, so that they touch the
    # same memory, and the release tests force every instruction set, so that no test is lost. Nor is one by the sets
    # without a fixed size, for which nothing is compiled in any build.
    target_compile_definitions(${target} PRIVATE
      "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_SSE4|${SIGHTLINE_UNSIZED_TARGETS})")
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
      # GCC's warnings about uninitialised values are unreliable in instrumented code.
      target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
    endif()
  elseif(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "86|AMD64")
    # The vector code does not compile for these sets (above). No test is left out: all run on each set that is left.
    target_compile_definitions(${target} PRIVATE "HWY_DISABLED_TARGETS=(${SIGHTLINE_UNSIZED_TARGETS})")
  endif()
endfunction()

function(sightline_optimise_less target)
  # First, so that what sightline_options() says takes precedence.
  target_compile_options(${target} BEFORE PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

function(sightline_unity target)
  cmake_parse_arguments(PARSE_ARGV 1 own "" "BATCH" "ALONE")
  if(own_BATCH)
    set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE ${own_BATCH})
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    # Highway compiles such a file once for each instruction set, by including it again and again.
    file(STRINGS ${source} again REGEX "hwy/foreach_target.h")
    if(again)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
  set_source_files_properties(${own_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  # A unity source includes sources on purpose, of which clang-tidy would warn for each.
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD_CODE_BEFORE_INCLUDE "// NOLINTNEXTLINE(bugprone-suspicious-include)")
endfunction()

function(sightline_library name)
  cmake_parse_arguments(PARSE_ARGV 1 own "" "BATCH" "ALONE")
  file(GLOB sources CONFIGURE_DEPENDS ${own_UNPARSED_ARGUMENTS})
  add_library(sightline_${name} STATIC ${sources})
  list(TRANSFORM own_ALONE PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  sightline_unity(sightline_${name} BATCH ${own_BATCH} ALONE ${own_ALONE})
  add_library(sightline::${name} ALIAS sightline_${name})
  set_target_properties(sightline_${name} PROPERTIES EXPORT_NAME ${name})
  sightline_options(sightline_${name})
endfunction()
