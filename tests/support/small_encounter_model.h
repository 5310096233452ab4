// SPDX-License-Identifier: Apache-2.0
#pragma once

// A model of our own for tests: all kinds of edges and tables in few numbers. Domain, altitude and
// speed depend on each other; the acceleration has no parents; the new vertical rate depends on
// the new turn rate, so that a column must be found anew in each second; the column of the turn
// rate for turning right (bin 3) in the upper layer has no counts.
namespace airtruth::test_support {

constexpr const char* kSmallModel = R"model(# labels_initial
"G", "L", "v", "\dot v", "\dot h", "\dot \psi"
# G_initial
0 1 0 0 0 0
0 0 1 0 0 0
0 0 0 0 0 0
0 0 0 0 0 0
0 0 0 0 0 1
0 0 0 0 0 0
# r_initial
2 2 3 3 3 3
# N_initial
300 100 80 20 1 3 10 60 30 0 50 50 10 80 10 20 60 20 10 80 10 25 50 25 5 5 90
# labels_transition
"G", "L", "v", "\dot v(t)", "\dot h(t)", "\dot \psi(t)", "\dot v(t+1)", "\dot h(t+1)", "\dot \psi(t+1)"
# G_transition
0 0 0 0 0 0 0 0 0
0 0 0 0 0 0 0 0 1
0 0 0 0 0 0 0 0 0
0 0 0 0 0 0 1 0 0
0 0 0 0 0 0 0 1 0
0 0 0 0 0 0 0 0 1
0 0 0 0 0 0 0 0 0
0 0 0 0 0 0 0 0 0
0 0 0 0 0 0 0 1 0
# r_transition
2 2 3 3 3 3 3 3 3
# N_transition
90 10 0 2 96 2 0 10 90
70 20 10 10 80 10 10 20 70
80 20 0 1 98 1 0 20 80
60 30 10 20 60 20 10 30 60
90 10 0 80 20 0 3 94 3 5 90 5 0 10 90 0 0 0
# boundaries
*
500 1500 5000
60 90 120 150
-1 -0.2 0.2 1
-1000 -200 200 1000
-4 -1 1 4
# resample_rates
0 0 0.05 0.1 0.2 0.3
)model";

}  // namespace airtruth::test_support
