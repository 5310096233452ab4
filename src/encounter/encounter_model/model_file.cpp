// SPDX-License-Identifier: Apache-2.0
#include "encounter/encounter_model/model_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"

namespace airtruth::encounter_model {
namespace {

// Largest file that is read: it bounds memory.
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
// The published models have 10 variables of up to 8 bins at most, and 146516 counts in a table.
constexpr std::size_t kMaxVariables = 64;
constexpr double kMaxBins = 1000;
constexpr std::size_t kMaxCounts = 20'000'000;
// Counts are whole numbers; below this bound their sums are exact.
constexpr double kMaxCount = 1e12;
constexpr const char* kNow = "(t)";
constexpr const char* kNext = "(t+1)";

const std::vector<std::string> kFields = words_in(
    "labels_initial G_initial r_initial N_initial labels_transition G_transition r_transition "
    "N_transition boundaries resample_rates");
constexpr std::string_view kBlanks = " \t\r";

// Takes the first word of `rest` away from it; empty where there is none.
std::string_view next_word(std::string_view& rest) {
  const std::size_t first = rest.find_first_not_of(kBlanks);
  if (first == rest.npos) return rest = {};
  const std::size_t end = std::min(rest.find_first_of(kBlanks, first), rest.size());
  const std::string_view word = rest.substr(first, end - first);
  rest.remove_prefix(end);
  return word;
}

double number_of(std::string_view word, const std::string& name, const Where& where) {
  const auto value = number_from_text<double>(word);
  if (!value || !std::isfinite(*value))
    throw Error(fmt::format("{} holds '{}'; expected finite numbers", name, word.substr(0, 40)),
                where);
  return *value;
}

struct FieldLine {
  std::string_view text;
  int line = 0;
};

// The fields of a model file as text: a line "# name", followed by lines of data. The text must
// outlive the object.
class ModelFields {
 public:
  // Throws Error where text precedes the first field, or a field is unknown or twice there.
  ModelFields(std::string_view text, const std::filesystem::path& file) : file_(file.string()) {
    Field* field = nullptr;
    for (int number = 1; !text.empty(); ++number) {
      const std::size_t end = text.find('\n');
      const std::string_view line = trimmed(text.substr(0, end));
      text = end == text.npos ? std::string_view() : text.substr(end + 1);
      if (line.empty()) continue;
      if (line.front() != '#') {
        if (field == nullptr)
          throw Error(
              fmt::format("begins with '{}'; expected '# labels_initial'", line.substr(0, 40)),
              {file_, number});
        field->lines.push_back({line, number});
        continue;
      }
      const std::string name(trimmed(line.substr(1)));
      if (std::ranges::find(kFields, name) == kFields.end())
        throw Error(
            fmt::format("unknown field '{}'{}",
                        name.substr(0, 40),
                        did_you_mean(
                            name, kFields, fmt::format("; expected {}", fmt::join(kFields, ", ")))),
            {file_, number});
      if (fields_.contains(name))
        throw Error(
            fmt::format("field {} is twice there; first in line {}", name, fields_[name].line),
            {file_, number});
      field = &fields_[name];
      field->line = number;
    }
  }

  // The place of a field; its first line of data where there is one.
  Where where(const std::string& name) const {
    const auto& lines = lines_of(name);
    return {file_, lines.empty() ? fields_.at(name).line : lines.front().line};
  }

  // The labels of the field's line without quotes; throws where one is empty or twice there.
  std::vector<std::string> labels(const std::string& name) const {
    const FieldLine& line = lines(name, 1).front();
    std::vector<std::string> labels;
    std::string_view rest = line.text;
    for (bool more = true; more;) {
      const std::size_t comma = rest.find(',');
      std::string_view label = trimmed(rest.substr(0, comma));
      if (label.size() >= 2 && label.front() == '"' && label.back() == '"')
        label = trimmed(label.substr(1, label.size() - 2));
      if (label.empty())
        throw Error(
            fmt::format("{} holds an empty label; expected quoted names with commas between", name),
            {file_, line.line});
      if (std::ranges::find(labels, label) != labels.end())
        throw Error(
            fmt::format("{} holds '{}' twice; expected different names", name, label.substr(0, 40)),
            {file_, line.line});
      labels.emplace_back(label);
      more = comma != rest.npos;
      if (more) rest.remove_prefix(comma + 1);
    }
    return labels;
  }

