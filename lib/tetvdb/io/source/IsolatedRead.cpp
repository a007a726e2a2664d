// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/IsolatedRead.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Sandbox.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <fcntl.h>
#include <fstream>
#include <new>
#include <poll.h>
#include <string_view>
#include <sys/resource.h>
#include <sys/wait.h>
#include <type_traits>
#include <unistd.h>
#include <utility>
#include <variant>
#include <vector>

namespace tetvdb {
namespace {

enum class Outcome : std::uint8_t { Mesh = 0x4d, Failure = 0x46 };

constexpr std::size_t kStep = std::size_t(16) << 20; ///< bytes allocated at a time before they
                                                     ///< arrive

// --- the child's side ---

class Sender {
public:
  explicit Sender(int pipe) : pipe_(pipe) {}

  void bytes(const void* data, std::size_t n) {
    for (const char* at = static_cast<const char*>(data); n > 0;) {
      const ssize_t written = ::write(pipe_, at, n);
      if (written < 0 && errno == EINTR)
        continue;
      if (written <= 0)
        ::_exit(1); // the reader is gone
      at += written;
      n -= static_cast<std::size_t>(written);
    }
  }
  template <class T>
  void number(T value) {
    bytes(&value, sizeof value);
  }
  template <class T>
  void array(const std::vector<T>& values) {
    number<std::uint64_t>(values.size());
    bytes(values.data(), values.size() * sizeof(T));
  }
  void text(std::string_view value) {
    number<std::uint64_t>(value.size());
    bytes(value.data(), value.size());
  }

  void mesh(const CellMesh& mesh, const Report& report) {
    number(Outcome::Mesh);
    array(mesh.points);
    array(mesh.nodes);
    number<std::uint64_t>(mesh.runs.size());
    for (const CellRun& run : mesh.runs) {
      number(run.type);
      number(run.nodesPerCell);
      number<std::uint64_t>(run.count);
      text(run.fileType);
      number(run.quadratic);
    }
    number<std::uint64_t>(mesh.attributes.size());
    for (const Attribute& attribute : mesh.attributes) {
      text(attribute.name);
      number(attribute.on);
      number(attribute.components);
      values(attribute.values);
    }
    number<std::uint64_t>(mesh.unread.size());
    for (const UnreadArray& array : mesh.unread) {
      text(array.name);
      number(array.on);
      number(array.components);
    }
    array(mesh.regions);
    number<std::uint64_t>(mesh.regionNames.size());
    for (const auto& [id, name] : mesh.regionNames) {
      number(id);
      text(name);
    }
    array(mesh.times);
    findings(report);
  }
  void mesh(const NumberArrays& arrays, const Report& report) {
    number(Outcome::Mesh);
    number<std::uint64_t>(arrays.size());
    for (const Attribute::Values& one : arrays)
      values(one);
    findings(report);
  }
  void mesh(const TriangleMesh& mesh, const Report& report) {
    number(Outcome::Mesh);
    array(mesh.points);
    array(mesh.triangles);
    number<std::uint64_t>(mesh.faceCount);
    text(mesh.units);
    findings(report);
  }
  void failure(Status status, std::string_view message) {
    number(Outcome::Failure);
    number(status);
    text(message);
  }

private:
  void values(const Attribute::Values& all) {
    number(static_cast<std::uint8_t>(all.index()));
    std::visit([&](const auto& numbers) { array(numbers); }, all);
  }
  void findings(const Report& report) {
    number<std::uint64_t>(report.warnings.size());
    for (const Warning& warning : report.warnings) {
      text(warning.code);
      text(warning.text);
    }
    number(static_cast<std::uint8_t>(report.partial));
  }

