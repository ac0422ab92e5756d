# Lets an interface package be generated against the pip wheels of ROS 2.
#
# The wheels export, in their rosidl_generator_py targets, include folders of the machine that
# built them, and CMake refuses to generate with folders that do not exist. This file is loaded
# through CMAKE_PROJECT_INCLUDE and, when every find_package() is done, takes such folders out of
# the imported targets. Where all folders exist, as in /opt/ros/jazzy, it changes nothing.
# Needs CMake 3.19.
function(geoprim_drop_missing_includes)
  get_property(targets DIRECTORY "${CMAKE_SOURCE_DIR}" PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(folders ${target} INTERFACE_INCLUDE_DIRECTORIES)
    if(folders)
      set(present "")
      foreach(folder IN LISTS folders)
        # A generator expression is not a path yet, so it stays.
        if(folder MATCHES "^\\$<" OR EXISTS "${folder}")
          list(APPEND present "${folder}")
        endif()
      endforeach()
      set_property(TARGET ${target} PROPERTY INTERFACE_INCLUDE_DIRECTORIES "${present}")
    endif()
  endforeach()
endfunction()

cmake_language(DEFER DIRECTORY "${CMAKE_SOURCE_DIR}" CALL geoprim_drop_missing_includes)
