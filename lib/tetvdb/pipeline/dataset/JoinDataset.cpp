// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/JoinDataset.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/dataset/Hdf5Arrays.h"
#include "tetvdb/pipeline/dataset/TarWriter.h"
#include "tetvdb/pipeline/dataset/ZarrArrays.h"
#include "tetvdb/visualize/PictureMaker.h"
#include "tetvdb/visualize/WritePng.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <set>
#include <unordered_map>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxShown = 24;           // models of the preview
constexpr std::size_t kMaxShownFaces = 200'000; // of each

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos)
    return text;
  std::string quoted = "\"";
  for (const char c : text)
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string csvLine(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields)
    line += (&field == &fields.front() ? "" : ",") + csvField(field);
  return line + "\n";
}

// A value as text; numbers in the shortest form that reads back.
std::string cellOf(const DatasetRow& row, const char* key) {
  const auto found = row.find(key);
  if (found == row.end() || found->is_null())
    return {};
  return found->is_string() ? found->get<std::string>() : found->dump();
}

std::string joined(const DatasetRow& row, const char* key) {
  std::string text;
  const auto found = row.find(key);
  if (found != row.end() && found->is_array())
    for (const DatasetRow& one : *found)
      text += (text.empty() ? "" : ";") + one.get<std::string>();
  return text;
}

// Of several rows with the same value of a key the name of the first.
using Firsts = std::unordered_map<std::string, std::string>;

std::string repeats(Firsts& firsts, const std::string& value, const std::string& name) {
  if (value.empty())
    return {};
  const auto [at, isNew] = firsts.emplace(value, name);
  return isNew ? std::string() : at->second;
}

const DatasetRow& finestGrid(const DatasetRow& row) {
  static const DatasetRow none = DatasetRow::object();
  const auto grids = row.find("grids");
  if (grids == row.end() || grids->empty())
    return none;
  return *std::max_element(grids->begin(), grids->end(),
                           [](const DatasetRow& a, const DatasetRow& b) {
                             return a.at("size").get<int>() < b.at("size").get<int>();
                           });
}

void writeText(const fs::path& path, const std::string& text) {
  AtomicFile file(path.string());
  file.write(text.data(), text.size());
  file.commit();
}

std::string percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? "-" : fmt::format("{:.1f} %", 100 * double(part) / double(whole));
}

class Joiner {
public:
  Joiner(const std::vector<DatasetItem>& items, const std::map<std::string, DatasetRow>& rows,
         const DatasetOptions& options, const JoinOptions& how, const std::string& folder,
         Progress& progress)
      : items_(items), rows_(rows), options_(options), how_(how), folder_(folder),
        progress_(progress) {}

  DatasetSummary join() {
    requireAllRows();
    tables();
    if (how_.archives > 0)
      archives();
    if (writes(DatasetFormat::Zarr))
      joinStores();
    if (how_.preview)
      preview();
    card();
    return std::move(summary_);
  }

private:
  const DatasetRow& rowOf(const DatasetItem& item) const { return rows_.at(item.name()); }

  void requireAllRows() {
    std::size_t missing = 0;
    std::string first;
    for (const DatasetItem& item : items_)
      if (rows_.count(item.name()) == 0 && ++missing == 1)
        first = item.name();
    if (missing > 0)
      throw Error(Status::Invalid, folder_.string(),
                  fmt::format("{} of {} models have no result yet, '{}' the first of them", missing,
                              items_.size(), first),
                  "run the tasks that have not ended again with `resume`");
  }