  int pipe_;
};

// Data for the handlers of the child's limits, allocated before memory is short.
int childPipe = -1;
std::string childOutOfMemory, childOutOfTime;

/// Failed allocations inside the libraries are untested: the child ends
/// immediately.
[[noreturn]] void endOutOfMemory() {
  Sender(childPipe).failure(Status::Limit, childOutOfMemory);
  ::_exit(0);
}
[[noreturn]] void endOutOfTime(int) {
  Sender(childPipe).failure(Status::Limit, childOutOfTime);
  ::_exit(0);
}

void setLimits(const IsolationLimits& limits, const std::string& path, int pipe) {
  childPipe = pipe;
  childOutOfMemory = path + ": not enough memory to read the mesh; split it into several files or "
                            "use a machine with more memory";
  childOutOfTime = path + ": reading takes far longer than a file of its size should; simplify it "
                          "or export it in another format";
  std::set_new_handler(endOutOfMemory);
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const std::uint64_t now = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  const std::uint64_t free = availableBytes() / 4 * 3;
  const std::uint64_t max = now + (limits.memory > 0 ? std::min(limits.memory, free) : free);
  const rlimit memory{max, max};
  ::setrlimit(RLIMIT_AS, &memory);
  if (limits.seconds > 0) {
    std::signal(SIGXCPU, endOutOfTime);
    const rlimit time{limits.seconds, limits.seconds + 5};
    ::setrlimit(RLIMIT_CPU, &time);
  }
}

template <class Mesh>
[[noreturn]] void runChild(const std::function<Mesh(Report&, Progress&)>& read,
                           const std::string& path, const IsolationLimits& limits, int pipe,
                           pid_t parent) {
  // The parent answers to the terminal, and a crash here is no news to anyone but the parent.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, SIG_IGN);
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGPIPE})
    std::signal(signal, SIG_DFL);
  // HDF5 calls exit() where memory is short, and destructors of other libraries then wait for
  // threads that this process does not have.
  std::atexit([] { ::_exit(1); });
  const int nowhere = ::open("/dev/null", O_WRONLY);
  if (nowhere >= 0)
    ::dup2(nowhere, STDERR_FILENO);

  setLimits(limits, path, pipe);
  enterSandbox();
  if (::getppid() != parent) // it ended before this process was bound to it
    ::_exit(1);
  Sender out(pipe);
  try {
    Report report;
    Progress progress;
    const Mesh mesh = read(report, progress);
    out.mesh(mesh, report);
  } catch (const Error& error) {
    out.failure(error.status(), error.what());
  } catch (const std::exception&) {
    ::_exit(1);
  }
  ::_exit(0);
}

// --- the parent's side ---