  // All numbers of the field, line by line. Throws where a word is not a finite number from `low`
  // to `high`, or where the field does not hold `count` numbers.
  std::vector<double> numbers(const std::string& name,
                              std::size_t count,
                              double low,
                              double high) const {
    std::vector<double> numbers;
    Where place = {file_, where(name).line};
    for (const FieldLine& line : lines_of(name)) {
      place.line = line.line;
      std::string_view rest = line.text;
      for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
        const double value = number_of(word, name, place);
        if (value < low || value > high)
          throw Error(
              fmt::format("{} holds {}; expected numbers from {} to {}", name, word, low, high),
              place);
        if (numbers.size() == count)
          throw Error(fmt::format("{} holds more than {} numbers; expected {}", name, count, count),
                      place);
        numbers.push_back(value);
      }
    }
    if (numbers.size() != count)
      throw Error(fmt::format("{} holds {} numbers; expected {}", name, numbers.size(), count),
                  place);
    return numbers;
  }

  // The lines of the field, of which there must be `count`.
  const std::vector<FieldLine>& lines(const std::string& name, std::size_t count) const {
    const auto& lines = lines_of(name);
    if (lines.size() != count)
      throw Error(fmt::format("{} has {} lines; expected {}", name, lines.size(), count),
                  {file_, lines.empty() ? fields_.at(name).line : lines.back().line});
    return lines;
  }

  std::vector<double> numbers_of(const FieldLine& line, const std::string& name) const {
    std::vector<double> numbers;
    std::string_view rest = line.text;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
      numbers.push_back(number_of(word, name, {file_, line.line}));
    return numbers;
  }

 private:
  const std::vector<FieldLine>& lines_of(const std::string& name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end())
      throw Error(fmt::format("has no field '# {}'; expected it in every model", name), {file_});
    return found->second.lines;
  }

  struct Field {
    int line = 0;
    std::vector<FieldLine> lines;
  };

  std::string file_;
  std::map<std::string, Field> fields_;
};

// A network as the file states it: variable p is a parent of variable i where
// is_parent[p * size + i].
struct Graph {
  std::vector<std::string> labels;
  std::vector<bool> is_parent;
  std::vector<std::size_t> bins;

  std::size_t size() const { return labels.size(); }
  std::vector<std::size_t> parents_of(std::size_t variable) const {
    std::vector<std::size_t> parents;
    for (std::size_t p = 0; p < size(); ++p)
      if (is_parent[p * size() + variable]) parents.push_back(p);
    return parents;
  }
};

std::vector<std::size_t> whole_numbers(const ModelFields& fields,
                                       const std::string& name,
                                       std::size_t count) {
  std::vector<std::size_t> whole;
  for (const double number : fields.numbers(name, count, 1, kMaxBins)) {
    if (number != std::floor(number))
      throw Error(fmt::format("{} holds {}; expected whole numbers", name, number),
                  fields.where(name));
    whole.push_back(static_cast<std::size_t>(number));
  }
  return whole;
}

Graph graph_in(const ModelFields& fields, const std::string& net) {
  Graph graph{fields.labels("labels_" + net), {}, {}};
  const std::size_t size = graph.size();
  if (size > kMaxVariables)
    throw Error(fmt::format("has {} variables; expected up to {}", size, kMaxVariables),
                fields.where("labels_" + net));
  fields.lines("G_" + net, size);
  for (const double edge : fields.numbers("G_" + net, size * size, 0, 1)) {
    if (edge != 0 && edge != 1)
      throw Error(fmt::format("G_{} holds {}; expected 0 or 1", net, edge),
                  fields.where("G_" + net));
    graph.is_parent.push_back(edge == 1);
  }
  graph.bins = whole_numbers(fields, "r_" + net, size);
  return graph;
}

