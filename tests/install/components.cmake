# Installs the runtime and the look-up under a fresh prefix, and asks find_package for components that are there and
# for some that are not.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${WORK})
foreach(component runtime pvs)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --component ${component}
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()

# configure(REQUIRED OPTIONAL ARGUMENT...): sets `result`, and `output` with single spaces for line breaks.
function(configure required optional)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR}
      -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_PREFIX_PATH=${WORK}/prefix -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
      -D CMAKE_DISABLE_FIND_PACKAGE_zstd=OFF "-DREQUIRED_ONES=${required}" "-DOPTIONAL_ONES=${optional}" ${ARGN}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  set(result "${result}" PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_success)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "find_package failed:\n${output}")
  endif()
endfunction()

function(expect_failure text)
  string(FIND "${output}" "${text}" at)
  if(result EQUAL 0 OR at EQUAL -1)
    message(FATAL_ERROR "expected a failure that says\n${text}\nand got ${result}:\n${output}")
  endif()
endfunction()

function(expect_targets)
  foreach(component runtime pvs layers)
    string(FIND "${output}" "has ${component}" at)
    if((component IN_LIST ARGV AND at EQUAL -1) OR (NOT component IN_LIST ARGV AND NOT at EQUAL -1))
      message(FATAL_ERROR "expected the targets ${ARGV}:\n${output}")
    endif()
  endforeach()
endfunction()

configure("runtime;pvs" "")
expect_success()
expect_targets(runtime pvs)

configure("pvs;layers" "")
expect_failure("sightline: component 'layers' is not installed: build Sightline with -D SIGHTLINE_LAYERS=ON")

configure("nosuch" "")
expect_failure("sightline: there is no component 'nosuch'; there are runtime, pvs, layers")

# Both are named, not the first alone.
configure("nosuch;layers" "")
expect_failure("sightline: there is no component 'nosuch'")
expect_failure("sightline: component 'layers' is not installed")

configure("" "pvs;layers;nosuch")
expect_success()
expect_targets(runtime pvs)

# What a component needs is missing: that is an error only where the component is required.
configure("pvs" "" -D CMAKE_DISABLE_FIND_PACKAGE_zstd=ON)
expect_failure("sightline: component 'pvs' needs zstd, which was not found")
configure("" "pvs" -D CMAKE_DISABLE_FIND_PACKAGE_zstd=ON)
expect_success()
expect_targets(runtime)
