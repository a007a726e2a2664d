// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/exodus/ExodusReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/formats/exodus/NetCdfSize.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/IsolatedRead.h"
#include "tetvdb/io/source/TimeStep.h"
#include "tetvdb/mesh/CurvedShape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <netcdf.h>
#include <netcdf_mem.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

/// netCDF and HDF5 are not thread-safe.
std::mutex& netcdfMutex() {
  static std::mutex mutex;
  return mutex;
}

/// A netCDF variable.
struct Variable {
  int id = -1;
  nc_type type = NC_NAT;
  std::vector<std::size_t> shape;
};

/// A netCDF file in memory. Throws Error(Invalid).
class NetCdf {
public:
  explicit NetCdf(const Source& source) : source_(source) {
    checkNetCdfSize(source);
    // The file is opened for reading, in place: the bytes are not changed.
    void* bytes = const_cast<char*>(source.bytes.data());
    check(nc_open_mem(source.path.c_str(), NC_NOWRITE, source.bytes.size(), bytes, &file_),
          "not a netCDF file");
    int format = 0;
    nc_inq_format(file_, &format);
    packed_ = format == NC_FORMAT_NETCDF4 || format == NC_FORMAT_NETCDF4_CLASSIC;
  }
  ~NetCdf() { nc_close(file_); }
  NetCdf(const NetCdf&) = delete;
  NetCdf& operator=(const NetCdf&) = delete;

  const std::string& path() const { return source_.path; }
  std::size_t size() const { return source_.bytes.size(); } ///< bytes
  [[noreturn]] void fail(const std::string& what, const char* advice = kCut) const {
    throw Error(Status::Invalid, source_.path, what, advice);
  }

  /// Length of a dimension; none if it does not exist.
  std::optional<std::size_t> dimension(const std::string& name) const {
    int id = 0;
    std::size_t length = 0;
    if (nc_inq_dimid(file_, name.c_str(), &id) != NC_NOERR ||
        nc_inq_dimlen(file_, id, &length) != NC_NOERR)
      return {};
    return length;
  }

  std::optional<Variable> variable(const std::string& name) const {
    Variable found;
    int rank = 0;
    if (nc_inq_varid(file_, name.c_str(), &found.id) != NC_NOERR)
      return {};
    int dimensions[NC_MAX_VAR_DIMS];
    check(nc_inq_varndims(file_, found.id, &rank), name);
    if (rank < 0 || rank > 3)
      fail("the variable '" + name + "' has " + std::to_string(rank) + " dimensions");
    check(nc_inq_var(file_, found.id, nullptr, &found.type, nullptr, dimensions, nullptr), name);
    found.shape.resize(static_cast<std::size_t>(rank));
    for (std::size_t i = 0; i < found.shape.size(); ++i)
      check(nc_inq_dimlen(file_, dimensions[i], &found.shape[i]), name);
    return found;
  }

  std::string attribute(const Variable& variable, const char* name) const {
    nc_type type = NC_NAT;
    std::size_t length = 0;
    if (nc_inq_att(file_, variable.id, name, &type, &length) != NC_NOERR || type != NC_CHAR ||
        length > 1000)
      return {};
    std::string text(length, '\0');
    check(nc_get_att_text(file_, variable.id, name, text.data()), name);
    return trimmedRecord(text);
  }

  /// Checks that the file can hold `n` numbers of `variable`. Those of HDF5 may be compressed.
  void checkSize(const Variable& variable, std::size_t n, const std::string& name) const {
    std::size_t size = 0;
    check(nc_inq_type(file_, variable.type, nullptr, &size), name);
    const double room = static_cast<double>(source_.bytes.size()) * (packed_ ? 1100 : 1);
    if (static_cast<double>(n) * static_cast<double>(size) > room)
      fail(std::to_string(n) + " numbers are declared for '" + name +
           "', more than the file holds");
  }

  void read(const Variable& v, const std::size_t* start, const std::size_t* count, float* out,
            const std::string& name) const {
    check(nc_get_vara_float(file_, v.id, start, count, out), name);
  }
  void read(const Variable& v, const std::size_t* start, const std::size_t* count, double* out,
            const std::string& name) const {
    check(nc_get_vara_double(file_, v.id, start, count, out), name);
  }
  void read(const Variable& v, const std::size_t* start, const std::size_t* count, long long* out,
            const std::string& name) const {
    check(nc_get_vara_longlong(file_, v.id, start, count, out), name);
  }
  void read(const Variable& v, const std::size_t* start, const std::size_t* count, char* out,
            const std::string& name) const {
    check(nc_get_vara_text(file_, v.id, start, count, out), name);
  }

