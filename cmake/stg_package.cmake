# Functions that all packages of this repository use, with catkin and without. Call them on targets
# that CMake's own commands made. STG_CORE_ONLY is set in a build of the cores alone. Such a build
# starts at the CMakeLists.txt of the repository and needs neither catkin nor ROS.
include_guard(DIRECTORY)
include(${CMAKE_CURRENT_LIST_DIR}/stg_flags.cmake)
# Only the file VERSION defines the version. `./stg lint versions` compares the other files that
# state it.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../VERSION STG_VERSION)

option(STG_UNITY "Compile sixteen sources of a target at a time, which halves the time of a build" ON)

# stg_unity(TARGET): compiles several sources as one. So the names in their anonymous namespaces must
# differ.
function(stg_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${STG_UNITY} UNITY_BUILD_BATCH_SIZE 16)
endfunction()

# stg_optimise(TARGET OPTION): compiles with -O1 or -O2 instead of -O3, where the time of the build
# matters more than the speed of the program.
function(stg_optimise target option)
  if(NOT STG_SANITIZE)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${option}>)
  endif()
endfunction()

# stg_shared_version(TARGET): sets the version of a shared library. Its soname contains major and
# minor version, because headers and libraries of different minor versions do not fit.
function(stg_shared_version target)
  string(REGEX MATCH "^[0-9]+\\.[0-9]+" minor ${STG_VERSION})
  set_target_properties(${target} PROPERTIES VERSION ${STG_VERSION} SOVERSION ${minor})
endfunction()

# stg_use(TARGET PUBLIC|PRIVATE [PACKAGE ...]): compiles and links a target with the cores of other
# packages.
function(stg_use target scope)
  foreach(package IN LISTS ARGN)
    if(TARGET ${package})
      target_link_libraries(${target} ${scope} ${package})
    else()
      # catkin found the package, which was built on its own (catkin_make_isolated, Debian's dh-ros).
      target_include_directories(${target} SYSTEM ${scope} ${${package}_INCLUDE_DIRS})
      target_link_libraries(${target} ${scope} ${${package}_LIBRARIES})
    endif()
  endforeach()
endfunction()