  void tables() {
    std::vector<std::string> header{"name",         "id",    "variant",    "class",
                                    "split",        "path",  "file_hash",  "same_file_as",
                                    "same_grid_as", "faces", "open_edges", "volume"};
    for (const int size : options_.resolutions)
      header.push_back(fmt::format("occupied_{}", size));
    for (const char* stage : {"read", "clean", "voxelize", "fields", "points", "write"})
      header.push_back(fmt::format("{}_seconds", stage));
    for (const char* name : {"seconds", "processor_seconds", "warnings", "files"})
      header.emplace_back(name);
    std::string success = csvLine(header);
    std::string failed = csvLine({"name", "id", "variant", "class", "split", "path", "status",
                                  "stage", "error", "seconds", "processor_seconds"});
    Firsts files, grids;
    for (const DatasetItem& item : items_) {
      const DatasetRow& row = rowOf(item);
      ++summary_.items;
      summary_.seconds += row.value("seconds", 0.0);
      processorSeconds_ += row.value("processor_seconds", 0.0);
      if (!isSuccess(row)) {
        ++summary_.failed;
        ++reasons_[row.value("error", std::string())];
        failed += csvLine({cellOf(row, "name"), cellOf(row, "id"), cellOf(row, "variant"),
                           cellOf(row, "class"), cellOf(row, "split"), cellOf(row, "path"),
                           cellOf(row, "status"), cellOf(row, "stage"), cellOf(row, "error"),
                           cellOf(row, "seconds"), cellOf(row, "processor_seconds")});
        continue;
      }
      ++summary_.succeeded;
      ++byClass_[item.entry.className][item.entry.split];
      for (const DatasetRow& code : row.value("warnings", DatasetRow::array()))
        ++warnings_[code.get<std::string>()];
      closed_ += row.value("open_edges", 0) == 0;
      success += successLine(item, row, files, grids);
    }
    writeText(folder_ / "success.csv", success);
    writeText(folder_ / "failed.csv", failed);
    summary_.files.insert(summary_.files.end(), {"success.csv", "failed.csv"});
  }

  std::string successLine(const DatasetItem& item, const DatasetRow& row, Firsts& files,
                          Firsts& grids) {
    // Variants of one model have one file.
    const std::string fileKey =
        item.variant == 0 ? row.value("file_hash", std::string()) : std::string();
    const std::string sameFile = repeats(files, fileKey, item.name());
    const std::string sameGrid =
        repeats(grids, finestGrid(row).value("hash", std::string()), item.name());
    summary_.sameFile += !sameFile.empty();
    summary_.sameGrid += !sameGrid.empty();
    std::vector<std::string> fields{cellOf(row, "name"),
                                    cellOf(row, "id"),
                                    cellOf(row, "variant"),
                                    cellOf(row, "class"),
                                    cellOf(row, "split"),
                                    cellOf(row, "path"),
                                    cellOf(row, "file_hash"),
                                    sameFile,
                                    sameGrid,
                                    cellOf(row, "faces"),
                                    cellOf(row, "open_edges"),
                                    cellOf(row, "volume")};
    for (const int size : options_.resolutions) {
      std::string occupied;
      for (const DatasetRow& grid : row.value("grids", DatasetRow::array()))
        if (grid.at("size") == size)
          occupied = cellOf(grid, "occupied");
      fields.push_back(occupied);
    }
    const DatasetRow stages = row.value("stages", DatasetRow::object());
    for (const char* stage : {"read", "clean", "voxelize", "fields", "points", "write"})
      fields.push_back(cellOf(stages, stage));
    fields.push_back(cellOf(row, "seconds"));
    fields.push_back(cellOf(row, "processor_seconds"));
    fields.push_back(joined(row, "warnings"));
    fields.push_back(joined(row, "files"));
    return csvLine(fields);
  }

  bool writes(DatasetFormat format) const {
    return std::find(options_.formats.begin(), options_.formats.end(), format) !=
           options_.formats.end();
  }

  static bool endsWith(const std::string& name, const std::string& ending) {
    return name.size() >= ending.size() &&
           name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
  }
  static bool isStore(const std::string& file) { return endsWith(file, ".zarr"); }
  static bool isHdf5(const std::string& file) { return endsWith(file, ".h5"); }

  std::string archiveName(unsigned index, const char* ending) const {
    return fmt::format("data-{:05}-of-{:05}{}", index, how_.archives, ending);
  }

