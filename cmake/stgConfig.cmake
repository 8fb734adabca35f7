# find_package(stg [COMPONENTS trainer]): the libraries of the cores as stg::auv_dynamics and so on,
# each with the flags that whoever includes its headers must be compiled with.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
find_dependency(Protobuf)
find_dependency(Threads)
find_dependency(yaml-cpp)
include(${CMAKE_CURRENT_LIST_DIR}/stgTargets.cmake)
if("trainer" IN_LIST stg_FIND_COMPONENTS)
  find_dependency(nlohmann_json)
  include(${CMAKE_CURRENT_LIST_DIR}/stgTrainerTargets.cmake)
endif()