  /// The rows of a table of characters; empty if there is none.
  std::vector<std::string> strings(const std::string& name) const {
    const auto found = variable(name);
    if (!found || found->type != NC_CHAR || found->shape.size() != 2)
      return {};
    const std::size_t rows = found->shape[0], width = found->shape[1];
    if (rows == 0 || width == 0)
      return {};
    if (width > 1 << 16)
      fail("names of " + std::to_string(width) + " characters");
    checkSize(*found, rows * width, name);
    std::string text(rows * width, '\0');
    const std::size_t start[2] = {0, 0}, count[2] = {rows, width};
    read(*found, start, count, text.data(), name);
    std::vector<std::string> out;
    for (std::size_t i = 0; i < rows; ++i)
      out.push_back(trimmedRecord(std::string_view(text).substr(i * width, width)));
    return out;
  }

private:
  void check(int status, const std::string& what) const {
    if (status != NC_NOERR)
      fail("cannot read '" + what + "': " + nc_strerror(status));
  }

  const Source& source_;
  int file_ = -1;
  bool packed_ = false;
};

/// Numbers read at a time, so that reading a long variable can be cancelled.
constexpr std::size_t kChunk = 1 << 20;
constexpr std::size_t kMaxBlocks = 1 << 20;

/// By which types are told apart.
std::string prefixOf(const std::string& elementType) {
  return lowerCase(elementType.substr(0, 3));
}

/// The kind of an element type, by its first three letters and its node count.
CellKind kindOf(const std::string& elementType, std::size_t nodes) {
  struct Known {
    const char* prefix;
    CellType type;
    std::uint32_t corners;
  };
  static constexpr Known kKnown[] = {
      {"tet", CellType::Tetra, 4}, {"hex", CellType::Hexahedron, 8}, {"wed", CellType::Wedge, 6},
      {"pri", CellType::Wedge, 6}, {"pyr", CellType::Pyramid, 5},    {"tri", CellType::Flat, 0},
      {"qua", CellType::Flat, 0},  {"she", CellType::Flat, 0},       {"squ", CellType::Flat, 0},
      {"bar", CellType::Flat, 0},  {"bea", CellType::Flat, 0},       {"tru", CellType::Flat, 0},
      {"edg", CellType::Flat, 0},  {"lin", CellType::Flat, 0},       {"rod", CellType::Flat, 0},
      {"cir", CellType::Flat, 0},  {"sph", CellType::Flat, 0},       {"poi", CellType::Flat, 0},
      {"nod", CellType::Flat, 0},  {"nsi", CellType::Flat, 0}};
  const std::string prefix = prefixOf(elementType);
  const auto each = static_cast<std::uint32_t>(std::min<std::size_t>(nodes, 1000));
  for (const Known& known : kKnown)
    if (prefix == known.prefix)
      return {elementType.c_str(), known.type, known.corners, each};
  return {elementType.c_str(), CellType::OtherSolid, 0, each};
}

/// The corners of a triangle or quadrilateral, or of a shell of one of these shapes; 0 for others.
std::uint32_t faceCorners(const std::string& elementType, std::size_t nodes) {
  const std::string prefix = prefixOf(elementType);
  if (prefix == "tri" || (prefix == "she" && (nodes == 3 || nodes == 6)))
    return 3;
  if (prefix == "qua" || prefix == "squ" ||
      (prefix == "she" && (nodes == 4 || nodes == 8 || nodes == 9)))
    return 4;
  return 0;
}

/// For nodes in VTK's order their index in Exodus', in which the midpoints of vertical edges
/// precede those above, and the centre of the cell those of its faces ("EXODUS II: A Finite Element
/// Data Model", node ordering); null if the two agree.
const std::uint8_t* orderOf(CellType type, std::size_t nodes) {
  static constexpr std::uint8_t hexahedron[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,
                                                9,  10, 11, 16, 17, 18, 19, 12, 13,
                                                14, 15, 23, 24, 25, 26, 21, 22, 20};
  static constexpr std::uint8_t wedge[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11};
  if (type == CellType::Hexahedron && (nodes == 20 || nodes == 27))
    return hexahedron;
  return type == CellType::Wedge && nodes == 15 ? wedge : nullptr;
}

class ExodusFile {
public:
  ExodusFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : options_(options), report_(report), progress_(progress), file_(source) {}

  CellMesh read() {
    readPoints();
    readBlocks();
    progress_.update(0.6);
    readNodalVariables();
    readElementVariables();
    mesh_.times = readTimes();
    return std::move(mesh_);
  }