// The variables from `first` on, each after its parents (Kahn 1962). Variables before `first` are
// known.
std::vector<std::size_t> order_of(const Graph& graph, std::size_t first, const Where& where) {
  std::vector<std::size_t> order;
  std::vector<bool> is_known(graph.size(), false);
  std::fill_n(is_known.begin(), first, true);
  while (order.size() < graph.size() - first) {
    const std::size_t before = order.size();
    for (std::size_t i = first; i < graph.size(); ++i) {
      if (is_known[i]) continue;
      const auto parents = graph.parents_of(i);
      if (!std::ranges::all_of(parents, [&](std::size_t p) { return is_known[p]; })) continue;
      is_known[i] = true;
      order.push_back(i - first);
    }
    if (order.size() == before)
      throw Error("the graph has a cycle; expected every variable to come after its parents",
                  where);
  }
  return order;
}

// The tables of the variables from `first` on, which the file concatenates.
std::vector<Node> nodes_in(const ModelFields& fields,
                           const Graph& graph,
                           std::size_t first,
                           const std::string& name) {
  std::vector<Node> nodes;
  std::size_t count = 0;
  for (std::size_t i = first; i < graph.size(); ++i) {
    Node node{graph.bins[i], graph.parents_of(i), {}};
    std::size_t size = node.bins;
    for (const std::size_t p : node.parents) {
      size *= graph.bins[p];
      if (size > kMaxCounts) break;
    }
    count += size;
    if (count > kMaxCounts)
      throw Error(
          fmt::format(
              "{} needs more than {} counts for its graph; expected fewer", name, kMaxCounts),
          fields.where(name));
    node.sums.resize(size);
    nodes.push_back(std::move(node));
  }
  const std::vector<double> counts = fields.numbers(name, count, 0, kMaxCount);
  std::size_t at = 0;
  for (Node& node : nodes)
    for (std::size_t k = 0; k < node.sums.size(); ++k, ++at)
      node.sums[k] = counts[at] + (k % node.bins == 0 ? 0 : node.sums[k - 1]);
  return nodes;
}

// The first variables of the transition network are the initial ones, those that change with "(t)"
// behind the label.
void compare(const Graph& initial, const Graph& transition, const ModelFields& fields) {
  if (transition.size() < initial.size())
    throw Error(fmt::format("labels_transition holds {} labels; expected the {} initial ones first",
                            transition.size(),
                            initial.size()),
                fields.where("labels_transition"));
  for (std::size_t i = 0; i < initial.size(); ++i) {
    const std::string& label = initial.labels[i];
    if (transition.labels[i] != label && transition.labels[i] != label + kNow)
      throw Error(fmt::format("label {} of labels_transition is '{}'; expected '{}' or '{}(t)'",
                              i + 1,
                              transition.labels[i],
                              label,
                              label),
                  fields.where("labels_transition"));
    if (transition.bins[i] != initial.bins[i])
      throw Error(fmt::format("r_transition gives '{}' {} bins; expected {} as in r_initial",
                              label,
                              transition.bins[i],
                              initial.bins[i]),
                  fields.where("r_transition"));
    const std::string next = label + kNext;
    if (transition.labels[i] != label &&
        std::ranges::find(transition.labels, next) == transition.labels.end())
      throw Error(fmt::format("'{}(t)' has no partner; expected a label '{}'", label, next),
                  fields.where("labels_transition"));
  }
}

