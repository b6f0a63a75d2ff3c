# `cmake --install`: the program, the static libraries with their headers, and what find_package(Glint) needs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Glint)

# Everything at once, for those who link to it: Glint::glint.
add_library(glint_library INTERFACE)
target_link_libraries(glint_library INTERFACE glint_pipeline)
set_target_properties(glint_library PROPERTIES EXPORT_NAME glint)
add_library(Glint::glint ALIAS glint_library)

get_property(modules GLOBAL PROPERTY GLINT_MODULES)
foreach(module IN LISTS modules)
  set_target_properties(glint_${module} PROPERTIES EXPORT_NAME ${module})
  target_compile_features(glint_${module} INTERFACE cxx_std_20)
  # <glint/sdf/signed_distance.h> for users; "sdf/level_set.h" is how the headers find each other.
  target_include_directories(glint_${module} INTERFACE
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/glint>)
  install(TARGETS glint_${module} EXPORT GlintTargets ARCHIVE COMPONENT library)
endforeach()
install(TARGETS glint_library EXPORT GlintTargets COMPONENT library)
install(TARGETS glint RUNTIME COMPONENT program)

# The headers that need no more than the standard library and Eigen, themselves and by what they include. The others
# are private to their module (scripts/check_layers asserts that).
file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR} ${CMAKE_SOURCE_DIR}/src/*/*.h ${CMAKE_SOURCE_DIR}/pipeline/*.h)
set(private_headers)
foreach(header IN LISTS headers)
  file(STRINGS ${header} heavy REGEX "^#include [<\"](openvdb|hwy|opencv2|CGAL|ceres|embree[34]|tbb|fmt|spdlog|yaml-cpp|nlohmann|CLI)/")
  if(heavy OR header MATCHES "-inl\\.h$")
    list(APPEND private_headers ${header})
  endif()
endforeach()
set(grown TRUE)
while(grown)
  set(grown FALSE)
  list(REMOVE_ITEM headers ${private_headers})
  foreach(header IN LISTS headers)
    file(STRINGS ${header} includes REGEX "^#include \"")
    foreach(private IN LISTS private_headers)
      string(REGEX REPLACE "^src/" "" name ${private})
      if(includes MATCHES "#include \"${name}\"")
        list(APPEND private_headers ${header})
        set(grown TRUE)
        break()
      endif()
    endforeach()
  endforeach()
endwhile()
foreach(header IN LISTS headers)
  string(REGEX REPLACE "^src/" "" name ${header})
  cmake_path(GET name PARENT_PATH folder)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/glint/${folder} COMPONENT library)
endforeach()

install(EXPORT GlintTargets NAMESPACE Glint:: DESTINATION ${package_folder} COMPONENT library)
configure_package_config_file(cmake/GlintConfig.cmake.in GlintConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(GlintConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/GlintConfig.cmake ${CMAKE_BINARY_DIR}/GlintConfigVersion.cmake
  cmake/GlintDependencies.cmake DESTINATION ${package_folder} COMPONENT library)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