class Child {
public:
  Child(pid_t process, int pipe, const std::string& path, Progress& progress)
      : process_(process), pipe_(pipe), path_(path), progress_(progress) {}
  ~Child() {
    ::close(pipe_);
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void bytes(void* out, std::size_t n) {
    for (char* at = static_cast<char*>(out); n > 0;) {
      pollfd waiting{pipe_, POLLIN, 0};
      const int ready = ::poll(&waiting, 1, 50);
      progress_.check();
      if (ready == 0 || (ready < 0 && errno == EINTR))
        continue;
      const ssize_t got = ::read(pipe_, at, n);
      if (got < 0 && errno == EINTR)
        continue;
      if (got <= 0)
        fail();
      at += got;
      n -= static_cast<std::size_t>(got);
    }
  }
  template <class T>
  T number() {
    T value;
    bytes(&value, sizeof value);
    return value;
  }
  template <class Array>
  void array(Array& values) {
    using T = typename Array::value_type;
    const auto n = number<std::uint64_t>();
    for (std::uint64_t done = 0; done < n;) {
      const std::uint64_t end = std::min<std::uint64_t>(n, done + kStep / sizeof(T));
      values.resize(end);
      bytes(values.data() + done, (end - done) * sizeof(T));
      done = end;
    }
  }
  std::string text() {
    std::string value;
    array(value);
    return value;
  }

  void mesh(TriangleMesh& mesh, Report& report) {
    array(mesh.points);
    array(mesh.triangles);
    mesh.faceCount = number<std::uint64_t>();
    mesh.units = text();
    findings(report);
    checkMesh(mesh);
  }
  void mesh(NumberArrays& arrays, Report& report) {
    for (auto n = number<std::uint64_t>(); n > 0; --n)
      arrays.push_back(values());
    findings(report);
  }
  void mesh(CellMesh& mesh, Report& report) {
    array(mesh.points);
    array(mesh.nodes);
    for (auto n = number<std::uint64_t>(); n > 0; --n) {
      CellRun run;
      run.type = number<CellType>();
      run.nodesPerCell = number<std::uint32_t>();
      run.count = number<std::uint64_t>();
      run.fileType = text();
      run.quadratic = number<std::uint8_t>() != 0;
      mesh.runs.push_back(std::move(run));
    }
    for (auto n = number<std::uint64_t>(); n > 0; --n)
      mesh.attributes.push_back(attribute());
    for (auto n = number<std::uint64_t>(); n > 0; --n) {
      UnreadArray unread;
      unread.name = text();
      unread.on = number<Attribute::On>();
      unread.components = number<std::uint32_t>();
      mesh.unread.push_back(std::move(unread));
    }
    array(mesh.regions);
    for (auto n = number<std::uint64_t>(); n > 0; --n) {
      const auto id = number<std::int32_t>();
      mesh.regionNames[id] = text();
    }
    array(mesh.times);
    findings(report);
    checkMesh(mesh);
  }

  [[noreturn]] void fail() const {
    throw Error(Status::Invalid, path_, "the library that reads this format failed on it",
                "the file is damaged; export it again");
  }

private:
  void findings(Report& report) {
    for (auto n = number<std::uint64_t>(); n > 0; --n) {
      const std::string code = text();
      report.warn(code, text());
    }
    if (number<std::uint8_t>() != 0)
      report.partial = true;
  }
  Attribute attribute() {
    Attribute attribute;
    attribute.name = text();
    attribute.on = number<Attribute::On>();
    attribute.components = number<std::uint32_t>();
    attribute.values = values();
    return attribute;
  }
  Attribute::Values values() {
    Attribute::Values all;
    switch (number<std::uint8_t>()) {
    case 0:
      all = std::vector<float>();
      break;
    case 1:
      all = std::vector<double>();
      break;
    case 2:
      all = std::vector<std::int32_t>();
      break;
    case 3:
      all = std::vector<std::int64_t>();
      break;
    default:
      fail();
    }
    std::visit([&](auto& numbers) { array(numbers); }, all);
    return all;
  }

  // A child with corrupted memory may have sent anything.
  void checkMesh(const CellMesh& mesh) const {
    std::uint64_t nodes = 0, cells = 0;
    for (const CellRun& run : mesh.runs) {
      if (run.type > CellType::Flat || run.count > UINT32_MAX ||
          (run.nodesPerCell > 255 && run.type != CellType::Polyhedron &&
           run.type != CellType::Flat) ||
          run.count * run.nodesPerCell > mesh.nodes.size() - nodes)
        fail();
      const std::uint32_t* first = mesh.nodes.data() + nodes;
      nodes += run.count * run.nodesPerCell;
      cells += run.count;
      if (run.type == CellType::Polyhedron)
        for (std::size_t i = 0; i < run.count; ++i, first += run.nodesPerCell)
          checkPolyhedron(first, first + run.nodesPerCell, mesh.points.size());
      else
        for (; first < mesh.nodes.data() + nodes; ++first)
          if (*first >= mesh.points.size())
            fail();
    }
    if (nodes != mesh.nodes.size() || (!mesh.regions.empty() && mesh.regions.size() != cells))
      fail();
    for (const Attribute& attribute : mesh.attributes)
      if (attribute.components == 0 || attribute.on > Attribute::On::Cells ||
          attribute.size() != (attribute.on == Attribute::On::Points ? mesh.points.size() : cells))
        fail();
  }

  void checkPolyhedron(const std::uint32_t* at, const std::uint32_t* end,
                       std::size_t points) const {
    if (at == end)
      fail();
    for (std::uint32_t faces = *at++; faces > 0; --faces) {
      if (at == end || *at >= static_cast<std::size_t>(end - at))
        fail();
      const std::uint32_t* last = at + 1 + *at;
      for (++at; at < last; ++at)
        if (*at >= points)
          fail();
    }
    if (at != end)
      fail();
  }

  void checkMesh(const TriangleMesh& mesh) const {
    if (mesh.triangles.size() % 3 != 0 || mesh.triangles.empty())
      fail();
    for (const std::uint32_t corner : mesh.triangles)
      if (corner >= mesh.points.size())
        fail();
    for (const Vec3d& p : mesh.points)
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
        fail();
  }

  pid_t process_;
  int pipe_;
  const std::string& path_;
  Progress& progress_;
};

template <class Mesh>
Mesh readInChild(const std::function<Mesh(Report&, Progress&)>& read, const std::string& path,
                 const IsolationLimits& limits, Report& report, Progress& progress) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw Error(Status::Limit, path, "no pipe to a reading process", "close other programs");
  const pid_t parent = ::getpid(), process = ::fork();
  if (process < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw Error(Status::Limit, path, "no process to read with", "close other programs");
  }
  if (process == 0) {
    ::close(ends[0]);
    runChild(read, path, limits, ends[1], parent);
  }
  ::close(ends[1]);
  Child child(process, ends[0], path, progress);
  const auto outcome = child.number<Outcome>();
  if (outcome == Outcome::Mesh) {
    Mesh mesh;
    child.mesh(mesh, report);
    return mesh;
  }
  if (outcome != Outcome::Failure)
    child.fail();
  const auto status = child.number<Status>();
  if (status <= Status::Ok || status > Status::Found)
    child.fail();
  throw Error(status, "", child.text());
}

} // namespace

