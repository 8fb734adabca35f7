# find_package(stg): the libraries of the cores as stg::auv_dynamics and so on, each with the flags
# that whoever includes its headers must be compiled with.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
find_dependency(Threads)
find_dependency(yaml-cpp)
include(${CMAKE_CURRENT_LIST_DIR}/stgTargets.cmake)
