// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/folder.h"

#include "dataset/catalogue/encounter_rule.h"
#include "foundation/base/files.h"

namespace airtruth::catalogue {

namespace {

// Keeps the encounter models of the catalogue beside its copy.
void keep_models(const Catalogue& catalogue, const Folder& folder) {
  for (const Rule& rule : catalogue.rules) {
    const auto* encounters = std::get_if<EncounterRule>(&rule);
    if (encounters == nullptr || !encounters->tracks) continue;
    const fs::path kept = kept_model(folder.root, encounters->model_file);
    const fs::path model = fs::exists(encounters->model_file) ? encounters->model_file : kept;
    const std::string text = read_file(model);
    fs::create_directories(kept.parent_path());
    if (!fs::exists(kept))
      write_file(kept, text);
    else if (read_file(kept) != text)
      throw Error("was begun with another model (" + kept.string() + " differs from " +
                      model.string() + "); expected a new folder, or that model",
                  {folder.root.string()});
  }
}

}  // namespace

Folder open_folder(const Catalogue& catalogue, const fs::path& root, std::int64_t max_in_a_folder) {
  Folder folder{root};
  make_folders(folder.sequences(), root);
  if (!fs::exists(folder.catalogue())) {
    // The catalogue is written last: with it, the layout is fixed.
    folder.layout = sequences::layout_for(Expansion(catalogue).size(), max_in_a_folder);
    write_layout(folder.sequences(), folder.layout);
    write_file(folder.catalogue(), catalogue.text);
  } else if (read_file(folder.catalogue()) != catalogue.text) {
    // A catalogue whose sequences all failed stays: tasks of a cluster may still be at work on it.
    const bool has_sequences = !sequences::sequence_folders(root).names.empty();
    throw Error("was begun with another catalogue (its catalogue.toml differs from " +
                    catalogue.file.string() + ")" +
                    (has_sequences ? "; expected a new folder, or that catalogue"
                                   : " and holds no sequence; remove it to begin anew, or give "
                                     "a new folder"),
                {root.string()});
  }
  keep_models(catalogue, folder);
  return folder;
}

Catalogue catalogue_of(const Folder& folder) {
  if (!fs::exists(folder.catalogue()))
    throw Error("holds no catalogue.toml; expected a set that `airtruth dataset build` has begun",
                {folder.root.string()});
  return read_catalogue(folder.catalogue());
}

RunLock lock_of(const Folder& folder, Sharing sharing, const Warn& to) {
  return {folder.lock(), folder.root, to, sharing, "another build is at work in this folder"};
}

}  // namespace airtruth::catalogue