std::vector<DynamicVariable> dynamic_in(const ModelFields& fields,
                                        const Graph& initial,
                                        const Graph& transition) {
  const auto rates = fields.numbers("resample_rates", initial.size(), 0, 1);
  std::vector<DynamicVariable> dynamic;
  for (std::size_t i = initial.size(); i < transition.size(); ++i) {
    const std::string& label = transition.labels[i];
    const auto now = std::ranges::find_if(
        initial.labels, [&](const std::string& at) { return at + kNext == label; });
    const auto place = static_cast<std::size_t>(now - initial.labels.begin());
    if (now == initial.labels.end() || transition.labels[place] != *now + kNow)
      throw Error(
          fmt::format("'{}' has no partner at (t); expected a label 'x(t+1)' for each 'x(t)'",
                      label),
          fields.where("labels_transition"));
    if (transition.bins[place] != transition.bins[i])
      throw Error(fmt::format("r_transition gives '{}' {} bins; expected {} as at (t)",
                              label,
                              transition.bins[i],
                              transition.bins[place]),
                  fields.where("r_transition"));
    dynamic.push_back({place, i, rates[place]});
  }
  return dynamic;
}

std::vector<std::vector<double>> edges_in(const ModelFields& fields, const Graph& initial) {
  std::vector<std::vector<double>> edges;
  const auto& lines = fields.lines("boundaries", initial.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].text == "*") {
      edges.emplace_back();
      continue;
    }
    edges.push_back(fields.numbers_of(lines[i], "boundaries"));
    const Where where{fields.where("boundaries").file, lines[i].line};
    if (edges.back().size() != initial.bins[i] + 1)
      throw Error(fmt::format("boundaries of '{}' are {} numbers; expected {} for {} bins, or *",
                              initial.labels[i],
                              edges.back().size(),
                              initial.bins[i] + 1,
                              initial.bins[i]),
                  where);
    if (std::adjacent_find(edges.back().begin(), edges.back().end(), std::greater_equal<>()) !=
        edges.back().end())
      throw Error(fmt::format("boundaries of '{}' do not increase", initial.labels[i]), where);
  }
  return edges;
}

VariablePlaces places_in(const BayesModel& model, const ModelFields& fields) {
  const auto place = [&](const char* label, bool has_edges) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(model.labels, label);
    if (found == model.labels.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(found - model.labels.begin());
    if (has_edges && model.edges[i].empty())
      throw Error(fmt::format("boundaries of '{}' are *; expected the edges of its bins", label),
                  fields.where("boundaries"));
    return i;
  };
  VariablePlaces places{place("G", false),
                        place("A", false),
                        place("L", true),
                        place("v", true),
                        place("\\dot v", true),
                        place("\\dot h", true),
                        place("\\dot \\psi", true)};
  if (!places.altitude_ft)
    throw Error("labels_initial lacks \"L\"; expected a model with an altitude layer",
                fields.where("labels_initial"));
  return places;
}

}  // namespace

BayesModel parse_model(std::string_view text, const fs::path& file) {
  const ModelFields fields(text, file);
  const Graph initial = graph_in(fields, "initial");
  BayesModel model;
  model.file = file;
  model.labels = initial.labels;
  model.initial_order = order_of(initial, 0, fields.where("G_initial"));
  model.initial = nodes_in(fields, initial, 0, "N_initial");
  for (std::size_t i = 0; i < initial.size(); ++i)
    if (model.initial[i].parents.empty() && !(model.initial[i].total(0) > 0))
      throw Error(
          fmt::format("N_initial has no count for '{}'; expected one at least", initial.labels[i]),
          fields.where("N_initial"));
  const Graph transition = graph_in(fields, "transition");
  compare(initial, transition, fields);
  model.transition_order = order_of(transition, initial.size(), fields.where("G_transition"));
  model.transition = nodes_in(fields, transition, initial.size(), "N_transition");
  model.dynamic = dynamic_in(fields, initial, transition);
  model.edges = edges_in(fields, initial);
  model.places = places_in(model, fields);
  return model;
}

BayesModel read_model(const fs::path& file) {
  return parse_model(read_file(file, kMaxBytes), file);
}

}  // namespace airtruth::encounter_model