  std::vector<double> readTimes() {
    const std::size_t steps = file_.dimension("time_step").value_or(0);
    const auto variable = file_.variable("time_whole");
    std::vector<double> times;
    if (variable && steps > 0) {
      readRow<double>(*variable, {}, steps, "time_whole",
                      [&](std::size_t, double time) { times.push_back(time); });
    } else {
      if (steps > file_.size())
        file_.fail(std::to_string(steps) + " time steps are declared, more than the file holds");
      for (std::size_t i = 0; i < steps; ++i)
        times.push_back(static_cast<double>(i));
    }
    return times;
  }

  bool hasSolidCells() {
    const std::size_t count = blockCount();
    for (std::size_t i = 1; i <= count; ++i) {
      const auto connect = file_.variable("connect" + std::to_string(i));
      if (connect && kindOf(file_.attribute(*connect, "elem_type"), 0).type != CellType::Flat)
        return true;
      progress_.check();
    }
    return false;
  }

private:
  struct Block {
    std::size_t number = 0; ///< from 1, as in the variables' names
    std::size_t cells = 0;
  };

  /// The last `n` numbers of a variable's dimensions: all of row `row` of the first ones.
  template <class T, class Use>
  void readRow(const Variable& variable, const std::vector<std::size_t>& row, std::size_t n,
               const std::string& name, Use use) {
    if (variable.shape.size() != row.size() + 1 || variable.shape.back() != n)
      file_.fail("the variable '" + name + "' does not have " + std::to_string(n) + " numbers");
    for (std::size_t i = 0; i < row.size(); ++i)
      if (row[i] >= variable.shape[i])
        file_.fail("the variable '" + name + "' is too short");
    file_.checkSize(variable, n, name);
    std::vector<T> buffer(std::min(n, kChunk));
    for (std::size_t begin = 0; begin < n; begin += kChunk) {
      std::vector<std::size_t> start = row, count(row.size(), 1);
      start.push_back(begin);
      count.push_back(std::min(kChunk, n - begin));
      file_.read(variable, start.data(), count.data(), buffer.data(), name);
      for (std::size_t i = 0; i < count.back(); ++i)
        use(begin + i, buffer[i]);
      progress_.check();
    }
  }

  void readPoints() {
    const auto dimensions = file_.dimension("num_dim");
    const auto nodes = file_.dimension("num_nodes");
    if (!dimensions || !nodes || *nodes == 0)
      file_.fail("has no nodes: not an Exodus mesh", "export it again");
    if (*dimensions < 1 || *dimensions > 3)
      file_.fail("has " + std::to_string(*dimensions) + " dimensions", "export it again");
    checkPointCount(*nodes, file_.path());
    const auto together = file_.variable("coord");
    for (std::size_t axis = 0; axis < *dimensions; ++axis) {
      const std::string name = std::string("coord") + "xyz"[axis];
      const auto variable = together ? together : file_.variable(name);
      if (!variable)
        file_.fail("the coordinates '" + name + "' are missing");
      file_.checkSize(*variable, *nodes, name);
      mesh_.points.resize(*nodes, Vec3d{0, 0, 0});
      readRow<double>(*variable,
                      together ? std::vector<std::size_t>{axis} : std::vector<std::size_t>{},
                      *nodes, name, [&](std::size_t i, double x) {
                        if (!std::isfinite(x))
                          file_.fail("coordinate " + name + " of node " + std::to_string(i + 1) +
                                         " is not finite",
                                     kExport);
                        mesh_.points[i][axis] = x;
                      });
    }
  }

  // Names of variables are made for each.
  std::size_t blockCount() const {
    const std::size_t count = file_.dimension("num_el_blk").value_or(0);
    if (count > kMaxBlocks)
      file_.fail(std::to_string(count) + " element blocks are declared");
    return count;
  }

  void readBlocks() {
    const std::size_t count = blockCount();
    const std::vector<long long> ids = blockIds(count);
    const std::vector<std::string> names = file_.strings("eb_names");
    for (std::size_t i = 0; i < count; ++i) {
      const std::string number = std::to_string(i + 1);
      const auto cells = file_.dimension("num_el_in_blk" + number);
      if (!cells || *cells == 0) // an empty block has no variables
        continue;
      const std::size_t before = mesh_.regions.size();
      readBlock("connect" + number, *cells);
      blocks_.push_back({i + 1, *cells});
      const auto id = static_cast<std::int32_t>(ids[i]);
      mesh_.regions.resize(before + *cells, id);
      if (i < names.size() && !names[i].empty())
        mesh_.regionNames[id] = names[i];
      progress_.check();
    }
    const auto declared = file_.dimension("num_elem");
    if (declared && *declared != mesh_.regions.size())
      file_.fail(std::to_string(*declared) + " elements are declared, but the blocks have " +
                 std::to_string(mesh_.regions.size()));
  }

