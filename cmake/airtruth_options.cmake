# One interface target carries every compile flag; nothing is set globally.
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_EXTENSIONS OFF)
# Where the programs of the build folder find the late libraries.
set(CMAKE_BUILD_RPATH ${PROJECT_BINARY_DIR}/src/cli)

add_library(airtruth_options INTERFACE)
target_compile_features(airtruth_options INTERFACE cxx_std_20)
target_compile_options(airtruth_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -Wno-deprecated-enum-enum-conversion -Wno-missing-field-initializers
  # The same sums everywhere: no fused multiply-add that one compiler contracts and another does not.
  -ffp-contract=off)
target_link_libraries(airtruth_options INTERFACE fmt::fmt)
# What is kept on the disk is named by the build that computed it (foundation/disk_cache).
target_link_options(airtruth_options INTERFACE -Wl,--build-id=sha1)
# The public headers (include/airtruth) mark what the libraries export; everything else stays private.
configure_file(${PROJECT_SOURCE_DIR}/include/airtruth/version.h.in ${PROJECT_BINARY_DIR}/include/airtruth/version.h @ONLY)
target_include_directories(airtruth_options INTERFACE ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include)
target_compile_options(airtruth_options INTERFACE -fvisibility=hidden -fvisibility-inlines-hidden)
# No object holds the path of the folder that it is built in, so that ccache serves every clone on a machine.
target_compile_options(airtruth_options INTERFACE -ffile-prefix-map=${PROJECT_SOURCE_DIR}=.)
if(AIRTRUTH_PCH AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(airtruth_options INTERFACE -fpch-preprocess)  # for ccache
endif()
if(AIRTRUTH_UNITY)
  # What these find between two sources that are compiled as one is no fault. The file-by-file builds keep both.
  target_compile_options(airtruth_options INTERFACE -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(AIRTRUTH_WERROR)
  target_compile_options(airtruth_options INTERFACE -Werror)
endif()
if(AIRTRUTH_SANITIZE)
  target_compile_definitions(airtruth_options INTERFACE AIRTRUTH_SANITIZED)
  target_compile_options(airtruth_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
    # What AddressSanitizer sees by itself, or x86 does not mind: a quarter of the time it takes to compile.
    -fno-sanitize=null,alignment,object-size,vptr)
  # lld links a sanitized program in a sixth of the time that GNU ld takes.
  target_link_options(airtruth_options INTERFACE -fsanitize=address,undefined -fuse-ld=lld)
endif()
if(AIRTRUTH_FUZZERS)
  # Every branch reports to the fuzzers that it was taken, but for what computes pictures and measures. The path is relative
  # to the build folder, where compilers run, so that ccache serves every clone; it hashes the file by CCACHE_EXTRAFILES.
  file(RELATIVE_PATH not_fuzzed ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR}/cmake/not_fuzzed.txt)
  target_compile_options(airtruth_options INTERFACE -fsanitize=fuzzer-no-link -fsanitize-coverage-ignorelist=${not_fuzzed})
endif()