CellMesh readIsolated(const std::function<CellMesh(Report&, Progress&)>& read,
                      const std::string& path, Report& report, Progress& progress) {
  return readInChild(read, path, {}, report, progress);
}

NumberArrays readArraysIsolated(const std::function<NumberArrays(Report&, Progress&)>& read,
                                const std::string& path, const IsolationLimits& limits,
                                Report& report, Progress& progress) {
  return readInChild(read, path, limits, report, progress);
}

std::vector<double>
readTimesIsolated(const std::function<std::vector<double>(Report&, Progress&)>& read,
                  const std::string& path, Report& report, Progress& progress) {
  const auto readAll = [&](Report& childReport, Progress& childProgress) {
    return NumberArrays{read(childReport, childProgress)};
  };
  NumberArrays arrays = readInChild<NumberArrays>(readAll, path, {}, report, progress);
  auto* times = arrays.empty() ? nullptr : std::get_if<std::vector<double>>(&arrays.front());
  if (times == nullptr)
    throw Error(Status::Invalid, path, "its times cannot be read",
                "the file is damaged; export it again");
  return std::move(*times);
}

bool answerIsolated(const std::function<bool(Report&, Progress&)>& ask, const std::string& path,
                    Report& report, Progress& progress) {
  const NumberArrays answer = readArraysIsolated(
      [&](Report& childReport, Progress& childProgress) {
        const std::int32_t yes = ask(childReport, childProgress) ? 1 : 0;
        return NumberArrays{std::vector<std::int32_t>{yes}};
      },
      path, {}, report, progress);
  const auto* yes =
      answer.empty() ? nullptr : std::get_if<std::vector<std::int32_t>>(&answer.front());
  return yes != nullptr && yes->size() == 1 && yes->front() == 1;
}

TriangleMesh readTrianglesIsolated(const std::function<TriangleMesh(Report&, Progress&)>& read,
                                   const std::string& path, const IsolationLimits& limits,
                                   Report& report, Progress& progress) {
  return readInChild(read, path, limits, report, progress);
}

} // namespace tetvdb
