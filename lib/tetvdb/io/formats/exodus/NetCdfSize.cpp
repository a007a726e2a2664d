// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/exodus/NetCdfSize.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

/// The header of "The NetCDF Classic Format Specification": numbers are big-endian, names and
/// attributes are padded to four bytes.
class Header {
public:
  explicit Header(const Source& source) : source_(source), in_(source, machineIsLittleEndian(), 3) {
    version_ = static_cast<unsigned char>(in_.take(1)[0]);
  }

  void check() {
    const std::uint64_t records = count();
    const bool streaming = records == (version_ == 5 ? UINT64_MAX : UINT32_MAX);
    list([&] {
      name();
      dimensions_.push_back(count());
    });
    list([&] { attribute(); });
    list([&] { variable(); });

    // A single variable with records of bytes or shorts is not padded.
    double recordSize = 0;
    std::size_t recordVariables = 0;
    for (const Variable& v : variables_)
      if (v.record) {
        recordSize += v.padded;
        ++recordVariables;
      }
    for (const Variable& v : variables_) {
      double end = v.begin + v.size;
      if (v.record && (records == 0 || streaming))
        continue;
      if (v.record)
        end += (static_cast<double>(records) - 1) * (recordVariables == 1 ? v.size : recordSize);
      if (end > static_cast<double>(source_.bytes.size()))
        throw Error(Status::Invalid, source_.path,
                    "the variable '" + v.name + "' reaches beyond the file's end", kCut);
    }
  }

private:
  struct Variable {
    std::string name;
    bool record = false;
    double begin = 0, size = 0, padded = 0; ///< bytes, per record if there are several
  };

  static bool machineIsLittleEndian() {
    const std::uint16_t one = 1;
    return *reinterpret_cast<const unsigned char*>(&one) == 1;
  }

  std::uint64_t count() {
    return version_ == 5 ? in_.get<std::uint64_t>() : in_.get<std::uint32_t>();
  }
  void skipPadded(std::uint64_t bytes) {
    in_.skip(bytes);
    in_.skip((4 - bytes % 4) % 4);
  }
  std::string name() {
    const std::uint64_t length = count();
    const std::string found(in_.take(length).substr(0, 100));
    in_.skip((4 - length % 4) % 4);
    std::string readable = found;
    for (char& c : readable)
      if (c < 0x20 || c > 0x7e)
        c = '?';
    return readable;
  }
  std::uint64_t bytesOf(std::uint32_t type) {
    static constexpr std::uint64_t kBytes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    if (type == 0 || type >= sizeof kBytes / sizeof *kBytes)
      in_.fail("unknown netCDF type " + std::to_string(type), "export the file again");
    return kBytes[type];
  }

  // A tag, the number of elements, the elements.
  template <class Element>
  void list(Element element) {
    in_.get<std::uint32_t>();
    const std::size_t n = in_.checkCount(count(), 8, "elements of a list");
    for (std::size_t i = 0; i < n; ++i)
      element();
  }

  void attribute() {
    name();
    const std::uint64_t each = bytesOf(in_.get<std::uint32_t>());
    const std::size_t n = in_.checkCount(count(), each, "numbers of an attribute");
    skipPadded(n * each);
  }

  void variable() {
    Variable v;
    v.name = name();
    double numbers = 1;
    const std::size_t rank = in_.checkCount(count(), 4, "dimensions of a variable");
    for (std::size_t i = 0; i < rank; ++i) {
      const std::uint64_t id = count();
      if (id >= dimensions_.size())
        in_.fail("unknown dimension", "export the file again");
      if (i == 0 && dimensions_[id] == 0)
        v.record = true;
      else
        numbers *= static_cast<double>(dimensions_[id]);
    }
    list([&] { attribute(); });
    v.size = numbers * static_cast<double>(bytesOf(in_.get<std::uint32_t>()));
    v.padded = v.size + static_cast<double>(
                            (4 - static_cast<std::uint64_t>(std::min(v.size, 9e15)) % 4) % 4);
    count(); // the size known to the writer
    v.begin =
        static_cast<double>(version_ == 1 ? in_.get<std::uint32_t>() : in_.get<std::uint64_t>());
    variables_.push_back(std::move(v));
  }

  const Source& source_;
  ByteReader in_;
  int version_ = 0;
  std::vector<std::uint64_t> dimensions_;
  std::vector<Variable> variables_;
};

} // namespace

void checkNetCdfSize(const Source& source) {
  const std::string_view bytes = source.bytes;
  if (bytes.size() >= 4 && bytes.substr(0, 3) == "CDF" &&
      (bytes[3] == 1 || bytes[3] == 2 || bytes[3] == 5))
    Header(source).check();
}

} // namespace tetvdb