# stg_core_sources(RESULT): finds the sources of a core, which are all below src/, except those of nodes
# and command-line programs. The next build finds a new file by itself.
function(stg_core_sources result)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} src/*.cpp)
  list(FILTER sources EXCLUDE REGEX "^src/(command_line|nodes|tools)/")
  set(${result} ${sources} PARENT_SCOPE)
endfunction()

# stg_core_library(TARGET [PACKAGE ...]): sets up a library of a core that uses the cores of other
# packages. Plain CMake adds it to the export set STG_EXPORT.
set(STG_EXPORT stgTargets)
function(stg_core_library target)
  add_library(stg::${target} ALIAS ${target})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>
  )
  target_link_libraries(${target} PUBLIC stg_abi)
  stg_use(${target} PUBLIC ${ARGN})
  stg_unity(${target})
  stg_shared_version(${target})
  if(STG_CORE_ONLY)
    add_dependencies(stg_cores ${target})
    install(TARGETS ${target} EXPORT ${STG_EXPORT})
    install(DIRECTORY include/ DESTINATION include FILES_MATCHING PATTERN "*.hpp")
  endif()
endfunction()

# stg_core_tool(TARGET NAME): sets up a command-line program of a core and calls it NAME.
function(stg_core_tool target name)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name})
  stg_use(${target} PRIVATE auv_common)
  if(TARGET auv_common_command_line)
    target_link_libraries(${target} PRIVATE auv_common_command_line)
  endif()
  stg_optimise(${target} -O1)
endfunction()

# stg_test(TARGET SOURCES FILE ... LIBRARIES LIBRARY ... [DEFINITIONS DEFINITION ...]
# [INCLUDE_DIRECTORIES FOLDER ...] [PROGRAMS TARGET ...]): makes one program of GoogleTests. It may
# start the PROGRAMS, so they are built before it. `./stg test PATTERN` finds it by its name and by the
# names of its files.
function(stg_test target)
  cmake_parse_arguments(
    ARG "" "" "SOURCES;LIBRARIES;DEFINITIONS;INCLUDE_DIRECTORIES;PROGRAMS" ${ARGN}
  )
  set(test _ctest_${PROJECT_NAME}_gtest_${target})
  if(STG_CORE_ONLY)
    if(NOT STG_TESTS)
      return()
    endif()
    set(results ${CMAKE_BINARY_DIR}/test_results/${PROJECT_NAME}/gtest-${target}.xml)
    add_executable(${target} EXCLUDE_FROM_ALL ${ARG_SOURCES})
    target_link_libraries(${target} GTest::gtest)
    add_test(NAME ${test} COMMAND ${target} --gtest_output=xml:${results})
    add_dependencies(tests ${target})
  elseif(CATKIN_ENABLE_TESTING)
    catkin_add_gtest(${target} ${ARG_SOURCES})
  else()
    return()
  endif()
  target_link_libraries(${target} ${ARG_LIBRARIES} GTest::gtest_main)
  target_compile_definitions(${target} PRIVATE ${ARG_DEFINITIONS})
  target_include_directories(${target} PRIVATE ${ARG_INCLUDE_DIRECTORIES})
  if(ARG_PROGRAMS)
    add_dependencies(${target} ${ARG_PROGRAMS})
  endif()
  if(NOT STG_CORE_ONLY)
    target_include_directories(${target} SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
  endif()
  stg_unity(${target})
  stg_optimise(${target} -O1)
  set(labels)
  foreach(file IN LISTS ARG_SOURCES)
    get_filename_component(label ${file} NAME_WE)
    list(APPEND labels ${label})
  endforeach()
  set_tests_properties(${test} PROPERTIES LABELS "${labels}")
endfunction()

# stg_plain_python(TARGETS FOLDER MODULE FILE ...): for builds without catkin. FOLDER/MODULE has the
# extensions TARGETS. This adds links to the files of python/MODULE there, and installs all of them.
function(stg_plain_python targets folder module)
  set(destination ${CMAKE_INSTALL_LIBDIR}/python3/dist-packages/${module})
  file(MAKE_DIRECTORY ${folder}/${module})
  foreach(file IN LISTS ARGN)
    set(source ${CMAKE_CURRENT_SOURCE_DIR}/python/${module}/${file})
    file(CREATE_LINK ${source} ${folder}/${module}/${file} SYMBOLIC)
    install(FILES ${source} DESTINATION ${destination})
  endforeach()
  install(TARGETS ${targets} LIBRARY DESTINATION ${destination})
endfunction()

# stg_node_target(TARGET [LIBRARY ...]): sets up a library or program that uses ROS and libraries of
# this repository.
function(stg_node_target target)
  set(headers ${CMAKE_CURRENT_SOURCE_DIR}/src/nodes/include)
  if(EXISTS ${headers})
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${headers}>)
  endif()
  target_include_directories(${target} SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
  target_link_libraries(${target} PUBLIC ${ARGN} ${catkin_LIBRARIES})
  if(catkin_EXPORTED_TARGETS)
    add_dependencies(${target} ${catkin_EXPORTED_TARGETS})
  endif()
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "SHARED_LIBRARY")
    stg_shared_version(${target})
  endif()
  stg_unity(${target})
  stg_optimise(${target} -O1)
endfunction()

# stg_graph_node(TARGET NAME [LIBRARY ...]): sets up a node called NAME. `./stg run` starts it, so the
# target stg_graph, which `./stg run` builds, contains it.
function(stg_graph_node target name)
  stg_node_target(${target} ${ARGN})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name})
  if(NOT TARGET stg_graph)
    add_custom_target(stg_graph)
  endif()
  add_dependencies(stg_graph ${target})
endfunction()