  std::vector<long long> blockIds(std::size_t count) {
    const auto variable = file_.variable("eb_prop1");
    if (variable && variable->shape.size() == 1)
      file_.checkSize(*variable, count, "eb_prop1");
    std::vector<long long> ids;
    if (variable)
      readRow<long long>(*variable, {}, count, "eb_prop1",
                         [&](std::size_t, long long id) { ids.push_back(id); });
    // Missing or too large ids are replaced by the blocks' numbers.
    const bool fit = std::all_of(ids.begin(), ids.end(), [](long long id) {
      return id >= std::numeric_limits<std::int32_t>::min() &&
             id <= std::numeric_limits<std::int32_t>::max();
    });
    if (!variable || !fit) {
      if (variable)
        report_.warn("block-ids", "block ids beyond 32 bits are replaced by the blocks' numbers");
      ids.clear();
      for (std::size_t i = 0; i < count; ++i)
        ids.push_back(static_cast<long long>(i + 1));
    }
    return ids;
  }

  void readBlock(const std::string& name, std::size_t cells) {
    const auto connect = file_.variable(name);
    if (!connect || connect->shape.empty())
      file_.fail("the nodes '" + name + "' of a block are missing");
    const std::size_t nodes = connect->shape.size() == 2 ? connect->shape[1] : 0;
    std::string type = file_.attribute(*connect, "elem_type");
    if (type.empty())
      type = "unknown";
    CellKind kind = kindOf(type, nodes);
    if (options_.faces && kind.type == CellType::Flat)
      kind.corners = faceCorners(type, nodes);
    // Also cells whose nodes are not read have numbers in the file.
    file_.checkSize(*connect, cells, name);
    if (kind.corners == 0) {
      appendCells(mesh_, kind, cells);
      return;
    }
    if (connect->shape.size() != 2 || connect->shape[0] != cells)
      file_.fail("the nodes '" + name + "' are not those of " + std::to_string(cells) +
                 " elements");
    if (nodes < kind.corners)
      file_.fail("elements of type " + type + " with " + std::to_string(nodes) + " nodes");
    file_.checkSize(*connect, cells > SIZE_MAX / nodes ? SIZE_MAX : cells * nodes, name);
    CellKind stored = kind;
    // The order of wedges with nodes in their faces is not documented.
    if (curvedShape(kind.type, nodes) && !(kind.type == CellType::Wedge && nodes == 18) &&
        !(kind.type == CellType::Pyramid && nodes == 14)) {
      stored.kept = static_cast<std::uint32_t>(nodes);
      stored.order = orderOf(kind.type, nodes);
    }
    const std::uint32_t kept = stored.stored();
    readNodes(*connect, name, cells, nodes, stored);
    if (mesh_.runs.empty() || mesh_.runs.back().fileType != kind.name ||
        mesh_.runs.back().nodesPerCell != kept)
      mesh_.runs.push_back({kind.type, kept, 0, kind.name, kind.quadratic()});
    mesh_.runs.back().count += cells;
  }

  void readNodes(const Variable& connect, const std::string& name, std::size_t cells,
                 std::size_t nodes, const CellKind& kind) {
    mesh_.nodes.reserve(mesh_.nodes.size() + cells * kind.stored());
    const std::size_t step = std::max<std::size_t>(1, kChunk / nodes);
    std::vector<long long> buffer(std::min(cells, step) * nodes);
    const auto points = static_cast<long long>(mesh_.points.size());
    for (std::size_t begin = 0; begin < cells; begin += step) {
      const std::size_t start[2] = {begin, 0}, count[2] = {std::min(step, cells - begin), nodes};
      file_.read(connect, start, count, buffer.data(), name);
      for (std::size_t i = 0; i < count[0] * nodes; ++i) {
        const long long node = buffer[i];
        if (node < 1 || node > points)
          file_.fail("element " + std::to_string(begin + i / nodes + 1) + " of '" + name +
                         "' refers to node " + std::to_string(node) + ", but there are " +
                         std::to_string(points) + " nodes, numbered from 1",
                     kExport);
        if (i % nodes < kind.stored())
          mesh_.nodes.push_back(static_cast<std::uint32_t>(node - 1));
        if (i % nodes == nodes - 1)
          orderLast(mesh_, kind);
      }
      progress_.check();
    }
  }

