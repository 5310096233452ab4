// SPDX-License-Identifier: Apache-2.0
#include "synthetic/flight.h"

#include <gtest/gtest.h>
