# Debian packages only; `./dev setup` installs them.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(OpenCV REQUIRED COMPONENTS core imgproc calib3d video features2d tracking)
find_package(embree 4 QUIET)  # Debian 13
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)  # Debian 12
endif()
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(pugixml REQUIRED)
find_package(PNG REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
pkg_check_modules(libav REQUIRED IMPORTED_TARGET libavformat libavcodec libavutil libswscale)
pkg_check_modules(osg REQUIRED IMPORTED_TARGET openscenegraph)
pkg_check_modules(turbojpeg REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(webp REQUIRED IMPORTED_TARGET libwebp)
pkg_check_modules(assimp REQUIRED IMPORTED_TARGET assimp)
pkg_check_modules(egl REQUIRED IMPORTED_TARGET egl gl)
pkg_check_modules(yamlcpp REQUIRED IMPORTED_TARGET yaml-cpp)
pkg_check_modules(geographiclib REQUIRED IMPORTED_TARGET geographiclib)
pkg_check_modules(libcrypto REQUIRED IMPORTED_TARGET libcrypto)
# HTTP and WebSocket of the studio, in headers alone; on the compiler's own path.
find_path(BOOST_BEAST boost/beast.hpp REQUIRED)
# Networks run on onnxruntime where the system has it (libonnxruntime-dev, from Debian 13 on), else on OpenCV's dnn.
pkg_check_modules(onnxruntime IMPORTED_TARGET libonnxruntime)
if(AIRTRUTH_TESTS)
  find_package(GTest REQUIRED)
endif()

# OpenCV's headers are noisy under C++20; take them as system headers.
add_library(airtruth_opencv INTERFACE)
target_include_directories(airtruth_opencv SYSTEM INTERFACE ${OpenCV_INCLUDE_DIRS})
target_link_libraries(airtruth_opencv INTERFACE opencv_core opencv_imgproc)