  // --- variables of one time step ---

  /// Calls f(vector<T>) with the number type of `variable` in the file.
  template <class F>
  static void withType(const Variable& variable, F f) {
    if (variable.type == NC_FLOAT)
      f(float{});
    else
      f(double{});
  }

  /// The step whose variables are requested; none if there are no steps.
  std::optional<std::size_t> step() const {
    return chosenStep(file_.dimension("time_step").value_or(0), options_.timeStep, file_.path());
  }

  void readNodalVariables() {
    const auto chosen = step();
    if (!chosen || !options_.attributes)
      return;
    const std::vector<std::string> names = file_.strings("name_nod_var");
    const auto together = file_.variable("vals_nod_var");
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (!options_.wants(names[k])) {
        mesh_.unread.push_back({names[k], Attribute::On::Points, 1});
        continue;
      }
      const std::string name = "vals_nod_var" + std::to_string(k + 1);
      const auto variable = together ? together : file_.variable(name);
      if (!variable)
        continue;
      std::vector<std::size_t> row{*chosen};
      if (together)
        row.push_back(k);
      withType(*variable, [&](auto tag) {
        using T = decltype(tag);
        file_.checkSize(*variable, mesh_.points.size(), name);
        std::vector<T> values(mesh_.points.size());
        readRow<T>(*variable, row, values.size(), name, [&](std::size_t i, T x) { values[i] = x; });
        mesh_.attributes.push_back({names[k], Attribute::On::Points, 1, std::move(values)});
      });
    }
  }

  void readElementVariables() {
    const auto chosen = step();
    if (!chosen)
      return;
    const std::vector<std::string> names = file_.strings("name_elem_var");
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (!options_.wants(names[k]) && names[k] != options_.regionArray) {
        if (options_.attributes)
          mesh_.unread.push_back({names[k], Attribute::On::Cells, 1});
        continue;
      }
      const std::string name = "vals_elem_var" + std::to_string(k + 1) + "eb";
      std::vector<double> values;
      bool wide = false;
      std::size_t first = 0;
      for (const Block& block : blocks_) {
        if (const auto variable = file_.variable(name + std::to_string(block.number))) {
          wide = wide || variable->type != NC_FLOAT;
          values.resize(mesh_.regions.size(), 0);
          readRow<double>(*variable, {*chosen}, block.cells, name,
                          [&](std::size_t i, double x) { values[first + i] = x; });
        }
        first += block.cells;
      }
      if (values.empty()) // from empty blocks
        continue;
      Attribute::Values kept = std::move(values);
      if (!wide) {
        const auto& doubles = std::get<std::vector<double>>(kept);
        std::vector<float> floats(doubles.size());
        std::transform(doubles.begin(), doubles.end(), floats.begin(),
                       [](double x) { return static_cast<float>(x); });
        kept = std::move(floats);
      }
      mesh_.attributes.push_back({names[k], Attribute::On::Cells, 1, std::move(kept)});
    }
  }

  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  NetCdf file_;
  CellMesh mesh_;
  std::vector<Block> blocks_;
};

} // namespace

CellMesh readExodus(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress) {
  std::lock_guard<std::mutex> lock(netcdfMutex());
  if (source.bytes.substr(0, 3) == "CDF")
    return ExodusFile(source, options, report, progress).read();
  // HDF5 1.10 crashes on some damaged files.
  const auto read = [&](Report& childReport, Progress& childProgress) {
    return ExodusFile(source, options, childReport, childProgress).read();
  };
  return readIsolated(read, source.path, report, progress);
}

std::vector<double> exodusTimes(const Source& source, Report& report, Progress& progress) {
  std::lock_guard<std::mutex> lock(netcdfMutex());
  if (source.bytes.substr(0, 3) == "CDF")
    return ExodusFile(source, {}, report, progress).readTimes();
  const auto read = [&](Report& childReport, Progress& childProgress) {
    return ExodusFile(source, {}, childReport, childProgress).readTimes();
  };
  return readTimesIsolated(read, source.path, report, progress);
}

bool exodusHasSolidCells(const Source& source, Report& report, Progress& progress) {
  std::lock_guard<std::mutex> lock(netcdfMutex());
  if (source.bytes.substr(0, 3) == "CDF")
    return ExodusFile(source, {}, report, progress).hasSolidCells();
  return answerIsolated(
      [&](Report& childReport, Progress& childProgress) {
        return ExodusFile(source, {}, childReport, childProgress).hasSolidCells();
      },
      source.path, report, progress);
}

} // namespace tetvdb
