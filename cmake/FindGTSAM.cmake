# GTSAM as Debian packages it. Its own config file asks for CppUnitLite, which Debian does not ship, so its library and the
# Boost libraries that its headers need are named here.
find_path(GTSAM_INCLUDE_DIR gtsam/config.h)
set(libraries gtsam boost_serialization boost_timer boost_filesystem)
set(found_libraries "")
set(required "")
foreach(library IN LISTS libraries)
  find_library(GTSAM_${library} ${library})
  list(APPEND found_libraries ${GTSAM_${library}})
  list(APPEND required GTSAM_${library})
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(GTSAM REQUIRED_VARS GTSAM_INCLUDE_DIR ${required})
if(GTSAM_FOUND AND NOT TARGET GTSAM::GTSAM)
  find_package(TBB REQUIRED) # its headers allocate with it
  add_library(GTSAM::GTSAM INTERFACE IMPORTED)
  target_include_directories(GTSAM::GTSAM SYSTEM INTERFACE ${GTSAM_INCLUDE_DIR})
  target_link_libraries(GTSAM::GTSAM INTERFACE ${found_libraries} TBB::tbb TBB::tbbmalloc)
endif()
