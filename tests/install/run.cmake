# Installs the runtime, the look-up and the sort under a fresh prefix, builds the consumer against them, runs it.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\n${output}\nended with ${result}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK}/prefix ${WORK}/consumer)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --component runtime)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --component pvs)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --component layers)

# The package alone is looked at: neither a package registry nor the build folder may help.
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/install/consumer -B ${WORK}/consumer -G ${GENERATOR}
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
  -D CMAKE_PREFIX_PATH=${WORK}/prefix -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
  -D EXAMPLES=${SOURCE}/examples)
run(${CMAKE_COMMAND} --build ${WORK}/consumer)
run(${WORK}/consumer/consumer)
if(NOT output STREQUAL "visible: 0\nvisible: 5\n")
  message(FATAL_ERROR "the consumer printed:\n${output}")
endif()

run(${WORK}/consumer/partial_settings)

run(${WORK}/consumer/sort_layers)
if(NOT output STREQUAL "1 \n0 \n2 3 \n" AND NOT output STREQUAL "1 \n2 3 \n0 \n" AND NOT output STREQUAL "2 3 \n1 \n0 \n")
  message(FATAL_ERROR "the order printed:\n${output}")
endif()

if(TOOL)
  run(${TOOL} bake demo:building?floors=1 -o ${WORK}/building.sight --depth 2)
  run(${WORK}/consumer/look_up ${WORK}/building.sight 5 1.7 -5)
  if(NOT output MATCHES "^[0-9]+ of [0-9]+ objects may be seen from there\n[0-9]+ of them in this view\n$")
    message(FATAL_ERROR "the look-up printed:\n${output}")
  endif()
endif()

# The tool, with its manual and its completion, in a place of its own.
if(TOOL)
  file(REMOVE_RECURSE ${WORK}/tool)
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/tool --component tool)
  run(${WORK}/tool/bin/sightline version)
  foreach(file share/man/man1/sightline.1 share/bash-completion/completions/sightline)
    if(NOT EXISTS ${WORK}/tool/${file})
      message(FATAL_ERROR "the component tool lacks ${file}")
    endif()
  endforeach()
endif()

# The tool's own libraries stay at home.
foreach(room io render pvs/bake)
  if(EXISTS ${WORK}/prefix/include/sightline/${room})
    message(FATAL_ERROR "headers of ${room} were installed with the runtime")
  endif()
endforeach()