  void archives() {
    progress_.stage("pack");
    std::vector<std::vector<const DatasetItem*>> of(how_.archives);
    for (const DatasetItem& item : items_)
      if (isSuccess(rowOf(item)))
        of[hashOfId(item.entry.id) % how_.archives].push_back(&item);
    const bool packsTar =
        std::any_of(options_.formats.begin(), options_.formats.end(), [](DatasetFormat format) {
          return format != DatasetFormat::Hdf5 && format != DatasetFormat::Zarr;
        });
    for (unsigned index = 0; index < how_.archives; ++index) {
      progress_.check();
      progress_.update(double(index) / how_.archives);
      if (packsTar)
        packTar(archiveName(index, ".tar"), of[index]);
      if (writes(DatasetFormat::Hdf5))
        packHdf5(archiveName(index, ".h5"), of[index]);
      for (const DatasetItem* item : of[index])
        for (const DatasetRow& name : rowOf(*item).at("files"))
          removePacked(name.get<std::string>());
    }
  }

  void packTar(const std::string& archive, const std::vector<const DatasetItem*>& items) {
    summary_.files.push_back(archive);
    const fs::path path = folder_ / archive;
    std::error_code error;
    if (fs::exists(path, error))
      return;
    AtomicFile file(path.string());
    TarWriter tar(file);
    for (const DatasetItem* item : items)
      pack(*item, tar);
    tar.finish();
    file.commit();
  }

  void packHdf5(const std::string& archive, const std::vector<const DatasetItem*>& items) {
    summary_.files.push_back(archive);
    const fs::path path = folder_ / archive;
    std::error_code error;
    if (fs::exists(path, error))
      return;
    std::vector<std::pair<std::string, std::string>> members;
    for (const DatasetItem* item : items)
      for (const DatasetRow& one : rowOf(*item).at("files"))
        if (const std::string name = one; isHdf5(name))
          members.emplace_back(item->name(), (folder_ / name).string());
    joinHdf5Files(path.string(), members, progress_);
  }

  void removePacked(const std::string& name) const {
    if (isStore(name))
      return;
    std::error_code error;
    fs::remove(folder_ / name, error);
    removeEmptyFolders((folder_ / name).parent_path());
  }

  void joinStores() {
    std::vector<std::string> stores;
    for (const DatasetItem& item : items_)
      if (isSuccess(rowOf(item)))
        for (const DatasetRow& one : rowOf(item).at("files"))
          if (const std::string name = one; isStore(name))
            stores.push_back(name);
    joinZarrStores(folder_.string(), stores);
    summary_.files.emplace_back(".zmetadata");
  }

  void removeEmptyFolders(fs::path path) const {
    std::error_code error;
    while (path != folder_ && fs::is_empty(path, error) && !error && fs::remove(path, error))
      path = path.parent_path();
  }

  // WebDataset's key is the name up to the first dot.
  void pack(const DatasetItem& item, TarWriter& tar) const {
    const DatasetRow& row = rowOf(item);
    std::string key = item.name();
    std::replace(key.begin(), key.end(), '.', '_');
    for (const DatasetRow& one : row.at("files")) {
      const std::string name = one;
      if (isStore(name) || isHdf5(name))
        continue;
      const std::size_t at = name.rfind(item.name());
      std::string ending = at == name.npos ? name : name.substr(at + item.name().size());
      if (!ending.empty() && (ending[0] == '_' || ending[0] == '/'))
        ending[0] = '.';
      const MappedFile file((folder_ / name).string());
      tar.add(key + ending, file.bytes());
    }
    const DatasetRow about = {{"id", item.entry.id},
                              {"variant", item.variant},
                              {"class", item.entry.className},
                              {"split", item.entry.split},
                              {"transform", row.at("transform")}};
    tar.add(key + ".json", about.dump());
  }

