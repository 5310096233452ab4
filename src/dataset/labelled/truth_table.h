// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "labels/annotation/truth.h"
#include "sequence/replay/finished.h"

// What the table of an export holds of the truth of a rendered sequence, beside its labels.
namespace airtruth::labelled {

// The names of the columns of an intruder's truth in a frame, as airtruth.DataSet.table() of the
// Python package has them, and its cells. What is not defined is empty.
std::vector<std::string> truth_columns();
std::vector<std::string> truth_cells(const annotation::Intruder& intruder);

// encounters.csv: its first line, and a line for each encounter that a sequence records.
std::string encounters_header();
std::string encounter_lines(const replay::Finished& sequence, const std::string& part);

}  // namespace airtruth::labelled
