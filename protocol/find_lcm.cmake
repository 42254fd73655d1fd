# Defines the target tumble_lcm, for our build and for who finds the installed package. LCM's own package is preferred;
# Debian's has no CMake file, and its pkg-config file needs GLib's development files.
find_package(lcm CONFIG QUIET)
if(TARGET tumble_lcm)
elseif(lcm_FOUND)
  add_library(tumble_lcm ALIAS lcm)
else()
  find_path(LCM_INCLUDE_DIR lcm/lcm-cpp.hpp REQUIRED)
  find_library(LCM_LIBRARY lcm REQUIRED)
  add_library(tumble_lcm UNKNOWN IMPORTED GLOBAL)
  set_target_properties(tumble_lcm PROPERTIES IMPORTED_LOCATION ${LCM_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
endif()