  // The models whose names have the smallest hashes.
  void preview() {
    progress_.stage("preview");
    std::vector<const DatasetItem*> shown;
    for (const DatasetItem& item : items_)
      if (item.variant == 0 && isSuccess(rowOf(item)) &&
          rowOf(item).value("faces", std::size_t(0)) <= kMaxShownFaces)
        shown.push_back(&item);
    std::sort(shown.begin(), shown.end(), [](const DatasetItem* a, const DatasetItem* b) {
      const std::uint64_t x = hashOfId(a->entry.id), y = hashOfId(b->entry.id);
      return x != y ? x < y : a->entry.id < b->entry.id;
    });
    shown.resize(std::min(shown.size(), kMaxShown));
    std::vector<PictureMaker::CaptionedSubject> subjects;
    for (const DatasetItem* item : shown) {
      try {
        Report ignored;
        TriangleMesh mesh = readSoup(item->entry.path, nullptr, ignored, progress_);
        RandomNumbers random(0);
        normalizeModel(mesh, options_, 0, random);
        subjects.push_back({subjectOf(std::move(mesh), MeshLook{}), item->entry.id});
      } catch (const Error& error) {
        if (error.status() == Status::Cancelled)
          throw; // others: a file that has gone since, or tets
      }
    }
    if (subjects.empty())
      return;
    PictureOptions picture;
    const auto columns = static_cast<int>(std::ceil(std::sqrt(double(subjects.size()))));
    const auto rows = (static_cast<int>(subjects.size()) + columns - 1) / columns;
    picture.width = 240 * columns;
    picture.height = 240 * rows;
    picture.captions = true;
    picture.render.refinedShare = 0.05;
    const PictureMaker maker(std::move(subjects), picture, progress_);
    writePng((folder_ / "preview.png").string(), maker.take(0, progress_));
    summary_.files.emplace_back("preview.png");
  }

  void card() {
    std::string text = fmt::format(
        "# Data set\n\nMade by TetVDB {}. {} of {} models succeeded ({}); failed.csv says why the "
        "others did not.\n\n",
        version(), summary_.succeeded, summary_.items, percent(summary_.succeeded, summary_.items));
    text += "| | |\n|---|---|\n";
    std::string sizes;
    for (const int size : options_.resolutions)
      sizes += fmt::format("{}{}³", sizes.empty() ? "" : ", ", size);
    text += fmt::format("| voxels | {} |\n| cube | side {:g} |\n", sizes, 1 + options_.padding);
    text +=
        fmt::format("| closed models | {} ({}) |\n", closed_, percent(closed_, summary_.succeeded));
    text += fmt::format(
        "| same file as an earlier model | {} |\n| same voxels as an earlier model | {} |\n",
        summary_.sameFile, summary_.sameGrid);
    text += fmt::format("| processor time, all models | {:.1f} s |\n\n", processorSeconds_);
    text += "`transform` leads from a file's coordinates to those of the arrays, `grid_N` from a "
            "voxel's numbers to them; both are 4 x 4, row by row.\n";
    if (options_.packBits)
      text += "Booleans are packed: `numpy.unpackbits(a, count=N**3).reshape(N, N, N)`.\n";
    text += "\n## Classes\n\n| class | split | models |\n|---|---|---|\n";
    for (const auto& [name, splits] : byClass_)
      for (const auto& [split, count] : splits)
        text += fmt::format("| {} | {} | {} |\n", name, split, count);
    list(text, "Warnings", warnings_);
    list(text, "Failures", reasons_);
    writeText(folder_ / "card.md", text);
    summary_.files.emplace_back("card.md");
  }

  static void list(std::string& text, const char* title,
                   const std::map<std::string, std::size_t>& counts) {
    if (counts.empty())
      return;
    text += fmt::format("\n## {}\n\n", title);
    for (const auto& [name, count] : counts)
      text += fmt::format("- {} x {}\n", count, name);
  }

  const std::vector<DatasetItem>& items_;
  const std::map<std::string, DatasetRow>& rows_;
  const DatasetOptions& options_;
  const JoinOptions& how_;
  const fs::path folder_;
  Progress& progress_;
  DatasetSummary summary_;
  std::size_t closed_ = 0;
  double processorSeconds_ = 0; ///< of models whose process lived
  std::map<std::string, std::map<std::string, std::size_t>> byClass_;
  std::map<std::string, std::size_t> warnings_, reasons_;
};

} // namespace

std::vector<DatasetItem> itemsOf(const std::vector<DatasetEntry>& entries, int variants) {
  std::vector<DatasetItem> items;
  for (const DatasetEntry& entry : entries)
    for (int variant = 0; variant <= variants; ++variant)
      items.push_back({entry, variant});
  return items;
}

DatasetSummary joinDataset(const std::vector<DatasetItem>& items,
                           const std::map<std::string, DatasetRow>& rows,
                           const DatasetOptions& options, const JoinOptions& how,
                           const std::string& folder, Progress& progress) {
  return Joiner(items, rows, options, how, folder, progress).join();
}

} // namespace tetvdb
