# What Glint is linked to: one list for its own build and for those who link the installed static libraries.
include(CMakeFindDependencyMacro)

list(PREPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE ON)

find_dependency(Threads)
find_dependency(TBB CONFIG)
find_dependency(fmt)
find_dependency(spdlog)
find_dependency(Eigen3 3.4 NO_MODULE)
find_dependency(OpenCV 4 COMPONENTS core imgproc imgcodecs video videoio)
find_dependency(JPEG)
find_dependency(Ceres 2)
find_dependency(OpenVDB 10)
find_dependency(CGAL 5)
find_dependency(embree 3)
find_dependency(hwy 1 CONFIG)
find_dependency(yaml-cpp)
