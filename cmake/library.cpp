// SPDX-License-Identifier: Apache-2.0
// libairtruth.so is made of the modules' own archives; CMake wants one source of its own.
